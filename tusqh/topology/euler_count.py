"""Count the simplices of the filtration at every level, and their Euler characteristic.

Every simplex of the complex has a place of lowest dimension on the doubled grid: the cell for a
single cell, the face for a pair of cells, or the edge or vertex that is its lowest node.
Therefore the complex is the disjoint union of one *star* per place::

    cell      the cell                                                        +1
    face      the pair of its two cells                                       -1
    edge      the edge, coned to its 4 cells and the 4 pairs of these         1 - 4 + 4
    vertex    the vertex, coned to its 8 cells, 12 pairs and 6 edges, and to  1 - 8 + 12
              each edge with its 4 cells and 4 pairs                          - 6 + 24 - 24

A simplex appears together with its last node, at the smallest of their multiples.  A grid in the
plane is a layer of cells in space, so its vertices have the star of an edge.
"""

from __future__ import annotations

import itertools
from functools import cache
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid.arrays import IntArray
from tusqh.grid.doubled import Offset, as_layer, cells_around, unit_offsets
from tusqh.sampling.doubled_grid import Multiples
from tusqh.topology.clamping import FULL


class _Stars(NamedTuple):
    """The simplices of the star of every parity.

    Parameters
    ----------
    start
        The star of parity ``p`` (bit 0 for x) has the rows ``start[p] <= row < start[p + 1]``.
    nodes
        Offsets to the nodes of each simplex, shape (n, 4, 3); nodes are repeated to make four.
    dimension
        Dimension of each simplex, shape (n,).
    """

    start: IntArray
    nodes: IntArray
    dimension: IntArray


def count_euler(nodes: Multiples) -> IntArray:
    """Return the increment of the Euler characteristic at each level.

    Parameters
    ----------
    nodes
        Multiples of all nodes, see `tusqh.topology.clamping.clamp_multiples`.

    Returns
    -------
    change
        Shape (`FULL` + 1,); the Euler characteristic at level ``k`` is ``change[k:].sum()``.

    Examples
    --------
    Two full cells side by side: two vertices and an edge between them.

    >>> from tusqh.topology.clamping import clamp_multiples
    >>> multiples = np.zeros((5, 3), dtype=np.int32)
    >>> multiples[1::2, 1] = FULL
    >>> int(count_euler(clamp_multiples(multiples))[FULL])
    1
    """
    stars = _stars()
    sign = 1 - 2 * (stars.dimension % 2)
    return np.asarray(_count_stars(nodes, np.zeros_like(sign), sign)[0])


def count_euler_at(nodes: Multiples | NDArray[np.uint8], level: int) -> int:
    """Return the Euler characteristic at one level.

    Parameters
    ----------
    nodes
        Multiples of all nodes, see `tusqh.topology.clamping.clamp_multiples`.
    level
        Positive multiple of `tusqh.sampling.doubled_grid.RESOLUTION`.

    Examples
    --------
    >>> from tusqh.topology.clamping import clamp_multiples
    >>> multiples = np.zeros((5, 3), dtype=np.int32)
    >>> multiples[1::2, 1] = [3, 1]
    >>> [count_euler_at(clamp_multiples(multiples), level) for level in (1, 2, 4)]
    [1, 1, 0]
    """
    layer, stars = as_layer(nodes), _stars()
    stride = [layer.shape[1] * layer.shape[2], layer.shape[2], 1]
    sign = 1 - 2 * (stars.dimension % 2)
    total = np.add.reduceat(sign, stars.start[:-1])
    steps = stars.nodes @ stride
    return int(_count_at(layer, layer.ravel(), stars.start, steps, sign, total, level))


def count_simplices(nodes: Multiples) -> IntArray:
    """Return the number of simplices of each dimension that appear at each level.

    Parameters
    ----------
    nodes
        Multiples of all nodes, see `tusqh.topology.clamping.clamp_multiples`.

    Returns
    -------
    numbers
        Shape (4, `FULL` + 1); those of level 0 never appear.

    Examples
    --------
    >>> from tusqh.topology.clamping import clamp_multiples
    >>> multiples = np.zeros((5, 3), dtype=np.int32)
    >>> multiples[1::2, 1] = FULL
    >>> count_simplices(clamp_multiples(multiples))[:, FULL].tolist()
    [2, 1, 0, 0]
    """
    stars = _stars()
    return _count_stars(nodes, stars.dimension, np.ones_like(stars.dimension))


def _count_stars(nodes: Multiples, row: IntArray, number: IntArray) -> IntArray:
    """Add, at the level of each simplex, its number to its row of a table."""
    table = np.zeros((int(row.max()) + 1, FULL + 1), dtype=np.int64)
    layer, stars = as_layer(nodes), _stars()
    stride = [layer.shape[1] * layer.shape[2], layer.shape[2], 1]
    total = np.zeros((8, len(table)), dtype=np.int64)
    np.add.at(total, (np.repeat(np.arange(8), np.diff(stars.start)), row), number)
    _count(layer, layer.ravel(), stars.start, stars.nodes @ stride, row, number, total, table)
    return table


@cache
def _stars() -> _Stars:
    simplices = [_star((p & 1, p >> 1 & 1, p >> 2)) for p in range(8)]
    rows = [s for star in simplices for s in star]
    dimension = np.array([len(s) - 1 for s in rows], dtype=np.int64)
    start = np.cumsum([0, *map(len, simplices)])
    nodes = np.array([(s * 4)[:4] for s in rows], dtype=np.int64)
    return _Stars(start, nodes, dimension)


def _star(parity: Offset) -> list[tuple[Offset, ...]]:
    """List the simplices, by their nodes, whose place of lowest dimension has the given parity."""
    here, cells = (0, 0, 0), cells_around(parity)
    pairs = [p for p in itertools.combinations(cells, 2) if _n_different(*p) == 1]
    if sum(parity) == 3:
        return [(here,)]
    if sum(parity) == 2:
        return [*pairs]
    link: list[tuple[Offset, ...]] = [*((c,) for c in cells), *pairs]
    if sum(parity) == 0:
        cones = [
            (edge, *s) for edge in unit_offsets(3) for s in link if all(_touch(edge, c) for c in s)
        ]
        link += [*((edge,) for edge in unit_offsets(3)), *cones]
    return [(here,), *((here, *s) for s in link)]


def _n_different(a: Offset, b: Offset) -> int:
    return sum(x != y for x, y in zip(a, b, strict=True))


def _touch(edge: Offset, cell: Offset) -> bool:
    """Return whether an edge and a cell around one vertex touch."""
    return sum(a * b for a, b in zip(edge, cell, strict=True)) == 1


@numba.njit(cache=True)
def _count(nodes, flat, start, steps, row, number, total, table):  # type: ignore[no-untyped-def]
    n_x, n_y, n_z = nodes.shape
    for i in range(1, n_x - 1):
        for j in range(1, n_y - 1):
            for k in range(1, n_z - 1):
                odd_i, odd_j, odd_k = i % 2, j % 2, k % 2
                low, high = FULL, 0
                for x in range(i - 1 + odd_i, i + 2 - odd_i, 2):
                    for y in range(j - 1 + odd_j, j + 2 - odd_j, 2):
                        for z in range(k - 1 + odd_k, k + 2 - odd_k, 2):
                            low, high = min(low, nodes[x, y, z]), max(high, nodes[x, y, z])
                parity = odd_i + 2 * odd_j + 4 * odd_k
                if low == high:  # All nodes have this multiple, so the whole star appears at once.
                    for d in range(len(table)):
                        table[d, low] += total[parity, d]
                    continue
                place = (i * n_y + j) * n_z + k
                for s in range(start[parity], start[parity + 1]):
                    level = min(
                        flat[place + steps[s, 0]],
                        flat[place + steps[s, 1]],
                        flat[place + steps[s, 2]],
                        flat[place + steps[s, 3]],
                    )
                    table[row[s], level] += number[s]


@numba.njit(cache=True)
def _count_at(nodes, flat, start, steps, sign, total, level):  # type: ignore[no-untyped-def]
    """Return the sum of the signs of the simplices whose nodes all have at least a level."""
    n_x, n_y, n_z = nodes.shape
    euler = 0
    for i in range(1, n_x - 1):
        for j in range(1, n_y - 1):
            for k in range(1, n_z - 1):
                odd_i, odd_j, odd_k = i % 2, j % 2, k % 2
                low, high = FULL, 0
                for x in range(i - 1 + odd_i, i + 2 - odd_i, 2):
                    for y in range(j - 1 + odd_j, j + 2 - odd_j, 2):
                        for z in range(k - 1 + odd_k, k + 2 - odd_k, 2):
                            low, high = min(low, nodes[x, y, z]), max(high, nodes[x, y, z])
                if high < level:  # Every simplex of the star has a cell or a clamped node.
                    continue
                parity = odd_i + 2 * odd_j + 4 * odd_k
                if low >= level:
                    euler += total[parity]
                    continue
                place = (i * n_y + j) * n_z + k
                for s in range(start[parity], start[parity + 1]):
                    is_there = True
                    for node in range(4):
                        is_there = is_there and flat[place + steps[s, node]] >= level
                    if is_there:
                        euler += sign[s]
    return euler
