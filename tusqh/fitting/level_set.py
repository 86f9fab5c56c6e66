"""Find the nearest point of a level set of the fractions, by Newton steps along the gradient."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from tusqh.fitting.target import Target
from tusqh.grid import BoolArray, FloatArray

#: Steps of Newton, the longest one, the least slope per cell, and the farthest place, in cells.
_STEPS, _LONGEST, _FLAT, _REACH = 25, 0.3, 0.05, 1.5


class OnLevel(NamedTuple):
    """Points on a level set.

    Parameters
    ----------
    points, normals
        The points and the unit normals that point out of the material, shape (n, 3) each.
    is_found
        Whether there is such a point near, shape (n,).
    """

    points: FloatArray
    normals: FloatArray
    is_found: BoolArray


def pad_level(target: Target) -> FloatArray:
    """Return the fractions on the doubled grid with one more layer on every side.

    The new layer is empty; on sides that cut the material it continues the values inside, so that
    the level set meets them at the right place.

    Parameters
    ----------
    target
        The target.
    """
    cut = [] if target.sides is None else _cut_sides(target)
    level = target.level.copy()
    for axis, side in cut:
        _continue(level, axis, side)
    padded = np.pad(level, 1)
    for axis, side in cut:
        _continue(padded, axis, side)
    return np.ascontiguousarray(padded)


def _cut_sides(target: Target) -> list[tuple[int, int]]:
    """Return the sides of the grid (axis and 0 or 1) that lie on the target's box."""
    assert target.sides is not None
    shape = target.grid.shape
    pairs = [(axis, side) for axis in range(len(shape)) for side in range(2)]
    return [(a, s) for a, s in pairs if abs(target.sides[s, a] - s * shape[a]) < 1e-6]


def _continue(level: FloatArray, axis: int, side: int) -> None:
    """Copy the last layer but one on a side to the last layer."""
    along = np.moveaxis(level, axis, 0)
    along[-side] = along[-2 if side else 1]


def project(padded: FloatArray, points: FloatArray, value: float) -> OnLevel:
    """Return a point near each given one at which the interpolated fraction has a value.

    Parameters
    ----------
    padded
        See `pad_level`.
    points
        Points in cells, shape (n, 3).
    value
        The fraction.
    """
    found, normals = points.copy(), np.zeros_like(points)
    is_found = np.zeros(len(points), dtype=np.bool_)
    _project(padded, value, found, normals, is_found)
    return OnLevel(found, normals, is_found)


@numba.njit(cache=True)
def _interpolate(level, place):  # type: ignore[no-untyped-def]
    """Return the trilinear value at a place in cells, and its gradient per cell."""
    i, j, k = 0, 0, 0
    a, b, c = 0.0, 0.0, 0.0
    for axis in range(3):
        u = min(max(2 * place[axis] + 1, 0.0), level.shape[axis] - 1 - 1e-9)
        n = int(u)
        if axis == 0:
            i, a = n, u - n
        elif axis == 1:
            j, b = n, u - n
        else:
            k, c = n, u - n
    gx, gy, gz, value = 0.0, 0.0, 0.0, 0.0
    for di in range(2):
        wa, sa = (a, 1.0) if di else (1 - a, -1.0)
        for dj in range(2):
            wb, sb = (b, 1.0) if dj else (1 - b, -1.0)
            for dk in range(2):
                wc, sc = (c, 1.0) if dk else (1 - c, -1.0)
                f = level[i + di, j + dj, k + dk]
                value += wa * wb * wc * f
                gx += sa * wb * wc * f
                gy += wa * sb * wc * f
                gz += wa * wb * sc * f
    return value, 2 * gx, 2 * gy, 2 * gz


@numba.njit(cache=True)
def _project_one(level, value, place, normal):  # type: ignore[no-untyped-def]
    """Move a place onto the level set; return whether that worked."""
    x, y, z = place[0], place[1], place[2]
    is_found = False
    for _ in range(_STEPS):
        f, gx, gy, gz = _interpolate(level, place)
        square = gx * gx + gy * gy + gz * gz
        if square < _FLAT * _FLAT:
            return False
        slope = np.sqrt(square)
        normal[0], normal[1], normal[2] = -gx / slope, -gy / slope, -gz / slope
        if abs(f - value) < 1e-8:
            is_found = True
            break
        step = (value - f) / square
        if abs(step) * slope > _LONGEST:
            step *= _LONGEST / (abs(step) * slope)
        place[0] += step * gx
        place[1] += step * gy
        place[2] += step * gz
    is_found = is_found or abs(f - value) < 0.01
    away = (place[0] - x) ** 2 + (place[1] - y) ** 2 + (place[2] - z) ** 2
    return is_found and away <= _REACH * _REACH


@numba.njit(cache=True, parallel=True)
def _project(level, value, found, normals, is_found):  # type: ignore[no-untyped-def]
    """Move all places onto the level set."""
    for q in numba.prange(len(found)):
        is_found[q] = _project_one(level, value, found[q], normals[q])
