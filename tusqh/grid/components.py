"""Components of graphs, and of cells that touch, by union-find."""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid.arrays import BoolArray, IndexArray, IntArray


def label_components(
    first: IndexArray | IntArray, second: IndexArray | IntArray, n: int
) -> tuple[IntArray, int]:
    """Return the component of every node of a graph, and the number of components.

    Components are numbered from 0, in the order of their lowest nodes.

    Parameters
    ----------
    first, second
        The nodes that each edge of the graph joins, shape (m,).
    n
        Number of nodes; one without an edge is a component of its own.

    Returns
    -------
    labels, n_components
        Component of every node, shape (n,); number of components.

    Examples
    --------
    >>> labels, n_components = label_components(np.array([3, 1]), np.array([0, 4]), 5)
    >>> labels.tolist(), n_components
    ([0, 1, 2, 0, 1], 3)
    """
    labels = np.arange(n, dtype=np.int64)
    one, other = (np.ascontiguousarray(ends, dtype=np.int64) for ends in (first, second))
    _join_pairs(one, other, labels)
    return labels, int(_number(labels))


def count_touching_cells(kept: BoolArray) -> IntArray:
    """Return the number of cells of each component of cells that touch, if only in a vertex.

    Parameters
    ----------
    kept
        Whether each cell belongs to the set, one axis for each dimension.

    Returns
    -------
    numpy.ndarray
        Number of cells of every component, in the order of their first cells.

    Examples
    --------
    >>> count_touching_cells(np.array([[1, 0, 0, 1], [0, 1, 0, 1]], dtype=bool)).tolist()
    [2, 2]
    """
    layers = np.ascontiguousarray(kept if kept.ndim == 3 else kept[None])
    labels = np.arange(kept.size, dtype=np.int32 if kept.size < 2**31 else np.int64)
    _join_cells(layers, labels)
    return np.asarray(_count_cells(layers.ravel(), labels))


@numba.njit(cache=True)
def _join(parent, a, b):  # type: ignore[no-untyped-def]
    """Join two nodes; the root of a component is its lowest node."""
    while parent[a] != a:
        parent[a] = parent[parent[a]]
        a = parent[a]
    while parent[b] != b:
        parent[b] = parent[parent[b]]
        b = parent[b]
    if a < b:
        parent[b] = a
    else:
        parent[a] = b


@numba.njit(cache=True)
def _join_pairs(first, second, parent):  # type: ignore[no-untyped-def]
    """Join the nodes of all pairs."""
    for k in range(len(first)):
        _join(parent, first[k], second[k])


@numba.njit(cache=True)
def _number(parent):  # type: ignore[no-untyped-def]
    """Replace parents, which are never higher, by numbers of components, and return how many."""
    n = 0
    for a in range(len(parent)):
        if parent[a] == a:
            parent[a] = n
            n += 1
        else:
            parent[a] = parent[parent[a]]
    return n


@numba.njit(cache=True)
def _join_cells(kept, parent):  # type: ignore[no-untyped-def]
    """Join each cell to the 13 cells around it that come before it."""
    nx, ny, nz = kept.shape
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                if not kept[i, j, k]:
                    continue
                cell = (i * ny + j) * nz + k
                for step in range(13):
                    x, y, z = i + step // 9 - 1, j + step // 3 % 3 - 1, k + step % 3 - 1
                    if x >= 0 and 0 <= y < ny and 0 <= z < nz and kept[x, y, z]:
                        _join(parent, cell, (x * ny + y) * nz + z)


@numba.njit(cache=True)
def _count_cells(kept, parent):  # type: ignore[no-untyped-def]
    """Count the cells of every component; parents become numbers of components."""
    n = 0
    for cell in range(len(kept)):
        if kept[cell]:
            if parent[cell] == cell:
                parent[cell] = n
                n += 1
            else:
                parent[cell] = parent[parent[cell]]
    counts = np.zeros(n, dtype=np.int64)
    for cell in range(len(kept)):
        if kept[cell]:
            counts[parent[cell]] += 1
    return counts
