"""Move vertices of a mesh so that its worst elements become better.

New vertices move first; where elements stay below the wish, vertices of the background around them
move too, and last those on the rim.  The steps are those of fitting (`tusqh.fitting.energy` and
`tusqh.fitting.planar.energy`), with lengths in units of the elements around a vertex.
"""

from __future__ import annotations

import numpy as np

from tusqh.fitting.moving import Moving, list_corners
from tusqh.fitting.planar.energy import sweep_points
from tusqh.fitting.polish import polish
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.meshes.jacobians import QUAD_NEIGHBOURS, smallest_jacobians

#: Scaled Jacobian that every element should reach.
ENOUGH = 0.35
#: Rings of elements around new vertices whose vertices may move, and that are taken along.
_RINGS, _AROUND = 2, 4
#: Rounds over the sizes of elements, if there are several, and sweeps in a round.
_ROUNDS, _SWEEPS = 3, 10


def improve(
    points: FloatArray, cells: IntArray, is_new: BoolArray, on_rim: BoolArray
) -> FloatArray:
    """Return better places of the points of a mesh.

    Parameters
    ----------
    points, cells
        The mesh.
    is_new
        Points that move first, shape (n,).
    on_rim
        Points on the rim of the background, which move last, shape (n,); those on a side of the
        box around the background stay on it.
    """
    if not is_new.any():
        return points
    places = points.copy()
    bits = _bits_on_sides(points, on_rim)
    # What may move: new points, then points inside the background, then all.
    for may_move in (is_new, is_new | ~on_rim, np.ones_like(on_rim)):
        scaled = smallest_jacobians(places, cells).scaled
        is_bad = ~(scaled >= ENOUGH)
        if not is_bad.any():
            break
        near = np.zeros(len(points), dtype=bool)
        near[cells[is_bad]] = True
        for _ in range(_RINGS):
            near[cells[near[cells].any(axis=1)]] = True
        near &= may_move
        _improve_part(places, cells, np.where(near, bits, 0))
    return places


def _bits_on_sides(points: FloatArray, on_rim: BoolArray) -> IntArray:
    """Return along which axes each point may move: bit k for axis k."""
    dim = points.shape[1]
    bits = np.full(len(points), (1 << dim) - 1, dtype=np.int64)
    if on_rim.any():
        low, high = points[on_rim].min(axis=0), points[on_rim].max(axis=0)
        slack = 1e-9 * (high - low).max()
        for axis in range(dim):
            is_on = on_rim & (
                (points[:, axis] <= low[axis] + slack) | (points[:, axis] >= high[axis] - slack)
            )
            bits[is_on] &= ~(1 << axis)
    return bits


def _improve_part(places: FloatArray, cells: IntArray, bits: IntArray) -> None:
    """Move the vertices with bits; elements far from them are left out."""
    is_in = bits > 0
    for _ in range(_AROUND):
        is_in[cells[is_in[cells].any(axis=1)]] = True
    own = cells[is_in[cells].all(axis=1)]
    used = np.unique(own)
    number = np.zeros(len(places), dtype=np.int64)
    number[used] = np.arange(len(used))
    local, corners = places[used], number[own].astype(np.int64)
    size = _sizes(local, corners)
    free = np.where(is_in[used], bits[used], 0)
    classes = np.round(np.log2(size)).astype(np.int64)
    found = np.unique(classes[free > 0])
    for _ in range(_ROUNDS if len(found) > 1 else 1):
        for number_of_class in found:
            chosen = np.where(classes == number_of_class, free, 0)
            scale = 2.0 ** -float(number_of_class)
            _move(local, corners, chosen, scale)
    before = smallest_jacobians(places[used], corners).scaled.min()
    if smallest_jacobians(local, corners).scaled.min() >= before:
        places[used] = local


def _sizes(points: FloatArray, cells: IntArray) -> FloatArray:
    """Return the diameter of the largest element at every point, by its edges from a corner."""
    diagonal = points[cells[:, 1:]] - points[cells[:, :1]]
    length = np.linalg.norm(diagonal, axis=2).max(axis=1)
    largest = np.zeros(len(points))
    np.maximum.at(largest, cells, length[:, None])
    return largest


def _move(points: FloatArray, cells: IntArray, bits: IntArray, scale: float) -> None:
    """Move vertices with lengths multiplied by a factor."""
    if points.shape[1] == 2:
        _move_in_plane(points, cells, bits, scale)
        return
    moving = Moving.of(points * scale, cells, np.flatnonzero(bits), bits)
    for _ in range(5):
        if moving.quality.determinant.min() > 0:
            break
        moving.moved[:] = 1.0
        moving.sweep(_SWEEPS, is_wild=True)
        moving.sweep(_SWEEPS)
    moving.moved[:] = 1.0
    moving.sweep(_SWEEPS)
    polish(moving, np.full(len(cells), ENOUGH))
    points[bits > 0] = moving.points[bits > 0] / scale


def _move_in_plane(points: FloatArray, cells: IntArray, bits: IntArray, scale: float) -> None:
    """Move vertices of quads, all of which must be valid."""
    start, corner = list_corners(cells, len(points))
    places = points * scale
    free = np.stack([bits & 1 > 0, bits & 2 > 0], axis=1)
    none = np.zeros(len(points))
    for _ in range(2 * _SWEEPS):
        sweep_points(
            places,
            cells,
            QUAD_NEIGHBOURS,
            start,
            corner,
            np.flatnonzero(bits),
            free,
            none,
            np.zeros((len(points), 3)),
            np.zeros((len(points), 2)),
            2,
            none.copy(),
        )
    points[:] = places / scale
