"""Resample voxels that are boxes, or turned, to cubes along the axes of space, exactly.

The value of a cube is the mean of the image over it, which is 0 outside the image.  Boxes along the
axes overlap a cube by the product of three lengths.  A turned voxel and a cube are clipped against
each other: in the coordinates of the voxels, the cube is a parallelepiped, which is cut into
tetrahedra and then by the planes between the voxels.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from tusqh.grid import FloatArray

#: Tetrahedra of a cube, as its corners with bits for x, y and z.
_TETS = np.array(
    [[0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 6, 7]]
)
#: Room for the pieces of a tetrahedron between two planes, along one, two and three axes.
_ROOM = 9
#: Extents within this part of a cube of a whole number of cubes are that number.
_ROUNDING = 1e-6


def resample_boxes(values: FloatArray, sides: FloatArray, size: float) -> FloatArray:
    """Return the means of an image of boxes over cubes that begin at the same corner.

    Parameters
    ----------
    values
        Value of every voxel, shape (nx, ny, nz).
    sides
        Side lengths of a voxel, shape (3,).
    size
        Side length of a cube.

    Examples
    --------
    >>> resample_boxes(np.array([[[1.0, 0.0]]]), np.array([1.0, 1.0, 1.5]), 1.0).tolist()
    [[[1.0, 0.5, 0.0]]]
    """
    from scipy import sparse

    for axis in range(3):
        n_voxels, side = values.shape[axis], float(sides[axis]) / size
        n_cubes = math.ceil(n_voxels * side - _ROUNDING)
        ends = np.arange(n_voxels + 1) * side
        first = np.minimum(np.floor(ends[:-1] + _ROUNDING).astype(np.int64), n_cubes - 1)
        n_over = math.ceil(side) + 2
        cube = first[:, None] + np.arange(n_over)
        overlap = np.minimum(ends[1:, None], cube + 1) - np.maximum(ends[:-1, None], cube)
        voxel = np.broadcast_to(np.arange(n_voxels)[:, None], cube.shape)
        is_used = (overlap > _ROUNDING) & (cube < n_cubes)
        matrix = sparse.csr_array(
            (overlap[is_used], (cube[is_used], voxel[is_used])), shape=(n_cubes, n_voxels)
        )
        moved = np.moveaxis(values, axis, 0)
        means = matrix @ moved.reshape(n_voxels, -1)
        values = np.moveaxis(means.reshape(n_cubes, *moved.shape[1:]), 0, axis)
    return np.clip(values, 0.0, 1.0)


def resample_turned(
    values: FloatArray, steps: FloatArray, corner: FloatArray, size: float
) -> tuple[FloatArray, FloatArray]:
    """Return the means of an image with turned axes over cubes along the axes of space.

    Parameters
    ----------
    values
        Value of every voxel, between 0 and 1, shape (nx, ny, nz).
    steps
        Step from a voxel to the next along each axis of the image, one a row, shape (3, 3).
    corner
        Corner at which voxel (0, 0, 0) begins, shape (3,).
    size
        Side length of a cube.

    Returns
    -------
    means : numpy.ndarray
        Value of every cube.
    origin : numpy.ndarray
        Lowest corner of the cubes, shape (3,).
    """
    ends = np.array([[i >> axis & 1 for axis in range(3)] for i in range(8)]) * values.shape
    corners = corner + ends @ steps
    origin = corners.min(axis=0)
    extent = (corners.max(axis=0) - origin) / size
    shape = np.maximum(np.ceil(extent - _ROUNDING).astype(np.int64), 1)
    to_index = np.linalg.inv(steps)
    means = np.zeros(tuple(shape))
    _fill(
        means,
        np.ascontiguousarray(values),
        (origin - corner) @ to_index,
        size * to_index,
        1.0 / abs(np.linalg.det(size * to_index)),
        _TETS,
    )
    return means, origin


@njit(cache=True)
def _fill(means, values, start, steps, per_volume, tets):  # type: ignore[no-untyped-def]
    """Compute the mean of every cube; `start` and `steps` are in voxels."""
    n = values.shape
    corners = np.empty((8, 3))
    low, high = np.empty(3, np.int64), np.empty(3, np.int64)
    room = np.empty((4, _ROOM**3, 4, 3))
    for i in range(means.shape[0]):
        for j in range(means.shape[1]):
            for k in range(means.shape[2]):
                for c in range(8):
                    for a in range(3):
                        x = i + (c & 1)
                        y = j + (c >> 1 & 1)
                        z = k + (c >> 2 & 1)
                        corners[c, a] = start[a] + x * steps[0, a] + y * steps[1, a]
                        corners[c, a] += z * steps[2, a]
                is_inside, is_outside = True, False
                for a in range(3):
                    least, most = corners[:, a].min(), corners[:, a].max()
                    is_inside &= least >= -1e-9 and most <= n[a] + 1e-9
                    is_outside |= most <= 0 or least >= n[a]
                    low[a] = max(0, int(np.floor(least + 1e-9)))
                    high[a] = min(n[a], int(np.ceil(most - 1e-9)))
                if is_outside:
                    continue
                part = values[low[0] : high[0], low[1] : high[1], low[2] : high[2]]
                if part.size == 0:
                    continue
                least, most = part.min(), part.max()
                if least == most and (is_inside or most == 0):
                    means[i, j, k] = most
                    continue
                total = 0.0
                for t in range(tets.shape[0]):
                    for v in range(4):
                        room[0, 0, v] = corners[tets[t, v]]
                    total += _integrate(room, values, low, high)
                means[i, j, k] = min(1.0, max(0.0, total * per_volume))


@njit(cache=True)
def _integrate(room, values, low, high):  # type: ignore[no-untyped-def]
    """Return the integral of the image over the tetrahedron `room[0, 0]`."""
    total = 0.0
    for i in range(low[0], high[0]):
        n_x = _slab(room[0], 1, room[1], room[3], 0, i)
        if n_x == 0:
            continue
        for j in range(low[1], high[1]):
            n_y = _slab(room[1], n_x, room[2], room[3], 1, j)
            if n_y == 0:
                continue
            for k in range(low[2], high[2]):
                value = values[i, j, k]
                if value != 0.0:
                    total += value * _volume_in_slab(room[2], n_y, room[3], k)
    return total


@njit(cache=True)
def _slab(pieces, n_pieces, found, spare, axis, low):  # type: ignore[no-untyped-def]
    """Store the parts of tetrahedra between two planes, and return their number."""
    n_found = 0
    for p in range(n_pieces):
        n_above = _clip(pieces[p], spare, 0, axis, low, 1.0)
        for q in range(n_above):
            n_found = _clip(spare[q], found, n_found, axis, low + 1.0, -1.0)
    return n_found


@njit(cache=True)
def _volume_in_slab(pieces, n_pieces, spare, low):  # type: ignore[no-untyped-def]
    """Return the volume of the parts of tetrahedra between two planes across the last axis."""
    total = 0.0
    for p in range(n_pieces):
        n_above = _clip(pieces[p], spare, 0, 2, low, 1.0)
        for q in range(n_above):
            end = _clip(spare[q], spare, n_above, 2, low + 1.0, -1.0)
            for r in range(n_above, end):
                total += _volume(spare[r])
    return total


@njit(cache=True)
def _volume(tet):  # type: ignore[no-untyped-def]
    """Return the volume of a tetrahedron."""
    a, b, c = tet[1] - tet[0], tet[2] - tet[0], tet[3] - tet[0]
    x = b[1] * c[2] - b[2] * c[1]
    y = b[2] * c[0] - b[0] * c[2]
    z = b[0] * c[1] - b[1] * c[0]
    return abs(a[0] * x + a[1] * y + a[2] * z) / 6.0


@njit(cache=True)
def _clip(tet, found, n_found, axis, plane, sign):  # type: ignore[no-untyped-def]
    """Add the part of a tetrahedron on one side of a plane, in up to three tetrahedra."""
    inside, outside = np.empty(4, np.int64), np.empty(4, np.int64)
    n_in, n_out = 0, 0
    for v in range(4):
        if sign * (tet[v, axis] - plane) >= 0:
            inside[n_in] = v
            n_in += 1
        else:
            outside[n_out] = v
            n_out += 1
    if n_in == 0:
        return n_found
    if n_in == 4:
        found[n_found] = tet
        return n_found + 1
    prism = np.empty((2, 3, 3))
    if n_in == 1:
        a = tet[inside[0]].copy()
        cuts = prism[0]
        for k in range(3):
            _cross(tet, inside[0], outside[k], axis, plane, cuts[k])
        found[n_found, 0] = a
        found[n_found, 1:] = cuts
        return n_found + 1
    for k in range(3):
        if n_in == 3:
            prism[0, k] = tet[inside[k]]
            _cross(tet, inside[k], outside[0], axis, plane, prism[1, k])
    if n_in == 2:
        for side in range(2):
            prism[side, 0] = tet[inside[side]]
            for k in range(2):
                _cross(tet, inside[side], outside[k], axis, plane, prism[side, k + 1])
    p, q = prism[0], prism[1]
    found[n_found, 0], found[n_found, 1], found[n_found, 2] = p[0], p[1], p[2]
    found[n_found, 3] = q[2]
    found[n_found + 1, 0], found[n_found + 1, 1] = p[0], p[1]
    found[n_found + 1, 2], found[n_found + 1, 3] = q[2], q[1]
    found[n_found + 2, 0], found[n_found + 2, 1] = p[0], q[1]
    found[n_found + 2, 2], found[n_found + 2, 3] = q[2], q[0]
    return n_found + 3


@njit(cache=True)
def _cross(tet, inside, outside, axis, plane, point):  # type: ignore[no-untyped-def]
    """Store the point in which an edge of a tetrahedron crosses a plane."""
    a, b = tet[inside, axis], tet[outside, axis]
    share = (plane - a) / (b - a)
    for k in range(3):
        point[k] = tet[inside, k] + share * (tet[outside, k] - tet[inside, k])
    point[axis] = plane
