"""Solids whose creases and corners are known: turned boxes, prisms, a gear, overlapping parts.

Creases and corners come from how a solid is put together, not from its triangles, which may overlap
and may have no edge where two parts cross.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from tusqh.grid import BoolArray, FloatArray, IntArray

#: Number of segments of round walls.
_AROUND = 96
#: Two walls meet at a crease if they turn by more than this, in radians: 35 degrees.
_SHARP = 0.61
#: Teeth of the gear, radii of its foot, tip and bore, and ends of one tooth in shares of its pitch.
_TEETH, _FOOT, _TIP, _BORE = 10, 1.5, 2.0, 0.6
_TOOTH = ((0.0, _FOOT), (0.3, _FOOT), (0.42, _TIP), (0.88, _TIP))

_SIGNS = np.array(list(product((0, 1), repeat=3)))
_QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
_BOX = np.array([t for a, b, c, d in _QUADS for t in ([a, b, c], [a, c, d])])


@dataclass(frozen=True)
class CreasedSolid:
    """A solid with its true creases.

    Parameters
    ----------
    points, triangles
        A soup whose winding number is at least 1 inside, shape (n, 3) and (m, 3).
    creases
        Straight pieces of the creases, shape (k, 2, 3).
    corners
        Points at which creases of different directions meet, shape (c, 3).
    """

    points: FloatArray
    triangles: IntArray
    creases: FloatArray
    corners: FloatArray

    def turned(self, seed: int) -> CreasedSolid:
        """Return the solid at a random rotation.

        Parameters
        ----------
        seed
            Seed of the rotation; the same seed gives the same rotation.
        """
        w, x, y, z = (q := np.random.default_rng(seed).normal(size=4)) / np.linalg.norm(q)
        turn = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )
        places = (self.points, self.creases, self.corners)
        points, creases, corners = (p @ turn.T for p in places)
        return replace(self, points=points, creases=creases, corners=corners)


def overlapping_boxes(
    boxes: Sequence[tuple[tuple[float, float, float], tuple[float, float, float]]],
) -> CreasedSolid:
    """Return the union of boxes, each with its whole surface, also where it lies inside others.

    The coordinates of all boxes cut space into blocks; an edge of a block is a crease if the four
    blocks around it are not all alike and do not end in one plane.

    Parameters
    ----------
    boxes
        Lowest and highest corner of every box.

    Examples
    --------
    >>> one = overlapping_boxes([((0, 0, 0), (1, 1, 1))])
    >>> len(one.creases), len(one.corners)
    (12, 8)
    """
    ends = np.array(boxes, dtype=np.float64)
    lines = [np.unique(ends[:, :, axis]) for axis in range(3)]
    middles = _grid([(line[1:] + line[:-1]) / 2 for line in lines])
    is_in = np.zeros(middles.shape[:3], dtype=np.bool_)
    for low, high in ends:
        is_in |= ((middles > low) & (middles < high)).all(axis=-1)
    creases, has = [], []
    nodes = _grid(lines)
    for axis in range(3):
        is_crease = _creases_along(np.pad(is_in, 1), axis)
        first = np.argwhere(is_crease)
        last = first + np.eye(3, dtype=np.int64)[axis]
        creases.append(np.stack([nodes[tuple(first.T)], nodes[tuple(last.T)]], axis=1))
        at = np.zeros(nodes.shape[:3], dtype=np.bool_)
        at[tuple(first.T)] = at[tuple(last.T)] = True
        has.append(at)
    is_corner = np.sum(has, axis=0) >= 2
    points = ends[:, :1] + _SIGNS * (ends[:, 1:] - ends[:, :1])
    triangles = _BOX + 8 * np.arange(len(ends))[:, None, None]
    return CreasedSolid(
        points.reshape(-1, 3), triangles.reshape(-1, 3), np.concatenate(creases), nodes[is_corner]
    )


def _grid(lines: Sequence[FloatArray]) -> FloatArray:
    """Return the nodes of the grid with these coordinates, shape (nx, ny, nz, 3)."""
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)


def _creases_along(padded: BoolArray, axis: int) -> BoolArray:
    """Return which edges along an axis are creases, from padded blocks; shape of the edges."""
    blocks = np.moveaxis(padded, axis, 0)[1:-1]
    one, other = blocks[:, :-1, :-1] == blocks[:, 1:, :-1], blocks[:, :-1, 1:] == blocks[:, 1:, 1:]
    two, last = blocks[:, :-1, :-1] == blocks[:, :-1, 1:], blocks[:, 1:, :-1] == blocks[:, 1:, 1:]
    is_flat = (one & other) | (two & last)
    return np.asarray(np.moveaxis(~is_flat, 0, axis))


def prism(
    rings: Sequence[tuple[FloatArray, FloatArray]], walls: Sequence[FloatArray], height: float
) -> CreasedSolid:
    """Return a prism on a region of the plane.

    Parameters
    ----------
    rings
        Outer and inner polygon of the rings that make up the region, with the same number of
        points each, anticlockwise, shape (n, 2).
    walls
        The polygons that bound the region, with the region on their left.
    height
        Height.
    """
    faces = [_cap(*ring, z)[:, ::way] for ring in rings for z, way in ((0.0, -1), (height, 1))]
    creases, corners = [], []
    for polygon in walls:
        low, high = (np.insert(polygon, 2, z, axis=1) for z in (0.0, height))
        next_low, next_high = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
        faces.append(np.stack([low, next_low, next_high], axis=1))
        faces.append(np.stack([low, next_high, high], axis=1))
        creases += [np.stack([low, next_low], axis=1), np.stack([high, next_high], axis=1)]
        sharp = _is_sharp(polygon)
        creases.append(np.stack([low, high], axis=1)[sharp])
        corners += [low[sharp], high[sharp]]
    points = np.concatenate(faces)
    triangles = np.arange(3 * len(points), dtype=np.int64).reshape(-1, 3)
    return CreasedSolid(
        points.reshape(-1, 3), triangles, np.concatenate(creases), np.concatenate(corners)
    )


def _cap(outer: FloatArray, inner: FloatArray, z: float) -> FloatArray:
    """Return the triangles between two polygons, facing up, shape (t, 3, 3)."""
    a, b, c, d = outer, np.roll(outer, -1, axis=0), np.roll(inner, -1, axis=0), inner
    flat = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return np.concatenate([flat, np.full((*flat.shape[:2], 1), z)], axis=2)


def _is_sharp(polygon: FloatArray) -> BoolArray:
    """Return at which points a polygon turns sharply, shape (n,)."""
    along = np.roll(polygon, -1, axis=0) - polygon
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    return np.asarray((along * np.roll(along, 1, axis=0)).sum(axis=1) < np.cos(_SHARP))


def _circle(centre: tuple[float, float], radius: float, angles: FloatArray) -> FloatArray:
    """Return points on a circle, shape (n, 2)."""
    return np.asarray(
        np.array(centre) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    )


def _rectangle(low: tuple[float, float], high: tuple[float, float]) -> FloatArray:
    """Return the corners of a rectangle, anticlockwise, shape (4, 2)."""
    (x0, y0), (x1, y1) = np.asarray(low, float), np.asarray(high, float)
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def _seen(corners: FloatArray, centre: tuple[float, float], angles: FloatArray) -> FloatArray:
    """Return where rays from a point inside meet a rectangle, shape (n, 2)."""
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    reach = np.abs(np.where(ways > 0, corners[2], corners[0]) - np.array(centre))
    with np.errstate(divide="ignore"):
        ends = reach / np.abs(ways)
    return np.asarray(np.array(centre) + ends.min(axis=1)[:, None] * ways)


def _angles(places: FloatArray, centre: tuple[float, float]) -> FloatArray:
    """Return the angles at which points are seen from a centre."""
    away = places - np.array(centre)
    return np.asarray(np.arctan2(away[:, 1], away[:, 0]))


def cube() -> CreasedSolid:
    """Return a cube."""
    return overlapping_boxes([((0, 0, 0), (1, 1, 1))])


def two_boxes() -> CreasedSolid:
    """Return two boxes that overlap at a corner of each: 20 corners."""
    return overlapping_boxes([((0, 0, 0), (2, 2, 2)), ((1.1, 0.9, 1.2), (3.1, 3, 2.9))])


def bracket() -> CreasedSolid:
    """Return two plates that overlap in the angle between them and share three planes."""
    return overlapping_boxes([((0, 0, 0), (4, 3, 0.9)), ((0, 0, 0), (0.8, 3, 3.2))])


def cylinder() -> CreasedSolid:
    """Return a cylinder, without corners."""
    rim = _circle((0, 0), 1.0, 2 * np.pi * np.arange(_AROUND) / _AROUND)
    return prism([(rim, np.zeros_like(rim))], [rim], 2.0)


def plate() -> CreasedSolid:
    """Return a box with a square hole and a round hole through it."""
    left, right = (-1.0, 0.0), (1.0, 0.0)
    square = _rectangle((-1.5, -0.5), (-0.5, 0.5))
    sides = [_rectangle((-2, -1.2), (0, 1.2)), _rectangle((0, -1.2), (2, 1.2))]
    at_square = np.sort(np.concatenate([_angles(square, left), _angles(sides[0], left)]))
    turns = 2 * np.pi * np.arange(_AROUND) / _AROUND - np.pi
    at_round = np.sort(np.concatenate([turns, _angles(sides[1], right)]))
    bore = _circle(right, 0.6, at_round)
    rings = [
        (_seen(sides[0], left, at_square), _seen(square, left, at_square)),
        (_seen(sides[1], right, at_round), bore),
    ]
    outside = _rectangle((-2, -1.2), (2, 1.2))
    return prism(rings, [outside, square[::-1], bore[::-1]], 1.0)


def gear() -> CreasedSolid:
    """Return a gear with ten teeth and a bore: 80 corners."""
    pitch = 2 * np.pi / _TEETH
    angles = np.array([(k + share) * pitch for k in range(_TEETH) for share, _ in _TOOTH])
    radii = np.array([radius for _ in range(_TEETH) for _, radius in _TOOTH])
    rim = radii[:, None] * _circle((0, 0), 1.0, angles)
    bore = _circle((0, 0), _BORE, angles)
    return prism([(rim, bore)], [rim, bore[::-1]], 0.9)


#: The solids, and the number of cells along the longest side of their boxes that resolves them.
SOLIDS: dict[str, tuple[Callable[[], CreasedSolid], int]] = {
    "cube": (cube, 16),
    "cylinder": (cylinder, 20),
    "plate": (plate, 32),
    "two_boxes": (two_boxes, 24),
    "bracket": (bracket, 28),
    "gear": (gear, 40),
}
