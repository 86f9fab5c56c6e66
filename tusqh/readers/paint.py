"""Compute the union of filled shapes, as rings with the material on one side.

Every shape paints its area by its own fill rule.  Rings that cross no other ring keep their points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.grid import FloatArray, IntArray
from tusqh.readers.rings import (
    Regions,
    containers,
    crossing_area,
    regions_of,
    rings_of_region,
    signed_area,
)

#: Areas with a relative difference below this are equal.
_EQUAL = 1e-9


@dataclass(frozen=True)
class Painted:
    """A painted shape: rings, sides (1 outer, -1 hole), region, and whether it was clipped."""

    rings: list[FloatArray]
    sides: list[int]
    region: Any
    is_cut: bool = False


def paint(rings: Sequence[FloatArray], *, rule: str, clip: Any = None) -> Painted | None:
    """Return the area that a shape paints, None if it is empty.

    Parameters
    ----------
    rings
        Subpaths of the shape; open ones are filled as if they were closed.
    rule
        "nonzero" or "evenodd".
    clip
        The visible region, a geometry of shapely; None if everything is visible.
    """
    rings = [ring for ring in rings if len(ring) > 2 and np.ptp(ring, axis=0).min() > 0]
    if not rings:
        return None
    regions = regions_of(rings)
    painted = _by_nesting(rings, regions, rule) or _by_faces(rings, rule)
    if clip is not None and not shapely.covers(clip, painted.region):
        region = shapely.intersection(clip, painted.region)
        painted = Painted(*rings_of_region(region), region, is_cut=True)
    return painted if painted.rings else None


def _by_nesting(rings: list[FloatArray], regions: Regions, rule: str) -> Painted | None:
    """Return the area of rings that neither cross nor equal each other; None for other rings."""
    if any(crossing_area(*pair) > _EQUAL for pair in zip(rings, regions, strict=True)):
        return None
    inner, outer = containers(regions)
    if len(rings) > 1:
        tree = shapely.STRtree(regions)
        n_within = tree.query(regions, predicate="within").shape[1]
        if n_within != len(rings) + len(inner) or tree.query(regions, predicate="overlaps").size:
            return None
    turns = np.sign([signed_area(ring) for ring in rings]).astype(np.int64)
    if rule == "evenodd":
        turns = np.ones(len(rings), dtype=np.int64)
    outside = np.bincount(inner, weights=turns[outer], minlength=len(rings)).astype(np.int64)
    inside = outside + turns
    was, now = (outside % 2, inside % 2) if rule == "evenodd" else (outside, inside)
    is_border = (was != 0) != (now != 0)
    numbers = np.flatnonzero(is_border)
    sides = np.where(now != 0, 1, -1)[numbers]
    region = regions[0] if len(rings) == 1 else _with_holes(regions, numbers, sides, inner, outer)
    return Painted([rings[k] for k in numbers], [int(s) for s in sides], region)


def _with_holes(
    regions: Regions, numbers: IntArray, sides: IntArray, inner: IntArray, outer: IntArray
) -> Any:
    """Return the region of outer rings without the holes that lie directly in them."""
    areas = shapely.area(regions)
    is_outer = np.zeros(len(regions), dtype=bool)
    is_outer[numbers[sides > 0]] = True
    holes: dict[int, list[Any]] = {int(k): [] for k in numbers[sides > 0]}
    for k in numbers[sides < 0]:
        around = outer[(inner == k) & is_outer[outer]]
        holes[int(around[areas[around].argmin()])].append(regions[k])
    parts = [
        shapely.difference(regions[k], shapely.union_all(of_k)) if of_k else regions[k]
        for k, of_k in holes.items()
    ]
    return shapely.union_all(parts)


def _by_faces(rings: list[FloatArray], rule: str) -> Painted:
    """Return the painted area of arbitrary rings, from the winding numbers of their faces."""
    closed = [np.concatenate([ring, ring[:1]]) for ring in rings]
    noded = shapely.union_all(
        shapely.linestrings(
            np.concatenate(closed),
            indices=np.repeat(np.arange(len(closed)), [len(c) for c in closed]),
        )
    )
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
    inner = shapely.get_coordinates(shapely.point_on_surface(faces))
    winding = np.zeros(len(faces), dtype=np.int64)
    for ring in closed:
        winding += _winding(ring, inner)
    is_painted = winding % 2 != 0 if rule == "evenodd" else winding != 0
    region = shapely.union_all(faces[is_painted])
    return Painted(*rings_of_region(region), region)


def _winding(ring: FloatArray, points: FloatArray) -> IntArray:
    """Return the winding number of a closed ring around points."""
    (x0, y0), (x1, y1) = ring[:-1].T, ring[1:].T
    winding = np.zeros(len(points), dtype=np.int64)
    for first in range(0, len(points), 256):
        x, y = points[first : first + 256, :1], points[first : first + 256, 1:]
        is_right = ((x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)) * np.sign(y1 - y0) > 0
        turns = ((y0 <= y).astype(int) - (y1 <= y)) * is_right
        winding[first : first + 256] = turns.sum(axis=1)
    return winding


def unite(painted: Sequence[Painted]) -> tuple[list[FloatArray], list[int], int]:
    """Return the rings and sides of the union of shapes, and the number of overlapping shapes.

    Parameters
    ----------
    painted
        The shapes.

    Returns
    -------
    rings, sides, n_overlapping
        The rings, their sides (1 for outer rings, -1 for holes), and the number of overlapping
        shapes.
    """
    regions = np.array([p.region for p in painted], dtype=object)
    first, second = shapely.STRtree(regions).query(regions, predicate="intersects")
    once = first < second
    first, second = first[once], second[once]
    overlap = shapely.relate_pattern(regions[first], regions[second], "T********")
    pair = (np.ones(int(overlap.sum())), (first[overlap], second[overlap]))
    _, label = connected_components(coo_array(pair, shape=(len(painted),) * 2), directed=False)
    groups: dict[int, list[int]] = {}
    for k, group in enumerate(label.tolist()):
        groups.setdefault(group, []).append(k)
    rings: list[FloatArray] = []
    sides: list[int] = []
    for members in groups.values():
        if len(members) == 1:
            found = painted[members[0]].rings, painted[members[0]].sides
        else:
            found = rings_of_region(shapely.union_all(regions[members]))
        rings += found[0]
        sides += found[1]
    return rings, sides, sum(len(m) for m in groups.values() if len(m) > 1)
