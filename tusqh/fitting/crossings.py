"""Find the facets of a boundary that cross each other."""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid import BoolArray, FloatArray, IntArray

#: Edge length of a bin, in cells.
_BIN = 1.0


def find_crossings(points: FloatArray, facets: IntArray) -> BoolArray:
    """Return the facets that cross another one, each cut along its first diagonal, shape (f,).

    Facets that share a point cross if an edge of one passes through the other away from it.

    Parameters
    ----------
    points
        Coordinates, in units of about an edge, shape (n, 3).
    facets
        Corners of quads, shape (f, 4).

    Examples
    --------
    >>> quad = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> upright = np.array([[0.5, 0.2, -0.5], [0.5, 0.8, -0.5], [0.5, 0.8, 0.5], [0.5, 0.2, 0.5]])
    >>> both = np.concatenate([quad, upright])
    >>> find_crossings(both, np.arange(8).reshape(2, 4)).tolist()
    [True, True]
    >>> apart = both + np.repeat([[0, 0, 0], [0, 0, 2]], 4, axis=0)
    >>> bool(find_crossings(apart, np.arange(8).reshape(2, 4)).any())
    False
    """
    triangles = np.concatenate([facets[:, [0, 1, 2]], facets[:, [0, 2, 3]]])
    is_crossed = np.zeros(len(facets), dtype=np.bool_)
    if len(facets) == 0:
        return is_crossed
    low = points[triangles].min(axis=1)
    high = points[triangles].max(axis=1)
    lowest = np.floor(low.min(axis=0) / _BIN).astype(np.int64)
    first = np.floor(low / _BIN).astype(np.int64) - lowest
    last = np.floor(high / _BIN).astype(np.int64) - lowest
    shape = last.max(axis=0) + 1
    spans = (last - first + 1).prod(axis=1)
    number, triangle = _list_bins(first, last, shape, np.concatenate([[0], np.cumsum(spans)]))
    order = np.argsort(number, kind="stable")
    start = np.flatnonzero(np.diff(number[order], prepend=-1))
    start = np.append(start, len(order))
    _cross(points, triangles, low, high, triangle[order], start, is_crossed)
    return is_crossed


@numba.njit(cache=True)
def _list_bins(first, last, shape, place):  # type: ignore[no-untyped-def]
    """Return the number of every bin that the box of a triangle meets, and the triangle."""
    number, triangle = np.empty(place[-1], dtype=np.int64), np.empty(place[-1], dtype=np.int64)
    for t in range(len(first)):
        p = place[t]
        for i in range(first[t, 0], last[t, 0] + 1):
            for j in range(first[t, 1], last[t, 1] + 1):
                for k in range(first[t, 2], last[t, 2] + 1):
                    number[p] = (i * shape[1] + j) * shape[2] + k
                    triangle[p] = t
                    p += 1
    return number, triangle


@numba.njit(cache=True)
def _volume(a, b, c, d):  # type: ignore[no-untyped-def]
    """Return six times the volume of a tetrahedron."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    wx, wy, wz = d[0] - a[0], d[1] - a[1], d[2] - a[2]
    return ux * (vy * wz - vz * wy) + uy * (vz * wx - vx * wz) + uz * (vx * wy - vy * wx)


@numba.njit(cache=True)
def _pierces(points, start, end, a, b, c):  # type: ignore[no-untyped-def]
    """Return whether an edge passes through a triangle with which it shares no point."""
    p, q = points[start], points[end]
    before, after = _volume(points[a], points[b], points[c], p), 0.0
    after = _volume(points[a], points[b], points[c], q)
    if (before > 0) == (after > 0) or before == 0 or after == 0:
        return False
    one = _volume(p, q, points[a], points[b]) > 0
    return one == (_volume(p, q, points[b], points[c]) > 0) and one == (
        _volume(p, q, points[c], points[a]) > 0
    )


@numba.njit(cache=True)
def _edges_pierce(points, s, t):  # type: ignore[no-untyped-def]
    """Return whether an edge of one triangle passes through another."""
    for k in range(3):
        start, end = s[k], s[(k + 1) % 3]
        is_shared = False
        for c in range(3):
            if t[c] == start or t[c] == end:
                is_shared = True
        if not is_shared and _pierces(points, start, end, t[0], t[1], t[2]):
            return True
    return False


@numba.njit(cache=True)
def _cross_in_bin(points, triangles, low, high, members, is_crossed):  # type: ignore[no-untyped-def]
    """Mark the facets with triangles that cross another one of the same bin."""
    n = len(triangles) // 2
    for x in range(len(members)):
        s = members[x]
        for y in range(x):
            t = members[y]
            if s % n == t % n:
                continue
            is_apart = False
            for k in range(3):
                if low[s, k] > high[t, k] or low[t, k] > high[s, k]:
                    is_apart = True
            if is_apart:
                continue
            a, b = triangles[s], triangles[t]
            if _edges_pierce(points, a, b) or _edges_pierce(points, b, a):
                is_crossed[s % n] = True
                is_crossed[t % n] = True


@numba.njit(cache=True, parallel=True)
def _cross(points, triangles, low, high, members, start, is_crossed):  # type: ignore[no-untyped-def]
    """Mark the facets that cross another one; bins only ever set marks."""
    for b in numba.prange(len(start) - 1):
        _cross_in_bin(points, triangles, low, high, members[start[b] : start[b + 1]], is_crossed)
