"""Samples of a lattice near triangles or segments, exactly.

The points nearer to a triangle than a radius form a convex set, the union of a prism, three
cylinders and three balls.  A lattice line meets it in one interval, of which the ends are the roots
of linear and quadratic equations.  So the samples near a soup are runs on lattice lines, and no
distance of a sample is evaluated.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid import FloatArray

Marks = NDArray[np.uint8]

#: Parts of the lattice along x that are scanned side by side.
_CHUNKS = 16
#: Relative width of a tie: samples whose distance is the radius, up to rounding, are not near.
_TIE = 1e-9
#: Triangles of which the height is at most this, relative to their sides, count as their sides.
_FLAT = 1e-12


def mark_near(corners: FloatArray, radius: float, value: int, marks: Marks) -> None:
    """Give a value to the samples that are nearer to triangles than a radius.

    Parameters
    ----------
    corners
        Triangles, shape (m, 3, 3), or segments, shape (m, 2, 3), in steps of the lattice, so that
        the sample ``marks[i, j, k]`` lies at (i, j, k).
    radius
        The radius, in steps of the lattice.
    value
        The value.
    marks
        A number for each sample, shape (n_x, n_y, n_z), changed in place.

    Examples
    --------
    >>> marks = np.zeros((4, 1, 4), dtype=np.uint8)
    >>> mark_near(np.array([[[0.0, 0, 1], [3, 0, 1]]]), 0.5, 1, marks)
    >>> marks[:, 0].tolist()
    [[0, 1, 0, 0], [0, 1, 0, 0], [0, 1, 0, 0], [0, 1, 0, 0]]
    """
    if len(corners):
        low, high = corners.min(axis=1) - radius, corners.max(axis=1) + radius
        _mark(np.ascontiguousarray(corners), low, high, radius * (1 - _TIE), value, marks)


@numba.njit(cache=True, error_model="numpy", inline="always")
def _meet_capsule(a, b, x, y, radius):  # type: ignore[no-untyped-def]
    """Return where a line along z is nearer to a segment than a radius; low > high: nowhere."""
    low, high = np.inf, -np.inf
    p, q = x - a[0], y - a[1]
    e_x, e_y, e_z = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    square = radius * radius
    rest = square - p * p - q * q
    if rest >= 0:
        low, high = a[2] - np.sqrt(rest), a[2] + np.sqrt(rest)
    rest = square - (p - e_x) * (p - e_x) - (q - e_y) * (q - e_y)
    if rest >= 0:
        low, high = min(low, b[2] - np.sqrt(rest)), max(high, b[2] + np.sqrt(rest))
    flat = e_x * e_x + e_y * e_y
    length = flat + e_z * e_z
    if flat <= 1e-24 * length:  # Along the line: the balls at the ends are all that is left.
        if high >= low:
            low, high = min(low, a[2], b[2]), max(high, a[2], b[2])
        return low, high
    # In the cylinder: |w|^2 - (w e)^2 / |e|^2 <= radius^2 with w = (p, q, u).
    along = p * e_x + q * e_y
    second = flat / length
    first = -along * e_z / length
    last = p * p + q * q - along * along / length - square
    under = first * first - second * last
    if under < 0:
        return low, high
    root = np.sqrt(under)
    u_low, u_high = (-first - root) / second, (-first + root) / second
    if e_z != 0.0:  # Between the planes through the ends.
        u, v = -along / e_z, (length - along) / e_z
        u_low, u_high = max(u_low, min(u, v)), min(u_high, max(u, v))
    elif along < 0 or along > length:
        return low, high
    if u_low <= u_high:
        low, high = min(low, a[2] + u_low), max(high, a[2] + u_high)
    return low, high


@numba.njit(cache=True, error_model="numpy", inline="always")
def _meet_prism(corner, x, y, radius):  # type: ignore[no-untyped-def]
    """Return where a line along z is over or under a triangle, nearer than a radius."""
    a, b, c = corner[0], corner[1], corner[2]
    u_x, u_y, u_z = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    v_x, v_y, v_z = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    n_x, n_y, n_z = u_y * v_z - u_z * v_y, u_z * v_x - u_x * v_z, u_x * v_y - u_y * v_x
    area = np.sqrt(n_x * n_x + n_y * n_y + n_z * n_z)
    sides = u_x * u_x + u_y * u_y + u_z * u_z + v_x * v_x + v_y * v_y + v_z * v_z
    if area <= _FLAT * sides:
        return np.inf, -np.inf
    low, high = -np.inf, np.inf
    # Between two planes: |(w n)| <= radius |n| with w = (x, y, z) - a.
    at = (x - a[0]) * n_x + (y - a[1]) * n_y
    if n_z != 0.0:
        s, t = (-radius * area - at) / n_z, (radius * area - at) / n_z
        low, high = a[2] + min(s, t), a[2] + max(s, t)
    elif abs(at) > radius * area:
        return np.inf, -np.inf
    for k in range(3):
        d, e = corner[k], corner[(k + 1) % 3]
        g_x, g_y, g_z = e[0] - d[0], e[1] - d[1], e[2] - d[2]
        # Inside a side: (w m) >= 0 with m = n x side.
        m_x, m_y, m_z = n_y * g_z - n_z * g_y, n_z * g_x - n_x * g_z, n_x * g_y - n_y * g_x
        at = (x - d[0]) * m_x + (y - d[1]) * m_y
        if m_z > 0.0:
            low = max(low, d[2] - at / m_z)
        elif m_z < 0.0:
            high = min(high, d[2] - at / m_z)
        elif at < 0.0:
            return np.inf, -np.inf
    return low, high


@numba.njit(cache=True, error_model="numpy", inline="always")
def _meet(corner, x, y, radius):  # type: ignore[no-untyped-def]
    """Return where a line along z is nearer to a triangle or segment than a radius."""
    low, high = _meet_capsule(corner[0], corner[1], x, y, radius)
    if corner.shape[0] == 3:
        for k in range(1, 3):
            from_, to = _meet_capsule(corner[k], corner[(k + 1) % 3], x, y, radius)
            low, high = min(low, from_), max(high, to)
        from_, to = _meet_prism(corner, x, y, radius)
        if from_ <= to:
            low, high = min(low, from_), max(high, to)
    return low, high


# Compiled on its own, because numba takes many times as long for the same loops inside `prange`.
@numba.njit(cache=True, error_model="numpy")
def _mark_slab(corners, low, high, radius, value, from_, to, marks):  # type: ignore[no-untyped-def]
    """Mark the samples ``from_ <= i < to`` along x."""
    n_y, n_z = marks.shape[1], marks.shape[2]
    for t in range(len(corners)):
        i_first, i_last = max(from_, int(np.ceil(low[t, 0]))), min(to - 1, int(high[t, 0]))
        if i_first > i_last or high[t, 0] < 0:
            continue
        j_first = max(0, int(np.ceil(max(low[t, 1], -1.0))))
        j_last = min(n_y - 1, int(np.floor(min(high[t, 1], float(n_y)))))
        for i in range(i_first, i_last + 1):
            for j in range(j_first, j_last + 1):
                z_low, z_high = _meet(corners[t], float(i), float(j), radius)
                if z_low > z_high:
                    continue
                first = max(0, int(np.ceil(max(z_low, -1.0))))
                last = min(n_z - 1, int(np.floor(min(z_high, float(n_z)))))
                for k in range(first, last + 1):
                    marks[i, j, k] = value


@numba.njit(cache=True, error_model="numpy", parallel=True)
def _mark(corners, low, high, radius, value, marks):  # type: ignore[no-untyped-def]
    n = marks.shape[0]
    n_chunks = min(_CHUNKS, n)
    for chunk in numba.prange(n_chunks):
        from_, to = chunk * n // n_chunks, (chunk + 1) * n // n_chunks
        _mark_slab(corners, low, high, radius, value, from_, to, marks)
