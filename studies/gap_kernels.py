"""Compiled functions that measure a gap: the critical widths of cells, and those of patches.

They are in one file, because numba's cache on disk does not notice a changed callee in another.
`studies.gap` explains the critical widths, `studies.gap_patch` the patches and rules.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from tusqh.grid import FloatArray, IntArray

#: The rules that join cells; their positions in this tuple are the last index of the widths below.
RULES = ("touching", "faces", "filtration", "sub-cells")
_TOUCHING, _FACES, _FILTRATION, _SUB_CELLS = range(4)

#: Beyond this distance from the middle, in cell sizes, all is material at widths below twice it.
_FAR = 1.25

_CLOSED_BY, _OPEN_BY = 0, 1

#: Number of bisections for a median, which give an accuracy of 1e-12.
_HALVINGS = 42

#: Components of a normal below this count as zero.
_FLAT = 1e-9


@njit(cache=True)
def fraction_below(t: float, normal: FloatArray) -> float:
    """Return the fraction of the unit cube around the origin with ``n . x < t``.

    It is the sum of ``sign * max(t - n . corner, 0)**m / (m! prod n)`` over the corners of the
    cube, where ``m`` is the number of nonzero components of the normal; none is negative.

    Parameters
    ----------
    t
        Signed distance of the plane from the centre of the cube, in cell sizes.
    normal
        Unit normal, shape (dim,), no component negative.
    """
    if t > 0:  # The smaller part has smaller rounding errors.
        return 1.0 - fraction_below(-t, normal)
    m, product = 0, 1.0
    for k in range(len(normal)):
        if normal[k] > _FLAT:
            m += 1
            product *= m * normal[k]
    total = 0.0
    for corner in range(2**m):
        height, sign, bit = t, 1.0, 0
        for k in range(len(normal)):
            if normal[k] > _FLAT:
                if corner >> bit & 1:
                    height -= normal[k] / 2
                    sign = -sign
                else:
                    height += normal[k] / 2
                bit += 1
        if height > 0:
            total += sign * height**m
    return min(max(total / product, 0.0), 1.0)


@njit(cache=True)
def fraction_in_gap(u: float, width: float, normal: FloatArray) -> float:
    """Return the fraction of a cell that the gap fills.

    The centre of the cell is at the signed distance `u` from the middle of the gap.

    Parameters
    ----------
    u
        Signed distance of the cell's centre from the middle of the gap, in cell sizes.
    width
        Width of the gap, in cell sizes.
    normal
        Unit normal of the gap, shape (dim,), no component negative.

    Examples
    --------
    >>> import numpy as np
    >>> fraction_in_gap(0.25, 0.5, np.array([1.0, 0.0]))
    0.5
    """
    return fraction_below(width / 2 - u, normal) - fraction_below(-width / 2 - u, normal)


@njit(cache=True)
def critical_width(u: float, normal: FloatArray, distances: FloatArray) -> float:
    """Return the width up to which the gap leaves at least half of a cell.

    Parameters
    ----------
    u
        Signed distance of the cell's centre from the middle plane, in cell sizes.
    normal
        Unit normal of the gap, all components at least 0, shape (dim,).
    distances
        From `studies.gap.sample_distances`; empty for exact volumes.

    Examples
    --------
    A diagonal gap opens the cell in its middle at a width of sqrt(2) - 1 with exact areas, and at a
    larger width with 2 x 2 samples.

    >>> from studies.gap import sample_distances
    >>> diagonal = np.sqrt([0.5, 0.5])
    >>> round(critical_width(0.0, diagonal, np.empty(0)), 9)
    0.414213562
    >>> round(critical_width(0.0, diagonal, sample_distances(diagonal, 2)), 9)
    0.707106781
    """
    if len(distances):
        away: FloatArray = np.sort(np.abs(u + distances))
        return 2.0 * away[len(distances) // 2]  # type: ignore[no-any-return]
    u = abs(u)
    half_extent = float(normal.sum()) / 2
    if u >= half_extent / 2:  # One side of the gap passes through the centre, the other misses it.
        return 2.0 * u
    low, high = u, half_extent + u
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        if fraction_in_gap(u, 2 * middle, normal) > 0.5:
            high = middle
        else:
            low = middle
    return low + high


@njit(cache=True, parallel=True)
def measure_patches(
    normals: FloatArray, offsets: FloatArray, distances: FloatArray, length: int
) -> FloatArray:
    """Return the closing and the opening width of every patch under every rule.

    Parameters
    ----------
    normals, offsets, distances, length
        As in `studies.gap_patch.measure_widths`, contiguous.

    Returns
    -------
    widths
        Shape (m, k, 4, 2), in cell sizes; the last axis holds the closing and the opening width.
    """
    m, k = len(normals), len(offsets)
    widths = np.empty((m, k, len(RULES), 2))
    for i in prange(m * k):
        _measure_patch(
            normals[i // k], offsets[i % k], distances[i // k], length, widths[i // k, i % k]
        )
    return widths


@njit(cache=True)
def _measure_patch(
    normal: FloatArray, offset: float, distances: FloatArray, length: int, widths: FloatArray
) -> None:
    """Fill in the two widths of every rule for one patch.

    Place ``c`` of the doubled grid has the centre ``(c - 1) / 2``; odd entries are bodies of cells.
    A patch is sheared: for each ``c[1]`` (and ``c[2]``) it holds the column near the gap.  It has a
    further layer around it, so that all cells around a place are known.
    """
    dim = len(normal)
    depth = length if dim == 3 else 0
    n_columns = int(np.ceil(4 * _FAR / normal[0])) + 3
    shape = (2 * length + 3, 2 * depth + 3 if dim == 3 else 1, n_columns)
    first = np.empty(shape[:2], dtype=np.int64)
    distance, own = np.empty(shape), np.empty(shape)
    for a in range(shape[0]):
        for b in range(shape[1]):
            base = offset * normal[0] + normal[1] * (a - 2) / 2
            if dim == 3:
                base += normal[2] * (b - 2) / 2
            first[a, b] = int(np.floor(-2 * (base + _FAR) / normal[0])) - 1
            for i in range(n_columns):
                u = base + normal[0] * (first[a, b] + i) / 2
                distance[a, b, i] = u
                is_far = abs(u) >= _FAR
                own[a, b, i] = 2 * abs(u) if is_far else critical_width(u, normal, distances)
    for rule in range(len(RULES)):
        width = own if rule == _SUB_CELLS else _apply_rule(rule, dim, first, distance, own)
        widths[rule, _CLOSED_BY], widths[rule, _OPEN_BY] = _bottleneck(dim, first, distance, width)


@njit(cache=True)
def _apply_rule(
    rule: int, dim: int, first: IntArray, distance: FloatArray, own: FloatArray
) -> FloatArray:
    """Return the critical widths of all places under a rule; cells always keep their own.

    Place ``i`` of a column has the coordinate ``first + i + 1``, as ``c[0] - 1 = first + i``.
    """
    n_a, n_b, n_c = own.shape
    width = own.copy()
    for a in range(1, n_a - 1):
        for b in range(1, n_b - 1) if dim == 3 else range(1):
            for i in range(n_c):
                if abs(distance[a, b, i]) >= _FAR:
                    continue
                # a and b are c + 1, so they are even for bodies of cells, as is the column parity.
                flat = (first[a, b] + i) % 2, a % 2, b % 2 if dim == 3 else 0
                codimension = flat[0] + flat[1] + flat[2]
                if codimension == 0:
                    continue
                low, high = np.inf, -np.inf
                for corner in range(8):
                    d = corner & 1, corner >> 1 & 1, corner >> 2 & 1
                    if d[0] > flat[0] or d[1] > flat[1] or d[2] > flat[2]:
                        continue
                    a2 = a + flat[1] * (2 * d[1] - 1)
                    b2 = b + flat[2] * (2 * d[2] - 1)
                    i2 = first[a, b] + i + flat[0] * (2 * d[0] - 1) - first[a2, b2]
                    cell = own[a2, b2, i2] if 0 <= i2 < n_c else 2 * _FAR
                    low, high = min(low, cell), max(high, cell)
                if rule == _TOUCHING:
                    width[a, b, i] = high
                elif rule == _FACES or codimension == 1:
                    width[a, b, i] = low
                else:
                    width[a, b, i] = min(max(own[a, b, i], low), high)
    return width


@njit(cache=True)
def _bottleneck(
    dim: int, first: IntArray, distance: FloatArray, width: FloatArray
) -> tuple[float, float]:
    """Return the smallest width of a patch, and the largest at which the two sides are joined.

    Places enter a union-find by decreasing width; on either side everything far away is one node.
    """
    n_a, n_b, n_c = width.shape
    n = width.size
    left, right = n, n + 1
    parent = np.arange(n + 2)
    order = np.argsort(-width.ravel(), kind="mergesort")
    entered = np.zeros(n, dtype=np.bool_)
    smallest = np.inf
    for place in order:
        i, b, a = place % n_c, place // n_c % n_b, place // (n_c * n_b)
        if a in (0, n_a - 1) or (dim == 3 and b in (0, n_b - 1)):
            continue
        if abs(distance[a, b, i]) < _FAR:
            smallest = min(smallest, width[a, b, i])
    for place in order:
        i, b, a = place % n_c, place // n_c % n_b, place // (n_c * n_b)
        if a in (0, n_a - 1) or (dim == 3 and b in (0, n_b - 1)):
            continue
        if abs(distance[a, b, i]) >= _FAR:
            continue
        entered[place] = True
        flat = (first[a, b] + i) % 2, a % 2, b % 2
        for step in range(27):
            d = step % 3 - 1, step // 3 % 3 - 1, step // 9 - 1
            if d == (0, 0, 0) or (dim == 2 and d[2] != 0):
                continue
            # One place is a face of the other if all differing coordinates have the same parity.
            n_moves = abs(d[0]) + abs(d[1]) + abs(d[2])
            n_flat = abs(d[0]) * flat[0] + abs(d[1]) * flat[1] + abs(d[2]) * flat[2]
            if n_flat not in (0, n_moves):
                continue
            a2, b2 = a + d[1], b + d[2]
            if a2 in (0, n_a - 1) or (dim == 3 and b2 in (0, n_b - 1)):
                continue
            i2 = first[a, b] + i + d[0] - first[a2, b2]
            if 0 <= i2 < n_c and abs(distance[a2, b2, i2]) < _FAR:
                other = (a2 * n_b + b2) * n_c + i2
                if not entered[other]:
                    continue
            else:
                other = left if distance[a, b, i] < 0 else right
            root, root_2 = _root(parent, place), _root(parent, other)
            parent[root] = root_2
        if _root(parent, left) == _root(parent, right):
            return smallest, width[a, b, i]
    return smallest, 0.0


@njit(cache=True)
def _root(parent: IntArray, node: int) -> int:
    while parent[node] != node:
        parent[node] = parent[parent[node]]
        node = parent[node]
    return node
