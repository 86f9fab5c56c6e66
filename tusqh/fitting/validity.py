"""A sufficient test that the trilinear map of a hex has no fold anywhere.

The determinant of the map is a polynomial of degree 2 along each axis.  It lies between the least
and the largest of its 27 Bernstein coefficients, so positive coefficients prove that it is positive
everywhere.  Where some are not, the hex is cut into smaller boxes, whose coefficients are closer
to the polynomial (Johnen, Weill and Remacle, 2017).
"""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid import BoolArray, FloatArray, IntArray

#: How often a hex is cut into boxes of half the size before the test gives up.
_DEPTH = 3


def find_unproven(points: FloatArray, cells: IntArray) -> BoolArray:
    """Return the hexes whose map is not proven to be free of folds, shape (m,).

    Parameters
    ----------
    points
        Coordinates, shape (n, 3).
    cells
        Corners of the hexes, VTK order, shape (m, 8).

    Examples
    --------
    >>> corners = [[x, y, z] for z in (0.0, 1.0) for x, y in ((0.0, 0.0), (1, 0), (1, 1), (0, 1))]
    >>> cube = np.array(corners)
    >>> find_unproven(cube, np.arange(8)[None]).tolist()
    [False]
    >>> cube[6] = 0.1
    >>> find_unproven(cube, np.arange(8)[None]).tolist()
    [True]
    """
    is_unproven = np.zeros(len(cells), dtype=np.bool_)
    _test(points, cells, is_unproven)
    return is_unproven


@numba.njit(cache=True)
def _determinant(corner, u, v, w):  # type: ignore[no-untyped-def]
    """Return the determinant of the trilinear map at a place of the unit cube."""
    d = np.zeros((3, 3))
    for k in range(3):
        a, b, c, e = corner[0, k], corner[1, k], corner[2, k], corner[3, k]
        f, g, h, i = corner[4, k], corner[5, k], corner[6, k], corner[7, k]
        d[0, k] = ((b - a) * (1 - v) + (c - e) * v) * (1 - w) + (
            (g - f) * (1 - v) + (h - i) * v
        ) * w
        d[1, k] = ((e - a) * (1 - u) + (c - b) * u) * (1 - w) + (
            (i - f) * (1 - u) + (h - g) * u
        ) * w
        d[2, k] = ((f - a) * (1 - u) + (g - b) * u) * (1 - v) + (
            (i - e) * (1 - u) + (h - c) * u
        ) * v
    return (
        d[0, 0] * (d[1, 1] * d[2, 2] - d[1, 2] * d[2, 1])
        + d[0, 1] * (d[1, 2] * d[2, 0] - d[1, 0] * d[2, 2])
        + d[0, 2] * (d[1, 0] * d[2, 1] - d[1, 1] * d[2, 0])
    )


@numba.njit(cache=True)
def _least_coefficient(corner, x, y, z, size):  # type: ignore[no-untyped-def]
    """Return the least Bernstein coefficient in a box, and the least value at its corners."""
    c = np.empty((3, 3, 3))
    for i in range(3):
        for j in range(3):
            for k in range(3):
                c[i, j, k] = _determinant(
                    corner, x + i * size / 2, y + j * size / 2, z + k * size / 2
                )
    at_corners = np.inf
    for i in range(0, 3, 2):
        for j in range(0, 3, 2):
            for k in range(0, 3, 2):
                at_corners = min(at_corners, c[i, j, k])
    # Values at 0, 1/2 and 1 become coefficients, one axis after the other.
    for a in range(3):
        for b in range(3):
            c[1, a, b] = 2 * c[1, a, b] - (c[0, a, b] + c[2, a, b]) / 2
    for a in range(3):
        for b in range(3):
            c[a, 1, b] = 2 * c[a, 1, b] - (c[a, 0, b] + c[a, 2, b]) / 2
    for a in range(3):
        for b in range(3):
            c[a, b, 1] = 2 * c[a, b, 1] - (c[a, b, 0] + c[a, b, 2]) / 2
    return c.min(), at_corners


@numba.njit(cache=True)
def _is_proven(corner):  # type: ignore[no-untyped-def]
    """Return whether all Bernstein coefficients are positive, after cuts where they are not."""
    if not np.isfinite(corner).all():
        return False
    stack = [(0.0, 0.0, 0.0, 1.0, 0)]
    while len(stack) > 0:
        x, y, z, size, depth = stack.pop()
        least, at_corners = _least_coefficient(corner, x, y, z, size)
        if least > 0:
            continue
        if at_corners <= 0 or depth == _DEPTH:
            return False
        half = size / 2
        for i in range(2):
            for j in range(2):
                for k in range(2):
                    stack.append((x + i * half, y + j * half, z + k * half, half, depth + 1))
    return True


@numba.njit(cache=True, parallel=True)
def _test(points, cells, is_unproven):  # type: ignore[no-untyped-def]
    """Test all hexes."""
    for cell in numba.prange(len(cells)):
        corner = np.empty((8, 3))
        for c in range(8):
            for k in range(3):
                corner[c, k] = points[cells[cell, c], k]
        is_unproven[cell] = not _is_proven(corner)
