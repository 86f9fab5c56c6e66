"""Direct rings: determine which of them bound material from outside, and which are holes.

A ring is a closed chain of points.  No point moves here: rings are only reversed, except that a
ring that crosses itself is replaced by the regions that it encloses.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from tusqh.geometry.remark import Remark
from tusqh.grid import BoolArray, FloatArray, IntArray

#: A self-crossing ring is kept unchanged if its winding number is wrong on less than this fraction
#: of its area; such a crossing is a drawing error, not a shape.
SLIP = 1e-3

Regions = NDArray[Any]


def is_closed(chain: FloatArray) -> bool:
    """Return whether a chain ends where it starts.

    Parameters
    ----------
    chain
        Points, shape (n, 2).
    """
    return len(chain) > 2 and bool((chain[0] == chain[-1]).all())


def signed_area(ring: FloatArray) -> float:
    """Return the area inside a ring, negative if it is clockwise; an open chain is closed first.

    Parameters
    ----------
    ring
        Points, shape (n, 2), with or without the first point at the end.

    Examples
    --------
    >>> signed_area(np.array([[0.0, 0], [2, 0], [2, 1], [0, 1]]))
    2.0
    """
    x, y = (ring - ring.mean(axis=0)).T if len(ring) else np.zeros((2, 0))
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def regions_of(rings: Sequence[FloatArray]) -> Regions:
    """Return the area that each ring encloses by the even-odd rule.

    Parameters
    ----------
    rings
        Rings of at least three points each, all finite.

    Returns
    -------
    numpy.ndarray
        Valid polygons or multipolygons of shapely, shape (n,).
    """
    if not rings:
        return np.empty(0, dtype=object)
    owners = np.repeat(np.arange(len(rings)), [len(ring) for ring in rings])
    lines = shapely.linearrings(np.concatenate(list(rings)), indices=owners)
    regions = np.asarray(shapely.polygons(lines))
    bad = ~shapely.is_valid(regions)
    regions[bad] = [_areal(region) for region in shapely.make_valid(regions[bad])]
    return regions


def _areal(region: Any) -> Any:
    """Return the parts of a geometry that have an area."""
    parts = shapely.get_parts(region)
    parts = shapely.get_parts(parts[shapely.get_dimensions(parts) == 2])
    return parts[0] if len(parts) == 1 else shapely.multipolygons(parts)


def rings_of_region(region: Any) -> tuple[list[FloatArray], list[int]]:
    """Return the rings of a region, with outer ones counter-clockwise, and the side of each.

    Parameters
    ----------
    region
        A geometry of shapely; parts without an area are ignored.

    Returns
    -------
    rings, sides
        The rings, and their sides: 1 for outer rings and -1 for holes.
    """
    parts = shapely.get_parts(shapely.get_parts(region))
    rings: list[FloatArray] = []
    sides: list[int] = []
    for part in parts[shapely.get_dimensions(parts) == 2]:
        for place, line in enumerate([part.exterior, *part.interiors]):
            ring = shapely.get_coordinates(line)
            side = -1 if place else 1
            rings.append(ring if side * signed_area(ring) > 0 else ring[::-1])
            sides.append(side)
    return rings, sides


def crossing_area(ring: FloatArray, region: Any) -> float:
    """Return the relative error of a ring's winding area, compared with the enclosed area.

    Parameters
    ----------
    ring
        The ring.
    region
        The region that it encloses by the even-odd rule.

    Examples
    --------
    >>> bow_tie = np.array([[0.0, 0], [2, 2], [2, 0], [0, 2], [0, 0]])
    >>> crossing_area(bow_tie, regions_of([bow_tie])[0])
    1.0
    """
    area = float(shapely.area(region))
    return abs(abs(signed_area(ring)) - area) / area if area > 0 else 0.0


def containers(regions: Regions) -> tuple[IntArray, IntArray]:
    """Return the pairs of regions whose first lies within the second.

    Parameters
    ----------
    regions
        Valid polygons of shapely.

    Returns
    -------
    inner, outer : numpy.ndarray
        Indices of the regions, shape (n,); copies of one region do not contain each other.
    """
    if len(regions) < 2:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    inner, outer = shapely.STRtree(regions).query(regions, predicate="within")
    areas = shapely.area(regions)
    is_larger = areas[outer] > areas[inner] * (1 + 1e-12)
    return inner[is_larger].astype(np.int64), outer[is_larger].astype(np.int64)


def even_odd_sides(regions: Regions) -> IntArray:
    """Return the side of every ring: 1 if it lies inside an even number of others, else -1.

    Copies of a ring count once, and rings that cross each other do not count.

    Parameters
    ----------
    regions
        The region that every ring encloses.
    """
    inner, outer = containers(regions)
    first = first_of_copies(regions)[outer] == outer
    depth = np.bincount(inner[first], minlength=len(regions))
    return np.where(depth % 2 == 0, 1, -1).astype(np.int64)


def first_of_copies(regions: Regions) -> IntArray:
    """Return for every region the index of the first region with the same corners.

    Parameters
    ----------
    regions
        Polygons of shapely.
    """
    seen: dict[bytes, int] = {}
    keys = shapely.to_wkb(shapely.normalize(regions)) if len(regions) else []
    return np.array([seen.setdefault(key, k) for k, key in enumerate(keys)], dtype=np.int64)


def settle(
    rings: Sequence[FloatArray], sides: Sequence[int] | IntArray
) -> tuple[list[FloatArray], int]:
    """Return the rings, reversed where necessary so that all have the material on the same side.

    That side is the side of the majority (by area), so consistent files do not change.

    Parameters
    ----------
    rings
        The rings.
    sides
        For each ring, 1 if the material is inside, -1 if it is outside, 0 if the direction is
        unknown and must not change.

    Returns
    -------
    rings, n_turned
        The rings in the same order, and the number of reversed rings.

    Examples
    --------
    >>> square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2], [0, 0]])
    >>> small = square[::-1] / 2 + 5
    >>> rings, n_turned = settle([square, small], [1, 1])
    >>> n_turned, [signed_area(ring) for ring in rings]
    (1, [4.0, 1.0])
    """
    handed = np.array([signed_area(ring) for ring in rings]) * np.asarray(sides)
    hand = 1.0 if handed.sum() >= 0 else -1.0
    is_turned: BoolArray = handed * hand < 0
    turned = [ring[::-1] if t else ring for ring, t in zip(rings, is_turned, strict=True)]
    return turned, int(is_turned.sum())


def turned_remark(n_turned: int) -> list[Remark]:
    """Return the remark on rings that were reversed, if there are any.

    Parameters
    ----------
    n_turned
        Number of reversed rings.
    """
    what = "rings turned, since the others have the material on their other side"
    return [Remark("changed", what, n_turned)] if n_turned else []


def count_copies(rings: Sequence[FloatArray], sides: Sequence[int] | IntArray) -> list[Remark]:
    """Return the remark on outer rings that cover the same area again.

    Parameters
    ----------
    rings, sides
        See `settle`.
    """
    outer = [r for r, s in zip(rings, sides, strict=True) if s > 0 and len(r) > 2]
    n_copies = len(outer) - len(set(first_of_copies(regions_of(outer)).tolist()))
    if not n_copies:
        return []
    remedy = "their winding numbers add up: use the rule clamped, or remove the copies"
    return [Remark("noted", "rings that are copies of another ring", n_copies, remedy)]
