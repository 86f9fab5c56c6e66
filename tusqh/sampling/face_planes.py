"""The planes parallel to the axes in which a geometry has plane faces (2D: straight edges)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tusqh.geometry.kinds import Surface
from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray

#: A facet lies in a plane if it reaches this far across it at most, in cells; facets in one plane
#: are this near to each other.
FLAT = 1e-3

#: Planes with less than this share of the whole area are left out.
LEAST_SHARE = 0.01

#: Largest number of planes along each axis; those with the largest areas.
MOST = 24


@dataclass(frozen=True)
class FacePlane:
    """A plane across an axis, with the faces in it.

    Parameters
    ----------
    axis
        The axis that the plane is perpendicular to.
    at
        Its coordinate, in model units.
    share
        Area of the faces in it, divided by the area of all faces (2D: lengths of edges).
    """

    axis: int
    at: float
    share: float


def find_face_planes(surfaces: Sequence[Surface], size: float) -> list[FacePlane]:
    """Return the planes across the axes with at least `LEAST_SHARE` of the area of the faces.

    Parameters
    ----------
    surfaces
        The geometry.
    size
        Edge length of a cell, in model units; planes nearer than `FLAT` cells are one.

    Returns
    -------
    list of FacePlane
        The planes by axis and coordinate.

    Examples
    --------
    >>> plate = Outline.from_chains([[(0, 0), (9, 0), (9, 1), (4, 1.5), (0, 1), (0, 0)]])
    >>> [(plane.axis, plane.at) for plane in find_face_planes([plate], 1.0)]
    [(0, 0.0), (0, 9.0), (1, 0.0)]
    """
    low, high, areas = (np.concatenate(some) for some in zip(*map(_facets, surfaces), strict=True))
    total = float(areas.sum())
    planes = []
    for axis in range(low.shape[1]):
        is_flat = high[:, axis] - low[:, axis] <= FLAT * size
        is_flat &= _projected(low, high, axis) > 0
        at = (low[is_flat, axis] + high[is_flat, axis]) / 2
        found = [
            FacePlane(axis, place, area / total)
            for place, area in _group(at, areas[is_flat], FLAT * size)
            if area >= LEAST_SHARE * total
        ]
        found = sorted(found, key=lambda plane: -plane.share)[:MOST]
        planes += sorted(found, key=lambda plane: plane.at)
    return planes


def _facets(surface: Surface) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the box around every facet of a surface, and its area."""
    if isinstance(surface, Outline):
        corners = surface.points[surface.segments]
        areas = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    else:
        corners = surface.points[surface.triangles]
        sides = corners[:, 1:] - corners[:, :1]
        areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    return corners.min(axis=1), corners.max(axis=1), areas


def _projected(low: FloatArray, high: FloatArray, axis: int) -> FloatArray:
    """Return the area of each facet's box seen along an axis; facets across it have some."""
    sides = np.delete(high - low, axis, axis=1)
    return np.asarray(sides.prod(axis=1))


def _group(at: FloatArray, areas: FloatArray, width: float) -> list[tuple[float, float]]:
    """Return the mean coordinate and the area of groups of coordinates, with gaps between them."""
    if len(at) == 0:
        return []
    order = np.argsort(at, kind="stable")
    at, areas = at[order], areas[order]
    first = np.flatnonzero(np.diff(at, prepend=-np.inf) > width)
    sums = np.add.reduceat(areas, first)
    low = at[first]
    mean = np.add.reduceat((at - np.repeat(low, np.diff([*first, len(at)]))) * areas, first) / sums
    return list(zip((low + mean).tolist(), sums.tolist(), strict=True))
