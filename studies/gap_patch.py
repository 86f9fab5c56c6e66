r"""Measure the widths at which a gap opens and closes, on a patch of cells along it.

As a gap grows wider, it drops the cells of the doubled grid one by one at their critical widths
(`studies.gap`), so the gap's width defines a filtration.  Two numbers describe the outcome for a
patch, an orientation and an offset:

* up to the *closing width*, the smallest critical width of all cells, no cell is dropped: the gap
  is **closed**, which means joined everywhere and without a void;
* beyond the *opening width*, the largest width at which a path of kept cells joins the two
  half-spaces (a bottleneck: the merge of two components), it is **open**;
* between them it is **mixed**: joined in some places, with voids.

The rule determines which cells a path can use.  All rules use the same graph, in which cells of all
dimensions are joined if one is a face of the other; the rules differ only in the critical widths of
the lower dimensions::

    touching   the largest of the adjacent cells: cells are closed sets, pinches join
    faces      the smallest of the adjacent cells: only whole shared faces join
    filtration the paper's complex: a face is kept if both its cells are; edges (3D) and vertices
               have their own width, clamped to the range of the adjacent cells
    sub-cells  all have their own width, as in the theorem's proof

In the plane our meshes agree with the filtration (`studies.gap_meshes`); in space the edges
and vertices of a cluster of pinches may disagree, and the policy for mixed clusters decides.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from studies.gap import critical_width
from tusqh.grid import FloatArray, IntArray

#: The rules that join cells; their positions in this tuple are the last index of the widths below.
RULES = ("touching", "faces", "filtration", "sub-cells")
_TOUCHING, _FACES, _FILTRATION, _SUB_CELLS = range(4)

#: Beyond this distance from the middle, in cell sizes, all is material at widths below twice it.
_FAR = 1.25

_CLOSED_BY, _OPEN_BY = 0, 1


def measure_widths(
    normals: FloatArray, offsets: FloatArray, distances: FloatArray, *, length: int
) -> tuple[FloatArray, FloatArray]:
    """Return the closing and the opening widths of patches, in cell sizes.

    Parameters
    ----------
    normals
        Unit normals of the gap, shape (m, dim), components from large to small, none negative.
    offsets
        Shifts of the grid along its first axis, in cell sizes, shape (k,); 0 centres a cell on
        the middle of the gap.
    distances
        Distances of a cell's samples for every normal, shape (m, s**dim), see
        `studies.gap.sample_distances`; shape (m, 0) for exact volumes.
    length
        Number of cells along the gap (in 3D along both of its directions).

    Returns
    -------
    closing, opening
        Shape (m, k, 4), where the last axis has the order of `RULES`.

    Examples
    --------
    A gap along the axes, offset by half a cell, is joined through whole cells up to a width of one
    cell; with sub-cells it is open as soon as it is wider than half a cell.

    >>> import numpy as np
    >>> normal, exact = np.array([[1.0, 0.0]]), np.empty((1, 0))
    >>> closing, opening = measure_widths(normal, np.array([0.5]), exact, length=4)
    >>> opening.round(6).tolist()
    [[[1.0, 1.0, 1.0, 0.5]]]
    >>> closing.round(6).tolist()
    [[[1.0, 1.0, 1.0, 0.5]]]
    """
    widths = _measure(
        np.ascontiguousarray(normals, dtype=np.float64),
        np.asarray(offsets, dtype=np.float64),
        np.ascontiguousarray(distances, dtype=np.float64),
        length,
    )
    return widths[..., _CLOSED_BY], widths[..., _OPEN_BY]


# This is not cached, because numba's cache would not notice a change of `critical_width`.
@njit(parallel=True)
def _measure(
    normals: FloatArray, offsets: FloatArray, distances: FloatArray, length: int
) -> FloatArray:
    m, k = len(normals), len(offsets)
    widths = np.empty((m, k, len(RULES), 2))
    for i in prange(m * k):
        _measure_patch(
            normals[i // k], offsets[i % k], distances[i // k], length, widths[i // k, i % k]
        )
    return widths


@njit(cache=False)
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
