"""Number the sides, faces, edges or elements of a mesh: equal for rows with the same points.

Rows are compared only with those that have the same lowest point, of which there are few, so a pass
over the elements in their order suffices, without sorting them.
"""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid import FloatArray, IndexArray, IntArray

#: The lower points whose edges are counted at a time.
_POINTS_AT_A_TIME = 8_000_000


def number_rows(cells: IndexArray, local: IntArray) -> tuple[IndexArray, int]:
    """Return the number of every part of every element, and how many different parts there are.

    Parameters
    ----------
    cells
        Points of every element, shape (m, k).
    local
        Local corners of every part of an element, shape (n_local, size).

    Returns
    -------
    numbers
        Number of each part in the order of first appearance, shape (m * n_local,), int32 where that
        is large enough; parts with the same set of points have the same number.
    n_different
        How many different parts there are.

    Examples
    --------
    >>> sides = np.array([[0, 1], [1, 2], [2, 0]])
    >>> numbers, n = number_rows(np.array([[0, 1, 2], [2, 1, 3]]), sides)
    >>> numbers.tolist(), n
    ([0, 1, 2, 1, 3, 4], 5)
    """
    n_points = int(cells.max(initial=-1)) + 1
    n_rows = len(cells) * len(local)
    index = np.dtype(np.int32 if n_rows < 2**31 else np.int64)
    numbers: IndexArray = np.empty(n_rows, dtype=index)
    # Little more than half of the parts of a large mesh are different.
    first = np.empty(n_rows * 9 // 16 + 1024, dtype=index)
    n = _number(cells, local, np.full(n_points, -1, dtype=index), first, numbers)
    return numbers, int(n)


def count_pairs(cells: IndexArray, local: IntArray) -> int:
    """Return the number of different edges of elements.

    Parameters
    ----------
    cells
        Points of every element, shape (m, k).
    local
        Local corners of both ends of every edge of an element, shape (n_local, 2).

    Examples
    --------
    >>> count_pairs(np.array([[0, 1, 2], [2, 1, 3]]), np.array([[0, 1], [1, 2], [2, 0]]))
    5
    """
    n_points = int(cells.max(initial=-1)) + 1
    index = np.dtype(np.int32 if len(cells) * len(local) < 2**31 else np.int64)
    # The edges of some of the points at a time bound memory.  Of large meshes of hexes, a point is
    # the lower end of little more than three edges.
    ends = np.empty((min(n_points, _POINTS_AT_A_TIME) * 13 // 4 + 1024, 2), dtype=index)
    n = 0
    for start in range(0, n_points, _POINTS_AT_A_TIME):
        some = min(_POINTS_AT_A_TIME, n_points - start)
        n += int(_count_pairs(cells, local, start, np.full(some, -1, dtype=index), ends))
    return n


def count_different_points(points: FloatArray) -> int:
    """Return the number of points with different coordinates.

    Parameters
    ----------
    points
        Finite coordinates, shape (n, dim).

    Examples
    --------
    >>> count_different_points(np.array([[0.0, 1.0], [2.0, 1.0], [-0.0, 1.0]]))
    2
    """
    size = 1 << (len(points) * 3 // 2).bit_length()
    return int(_count_different(np.ascontiguousarray(points), np.full(size, -1, dtype=np.int32)))


def count_used(indices: IndexArray) -> int:
    """Return the number of different indices.

    Parameters
    ----------
    indices
        Non-negative integers, any shape.

    Examples
    --------
    >>> count_used(np.array([[0, 5], [5, 2]]))
    3
    """
    is_used = np.zeros(int(indices.max(initial=-1)) + 1, dtype=bool)
    is_used[indices.ravel()] = True
    return int(is_used.sum())


def count_repeated_corners(cells: IndexArray) -> int:
    """Return the number of elements that use a point more than once.

    Parameters
    ----------
    cells
        Points of every element, shape (m, k).

    Examples
    --------
    >>> count_repeated_corners(np.array([[0, 1, 2, 3], [0, 1, 1, 4]]))
    1
    """
    return int(_count_repeated(cells))


def count_components(groups: IndexArray) -> int:
    """Return the number of components of rows; rows that share an entry are joined.

    Parameters
    ----------
    groups
        Non-negative indices, shape (n, k); the entries of a row belong to one component.

    Examples
    --------
    >>> count_components(np.array([[0, 1], [1, 2], [7, 8]]))
    2
    """
    parent = np.full(int(groups.max(initial=-1)) + 1, -1, dtype=groups.dtype)
    return int(_count_components(groups, parent))


def count_components_by_parts(numbers: IndexArray, n_local: int) -> int:
    """Return the number of components of elements that share parts.

    Parameters
    ----------
    numbers
        Number of every part of every element, see `number_rows`.
    n_local
        Number of parts of an element.

    Examples
    --------
    >>> count_components_by_parts(np.array([0, 1, 1, 2, 3, 4]), 2)
    2
    """
    n_parts = int(numbers.max(initial=-1)) + 1
    parent = np.arange(len(numbers) // n_local, dtype=np.int32)
    return int(_count_by_parts(numbers, n_local, np.full(n_parts, -1, dtype=np.int32), parent))


@numba.njit(cache=True)
def _sorted_part(cells, local, row, corners):  # type: ignore[no-untyped-def]
    """Write the points of a part of an element in ascending order."""
    cell, part = row // len(local), row % len(local)
    for c in range(local.shape[1]):
        point, at = cells[cell, local[part, c]], c
        while at > 0 and corners[at - 1] > point:
            corners[at] = corners[at - 1]
            at -= 1
        corners[at] = point


@numba.njit(cache=True)
def _number(cells, local, head, first, numbers):  # type: ignore[no-untyped-def]
    """Write the numbers of the parts; `head` is the last new part with each lowest point.

    `first` has the first row of each different part; both lists grow when they are full.
    """
    previous = np.empty_like(first)
    own, other = np.empty(local.shape[1], np.int64), np.empty(local.shape[1], np.int64)
    n = 0
    for row in range(len(numbers)):
        _sorted_part(cells, local, row, own)
        found = head[own[0]]
        while found >= 0:
            _sorted_part(cells, local, first[found], other)
            is_same = True
            for c in range(len(own)):
                is_same = is_same and own[c] == other[c]
            if is_same:
                break
            found = previous[found]
        if found < 0:
            found = n
            if n == len(first):
                more = np.empty(len(first) // 4 + 1, dtype=first.dtype)
                first = np.concatenate((first, more))
                previous = np.concatenate((previous, more))
            first[n], previous[n] = row, head[own[0]]
            head[own[0]] = n
            n += 1
        numbers[row] = found
    return n


@numba.njit(cache=True)
def _count_pairs(cells, local, start, head, ends):  # type: ignore[no-untyped-def]
    """Count the different pairs whose lower points are `start` and those that follow it.

    `head` is the last new pair with each of these points.  `ends` has the higher point of each
    different pair, and the pair before it with the same lower point; it grows when it is full.
    """
    n = 0
    for cell in range(len(cells)):
        for part in range(len(local)):
            a, b = cells[cell, local[part, 0]], cells[cell, local[part, 1]]
            low, high = min(a, b) - start, max(a, b)
            if low < 0 or low >= len(head):
                continue
            found = head[low]
            while found >= 0 and ends[found, 0] != high:
                found = ends[found, 1]
            if found >= 0:
                continue
            if n == len(ends):
                ends = np.concatenate((ends, np.empty((n // 4 + 1, 2), dtype=ends.dtype)))
            ends[n, 0], ends[n, 1] = high, head[low]
            head[low] = n
            n += 1
    return n


@numba.njit(cache=True)
def _count_different(points, table):  # type: ignore[no-untyped-def]
    """Count the different rows with a hash table, whose length is a power of two."""
    mask, n = np.uint64(len(table) - 1), 0
    place = np.empty(points.shape[1])
    bits = place.view(np.int64)
    for row in range(len(points)):
        for axis in range(points.shape[1]):
            place[axis] = points[row, axis] + 0.0  # Turns -0 into 0.
        key = np.uint64(0)
        for value in bits:
            key = (key ^ np.uint64(value)) * np.uint64(0x9E3779B97F4A7C15)
            key ^= key >> np.uint64(29)
        at = key & mask
        while table[at] >= 0:
            is_same = True
            for c in range(points.shape[1]):
                is_same = is_same and points[table[at], c] == points[row, c]
            if is_same:
                break
            at = (at + np.uint64(1)) & mask
        if table[at] < 0:
            table[at] = row
            n += 1
    return n


@numba.njit(cache=True)
def _count_repeated(cells):  # type: ignore[no-untyped-def]
    n = 0
    for corners in cells:
        is_repeated = False
        for a in range(len(corners)):
            for b in range(a):
                is_repeated = is_repeated or corners[a] == corners[b]
        n += is_repeated
    return n


@numba.njit(cache=True)
def _root(parent, at):  # type: ignore[no-untyped-def]
    while parent[at] != at:
        parent[at] = parent[parent[at]]
        at = parent[at]
    return at


@numba.njit(cache=True)
def _count_components(groups, parent):  # type: ignore[no-untyped-def]
    """Join the entries of each row; entries that are not yet used have the parent -1."""
    n = 0
    for row in groups:
        for entry in row:
            if parent[entry] < 0:
                parent[entry] = entry
                n += 1
            a, b = _root(parent, row[0]), _root(parent, entry)
            if a != b:
                parent[max(a, b)] = min(a, b)
                n -= 1
    return n


@numba.njit(cache=True)
def _count_by_parts(numbers, n_local, holder, parent):  # type: ignore[no-untyped-def]
    """Join each element to the first one that has the same part."""
    n = len(parent)
    for row in range(len(numbers)):
        part, cell = numbers[row], row // n_local
        if holder[part] < 0:
            holder[part] = cell
            continue
        a, b = _root(parent, holder[part]), _root(parent, cell)
        if a != b:
            parent[max(a, b)] = min(a, b)
            n -= 1
    return n
