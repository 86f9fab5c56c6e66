"""Winding numbers of a chain of segments at scattered points (compiled)."""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid import FloatArray, IntArray

#: Most bins along y in which the segments of a cycle are sorted.
_MOST_BINS = 20_000


def wind_around(points: FloatArray, corners: FloatArray, multiplicity: IntArray) -> FloatArray:
    """Return the winding number of a closed cycle at points, by counting crossings, shape (n,).

    Parameters
    ----------
    points
        Places, shape (n, 2), none of them on a segment.
    corners
        Ends of the segments, shape (m, 2, 2).
    multiplicity
        Signed number of times that each segment counts, shape (m,); the chain has no boundary.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> corners = np.stack([square, np.roll(square, -1, axis=0)], axis=1)
    >>> ones = np.ones(4, dtype=np.int64)
    >>> wind_around(np.array([[1.0, 1.0], [3.0, 1.0]]), corners, ones).tolist()
    [1.0, 0.0]
    """
    found = np.zeros(len(points))
    if len(corners) == 0 or len(points) == 0:
        return found
    low, high = corners[..., 1].min(), corners[..., 1].max()
    n_bins = min(len(corners) + 1, _MOST_BINS)
    height = max(float(high - low) / n_bins, 1e-300)
    bins = np.clip((np.sort(corners[..., 1], axis=1) - low) / height, 0, n_bins - 1)
    first_bin, last_bin = bins.astype(np.int64).T
    n_in = np.zeros(n_bins + 1, dtype=np.int64)
    np.add.at(n_in, first_bin, 1)
    np.add.at(n_in, last_bin + 1, -1)
    start = np.zeros(n_bins + 1, dtype=np.int64)
    np.cumsum(np.cumsum(n_in[:-1]), out=start[1:])
    listed = np.empty(start[-1], dtype=np.int64)
    _list_segments(first_bin, last_bin, start[:-1].copy(), listed)
    _count_crossings(points, corners, multiplicity, start, listed, low, height, found)
    return found


def wind_beside_cap(points: FloatArray, corners: FloatArray, multiplicity: IntArray) -> FloatArray:
    """Return the winding number of any chain at points, by summing angles, shape (n,).

    Parameters
    ----------
    points, corners, multiplicity
        See `wind_around`; the chain may have a boundary.

    Examples
    --------
    >>> line = np.array([[[-1.0, 0.0], [1.0, 0.0]]])
    >>> wind_beside_cap(np.array([[0.0, 1.0]]), line, np.array([1])).tolist()
    [0.25]
    """
    found = np.zeros(len(points))
    _sum_angles(points, corners, multiplicity, found)
    return found


@numba.njit(cache=True)
def _list_segments(first_bin, last_bin, end, listed):  # type: ignore[no-untyped-def]
    """List the segments in every bin; `end` starts at the first place of each bin."""
    for k in range(len(first_bin)):
        for b in range(first_bin[k], last_bin[k] + 1):
            listed[end[b]] = k
            end[b] += 1


@numba.njit(cache=True)
def _count_crossings(points, corners, multiplicity, start, listed, low, height, found):  # type: ignore[no-untyped-def]
    """Add up the signed crossings of a ray in direction +x from every point."""
    n_bins = len(start) - 1
    for i in range(len(points)):
        x, y = points[i, 0], points[i, 1]
        if y < low or y > low + height * n_bins:
            continue
        b = min(max(int((y - low) / height), 0), n_bins - 1)
        for e in range(start[b], start[b + 1]):
            k = listed[e]
            ax, ay = corners[k, 0, 0], corners[k, 0, 1]
            bx, by = corners[k, 1, 0], corners[k, 1, 1]
            if (ay <= y) == (by <= y):
                continue
            at = ax + (bx - ax) * ((y - ay) / (by - ay))
            if at > x:
                found[i] += multiplicity[k] if by > ay else -multiplicity[k]


@numba.njit(cache=True)
def _sum_angles(points, corners, multiplicity, found):  # type: ignore[no-untyped-def]
    """Add up the angles, in turns, under which every point sees the segments."""
    for i in range(len(points)):
        x, y = points[i, 0], points[i, 1]
        total = 0.0
        for k in range(len(corners)):
            ax, ay = corners[k, 0, 0] - x, corners[k, 0, 1] - y
            bx, by = corners[k, 1, 0] - x, corners[k, 1, 1] - y
            total += multiplicity[k] * np.arctan2(ax * by - ay * bx, ax * bx + ay * by)
        found[i] = total / (2 * np.pi)
