"""Track how the components of the filtration merge, by one union-find over its cells.

Cells, their faces, and the links at edges and vertices (`tusqh.topology.vertex_links`) are added
in decreasing order of their multiples.  When two components meet, the younger one dies (the elder
rule); if both are equally old, the one with the lower cell is the elder.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid import doubled
from tusqh.grid.arrays import IntArray
from tusqh.sampling.doubled_grid import Multiples
from tusqh.topology.clamping import FULL
from tusqh.topology.vertex_links import find_links

#: Death place of a component that never merges.
NEVER = -1


class Merges(NamedTuple):
    """The persistence pairs of components, without those with equal birth and death.

    Parameters
    ----------
    birth, death
        Multiples at which each component appears and merges into an older one, shape (n,); death
        is 0 for components that never merge.
    birth_place, death_place
        Flat places on the doubled grid of the cell that creates each component, and of the cell,
        edge or vertex that merges it, shape (n,); `NEVER` for components that never merge.
    """

    birth: IntArray
    death: IntArray
    birth_place: IntArray
    death_place: IntArray


class _Forest(NamedTuple):
    """The union-find structure.

    Parameters
    ----------
    parent
        Parent of every cell, the cell itself for a root, -1 for cells not yet present, shape (n,).
    cells
        Multiple of every cell, shape (n,).
    shape
        Shape of the grid, shape (dim,).
    """

    parent: NDArray[np.int32]
    cells: NDArray[np.int32]
    shape: IntArray


def merge_components(nodes: Multiples) -> Merges:
    """Return how the components of the filtration merge.

    Parameters
    ----------
    nodes
        Multiples of all nodes, see `tusqh.topology.clamping.clamp_multiples`, or their
        complement; flat places belong to this array.

    Examples
    --------
    Only a vertex joins these two cells:

    >>> nodes = np.zeros((5, 5), dtype=np.int32)
    >>> nodes[1, 1], nodes[3, 3], nodes[2, 2] = 4, 3, 2
    >>> [column.tolist() for column in merge_components(nodes)]
    [[3, 4], [2, 0], [18, 6], [12, -1]]
    """
    cells = np.ascontiguousarray(nodes[doubled.cells(nodes.ndim)])
    links = find_links(nodes)
    link_order = np.argsort(-links.level, kind="stable").astype(np.int32)
    shape = np.array(cells.shape, dtype=np.int64)
    flat = cells.ravel()
    return Merges(*_union_find(flat, shape, _order(flat), links, link_order))


@numba.njit(cache=True)
def _order(cells):  # type: ignore[no-untyped-def]
    """Return the cells with multiples above 0 in descending order, by a counting sort."""
    start = np.zeros(FULL + 3, dtype=np.int64)
    for multiple in cells:
        start[FULL + 2 - multiple] += 1
    n = len(cells) - start[FULL + 2]
    start = np.cumsum(start)
    order = np.empty(n, dtype=np.int32)
    for cell in range(len(cells)):
        if cells[cell] > 0:
            at = FULL + 1 - cells[cell]
            order[start[at]] = cell
            start[at] += 1
    return order


@numba.njit(cache=True)
def _union_find(cells, shape, order, links, link_order):  # type: ignore[no-untyped-def]
    """Return birth, death, birth place and death place of every component, shape (4, n)."""
    dim = len(shape)
    stride = np.ones(dim, dtype=np.int64)
    for axis in range(dim - 2, -1, -1):
        stride[axis] = stride[axis + 1] * shape[axis + 1]
    parent = np.full(len(cells), -1, dtype=np.int32)
    forest = _Forest(parent, cells, shape)
    found, n = np.empty((4, 1024), dtype=np.int64), 0
    next_link = 0
    for step in range(len(order) + 1):
        level = cells[order[step]] if step < len(order) else 0
        while next_link < len(link_order) and links.level[link_order[next_link]] > level:
            at = link_order[next_link]
            next_link += 1
            a, b, joins_at = links.cell[at], links.other[at], links.level[at]
            found, n = _merge(forest, a, b, joins_at, links.place[at], found, n)
        if step == len(order):
            break
        cell = order[step]
        parent[cell] = cell
        place = _place_of(cell, shape)
        for axis in range(dim):
            index = cell // stride[axis] % shape[axis]
            for sign in (-1, 1):
                other = cell + sign * stride[axis]
                if 0 <= index + sign < shape[axis] and parent[other] >= 0:
                    found, n = _merge(forest, cell, other, level, place, found, n)
    for cell in order:
        if parent[cell] == cell:
            found, n = _record(found, n, cells[cell], 0, _place_of(cell, shape), NEVER)
    return found[:, :n]


@numba.njit(cache=True)
def _merge(forest, a, b, level, place, found, n):  # type: ignore[no-untyped-def]
    """Join the components of two cells at a level, and record the death of the younger one."""
    parent, cells = forest.parent, forest.cells
    a, b = _root(parent, a), _root(parent, b)
    if a == b:
        return found, n
    if cells[a] < cells[b] or (cells[a] == cells[b] and a > b):
        a, b = b, a
    parent[b] = a
    if cells[b] == level:
        return found, n
    return _record(found, n, cells[b], level, _place_of(b, forest.shape), place)


@numba.njit(cache=True)
def _root(parent, cell):  # type: ignore[no-untyped-def]
    """Return the eldest cell of the component of a cell."""
    while parent[cell] != cell:
        parent[cell] = parent[parent[cell]]
        cell = parent[cell]
    return cell


@numba.njit(cache=True)
def _place_of(cell, shape):  # type: ignore[no-untyped-def]
    """Return the flat place of a cell on the doubled grid, given its flat number."""
    place, stride = 0, 1
    for axis in range(len(shape) - 1, -1, -1):
        place += (2 * (cell % shape[axis]) + 1) * stride
        stride *= 2 * shape[axis] + 1
        cell //= shape[axis]
    return place


@numba.njit(cache=True)
def _record(found, n, birth, death, birth_place, death_place):  # type: ignore[no-untyped-def]
    """Return the table with a further column, and its number of columns."""
    if n == found.shape[1]:
        longer = np.empty((4, 2 * n), dtype=np.int64)
        longer[:, :n] = found
        found = longer
    found[0, n], found[1, n], found[2, n], found[3, n] = birth, death, birth_place, death_place
    return found, n + 1
