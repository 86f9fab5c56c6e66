"""Gaps and overlaps between neighbouring polygons, measured as slivers.

Closed chains become polygons for this measurement only; the outline itself does not change.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from tusqh.geometry.segment_pairs import rounding_of
from tusqh.grid import BoolArray, FloatArray, IntArray

_Regions = NDArray[Any]


@dataclass(frozen=True)
class Slivers:
    """Widths of the slivers between polygons, in model units, in descending order.

    The width of a sliver is twice its area divided by its perimeter, which is exact for a long
    strip.

    Parameters
    ----------
    gaps
        Bounded regions of the plane that no polygon covers and that are not a hole of a single
        polygon, shape (n,).
    overlaps
        Regions of positive area that two polygons both cover, shape (m,).
    """

    gaps: FloatArray
    overlaps: FloatArray


def measure_slivers(
    points: FloatArray, segments: IntArray, chains: IntArray, *, areas: FloatArray
) -> Slivers:
    """Return the slivers between the polygons that the closed chains bound.

    Parameters
    ----------
    points
        Coordinates, shape (n, 2).
    segments
        Segments of closed chains, shape (m, 2).
    chains
        Chain of every segment, shape (m,), numbered from 0 without gaps, in file order.
    areas
        Signed area of every chain, shape (k,).

    Notes
    -----
    A chain whose direction differs from the majority's (by area) is a hole of the last majority
    chain before it if it lies inside that chain, because files list holes after their outer ring.
    A chain covers the points around which it winds in either direction, so both lobes of a chain
    that crosses itself count.
    """
    none = np.empty(0)
    if len(segments) == 0:
        return Slivers(gaps=none, overlaps=none)
    regions = _regions(points, segments, chains, areas)
    narrowest = rounding_of(points)
    return Slivers(gaps=_gaps(regions, narrowest), overlaps=_overlaps(regions, narrowest))


def _regions(
    points: FloatArray, segments: IntArray, chains: IntArray, areas: FloatArray
) -> _Regions:
    """Return the region that each outer chain encloses, without its holes."""
    order = np.argsort(chains, kind="stable")
    corners = np.split(points[segments[order]], np.cumsum(np.bincount(chains))[:-1])
    alone = np.array([_enclosed(chain) for chain in corners])
    numbers = np.arange(len(areas))
    turns_back = np.sign(areas) == -np.sign(areas.sum())
    outer = np.maximum.accumulate(np.where(turns_back, 0, numbers))
    inside = shapely.area(shapely.intersection(alone, alone[outer]))
    is_hole = turns_back & ~turns_back[outer] & (inside > 0.5 * shapely.area(alone))
    owners = np.unique(outer[is_hole])
    holes = [shapely.union_all(alone[is_hole & (outer == owner)]) for owner in owners]
    alone[owners] = shapely.difference(alone[owners], np.array(holes, dtype=object))
    return np.asarray(alone[~is_hole])


def _enclosed(corners: FloatArray) -> Any:
    """Return the region around which segments, shape (n, 2, 2), wind."""
    noded = shapely.node(shapely.multilinestrings(shapely.linestrings(corners)))
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
    inner = shapely.get_coordinates(shapely.point_on_surface(faces))
    x, y = inner[:, :1], inner[:, 1:]
    (x0, y0), (x1, y1) = corners[:, 0].T, corners[:, 1].T
    # Signed crossings of the ray to the right: +1 upwards, -1 downwards.
    is_right = ((x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)) * np.sign(y1 - y0) > 0
    turns = (((y0 <= y).astype(int) - (y1 <= y)) * is_right).sum(axis=1)
    return shapely.union_all(faces[turns != 0])


def _gaps(regions: _Regions, narrowest: float) -> FloatArray:
    """Return the widths of the holes in the union that are not holes of a single region."""
    gaps = _holes(np.atleast_1d(shapely.union_all(regions)))
    own = _holes(regions)
    if len(own) and len(gaps):
        near, hole = shapely.STRtree(own).query(gaps)
        is_own: BoolArray = np.zeros(len(gaps), dtype=bool)
        is_own[near[shapely.equals(gaps[near], own[hole])]] = True
        gaps = gaps[~is_own]
    return _widths(gaps, narrowest)


def _holes(regions: _Regions) -> _Regions:
    """Return the interior rings of regions, as polygons."""
    polygons = shapely.get_parts(regions)
    polygons = polygons[~shapely.is_empty(polygons)]
    rings = shapely.get_rings(polygons)
    n_rings = 1 + shapely.get_num_interior_rings(polygons)
    is_exterior = np.zeros(len(rings), dtype=bool)
    is_exterior[np.cumsum(n_rings) - n_rings] = True
    return np.asarray(shapely.polygons(rings[~is_exterior]))


def _overlaps(regions: _Regions, narrowest: float) -> FloatArray:
    """Return the widths of the pieces that two regions share."""
    first, second = shapely.STRtree(regions).query(regions)
    once = first < second
    shared = shapely.intersection(regions[first[once]], regions[second[once]])
    parts = shapely.get_parts(shapely.get_parts(shared))
    return _widths(parts[shapely.get_dimensions(parts) == 2], narrowest)


def _widths(slivers: _Regions, narrowest: float) -> FloatArray:
    """Return twice the area divided by the perimeter, largest first, without rounding noise."""
    proper = slivers[shapely.length(slivers) > 0]
    widths = 2 * shapely.area(proper) / shapely.length(proper)
    return np.asarray(np.sort(widths[widths > narrowest])[::-1])
