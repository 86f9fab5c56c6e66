"""The boundary of a soup or outline as a chain with integer multiplicities.

Points whose coordinates are equal in every bit are matched; then the directed edges of triangles,
or the end points of segments, are added up.  Only the terms that do not cancel, from gaps, flips
and copies, affect the winding number (algorithm 1).
"""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid import FloatArray, IntArray


def match_points(points: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the distinct points, in order of first appearance, and the index of every point.

    No point moves: coordinates match if they are equal in every bit (0.0 equals -0.0).

    Parameters
    ----------
    points
        Coordinates, shape (n, dim).

    Returns
    -------
    distinct, number
        Shapes (k, dim) and (n,): ``distinct[number]`` equals `points`.

    Examples
    --------
    >>> distinct, number = match_points(np.array([[1.0, 0.0], [0.5, 2.0], [1.0, -0.0]]))
    >>> distinct.tolist(), number.tolist()
    ([[1.0, 0.0], [0.5, 2.0]], [0, 1, 0])
    """
    clean = np.ascontiguousarray(points + 0.0)
    number, first = _number_rows(clean.view(np.int64))
    return clean[first], number


def boundary_edges(triangles: IntArray, n_points: int) -> tuple[IntArray, IntArray]:
    """Return the boundary 1-cycle of directed triangles over matched points.

    Parameters
    ----------
    triangles
        Corners of every triangle, shape (m, 3).
    n_points
        Number of matched points.

    Returns
    -------
    edges, multiplicity
        Edges, shape (k, 2), lower point first, in lexicographic order, and the number of
        forward minus backward copies of each, shape (k,), never zero.

    Examples
    --------
    >>> sheet = np.array([[0, 1, 2], [0, 2, 3]])
    >>> edges, multiplicity = boundary_edges(sheet, 4)
    >>> edges.tolist(), multiplicity.tolist()
    ([[0, 1], [0, 3], [1, 2], [2, 3]], [1, -1, 1, 1])
    """
    if len(triangles) == 0:
        return np.empty((0, 2), dtype=np.int64), np.empty(0, dtype=np.int64)
    sides = np.ascontiguousarray(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2))
    return cancel_edges(sides, np.ones(len(sides), dtype=np.int64), n_points)


def cancel_edges(
    edges: IntArray, multiplicity: IntArray, n_points: int
) -> tuple[IntArray, IntArray]:
    """Return the distinct edges of a chain, with the multiplicities of all copies added up.

    Parameters
    ----------
    edges
        Start and end of every edge, shape (m, 2).
    multiplicity
        Signed number of times each edge counts, shape (m,).
    n_points
        Number of points.

    Returns
    -------
    edges : numpy.ndarray
        Distinct edges from the lower to the higher point, shape (k, 2).
    multiplicity : numpy.ndarray
        Sum over the edges in this direction minus the sum over opposite ones, shape (k,), never
        zero.
    """
    lower, upper, net = _cancel(edges, multiplicity, n_points)
    return np.stack([lower, upper], axis=1), net


def boundary_points(segments: IntArray, n_points: int) -> tuple[IntArray, IntArray]:
    """Return the signed end points of directed segments over matched points.

    Parameters
    ----------
    segments
        Start and end of every segment, shape (m, 2).
    n_points
        Number of points.

    Returns
    -------
    ends : numpy.ndarray
        Indices of the points, ascending, shape (k,).
    multiplicity : numpy.ndarray
        Number of segments that end at each point minus the number that start there, shape (k,),
        never zero; the sum over all points is zero.

    Examples
    --------
    >>> ends, multiplicity = boundary_points(np.array([[0, 1], [1, 2]]), 3)
    >>> ends.tolist(), multiplicity.tolist()
    ([0, 2], [-1, 1])
    """
    net = np.bincount(segments[:, 1], minlength=n_points)
    net = net - np.bincount(segments[:, 0], minlength=n_points)
    ends = np.flatnonzero(net)
    return ends, net[ends]


@numba.njit(cache=True)
def _number_rows(rows):  # type: ignore[no-untyped-def]
    """Give equal rows of integers the same number, by a hash table with open addressing."""
    n, width = rows.shape
    size = 16
    while size < 2 * n:
        size *= 2
    table = np.full(size, -1, dtype=np.int64)
    number = np.empty(n, dtype=np.int64)
    first = np.empty(n, dtype=np.int64)
    n_distinct = 0
    for r in range(n):
        mixed = np.uint64(0x9E3779B97F4A7C15)
        for k in range(width):
            mixed = (mixed ^ np.uint64(rows[r, k])) * np.uint64(0xBF58476D1CE4E5B9)
            mixed ^= mixed >> np.uint64(29)
        place = np.int64(mixed & np.uint64(size - 1))
        while True:
            found = table[place]
            if found < 0:
                table[place] = n_distinct
                first[n_distinct] = r
                number[r] = n_distinct
                n_distinct += 1
                break
            is_equal = True
            for k in range(width):
                is_equal &= rows[first[found], k] == rows[r, k]
            if is_equal:
                number[r] = found
                break
            place = (place + 1) & (size - 1)
    return number, first[:n_distinct].copy()


@numba.njit(cache=True)
def _cancel(edges, multiplicity, n_points):  # type: ignore[no-untyped-def]
    """Sort edges into buckets by their lower point, and each bucket by the upper one."""
    start = np.zeros(n_points + 1, dtype=np.int64)
    for a, b in edges:
        if a != b:  # An edge whose ends coincide bounds nothing.
            start[min(a, b) + 1] += 1
    for v in range(n_points):
        start[v + 1] += start[v]
    end = start[:-1].copy()
    upper = np.empty(start[-1], dtype=np.int64)
    sign = np.empty(start[-1], dtype=np.int64)
    for e in range(len(edges)):
        a, b = edges[e]
        if a != b:
            place = end[min(a, b)]
            upper[place] = max(a, b)
            sign[place] = multiplicity[e] if a < b else -multiplicity[e]
            end[min(a, b)] += 1
    lower_out = np.empty_like(upper)
    upper_out = np.empty_like(upper)
    net = np.empty_like(upper)
    n = 0
    for v in range(n_points):
        order = start[v] + np.argsort(upper[start[v] : start[v + 1]])
        k = 0
        while k < len(order):
            w, total = upper[order[k]], 0
            while k < len(order) and upper[order[k]] == w:
                total += sign[order[k]]
                k += 1
            if total != 0:
                lower_out[n], upper_out[n], net[n] = v, w, total
                n += 1
    return lower_out[:n].copy(), upper_out[:n].copy(), net[:n].copy()
