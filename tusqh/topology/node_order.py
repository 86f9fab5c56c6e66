"""Order the nodes of the filtration in space, so that few of them change the topology.

Any order of nodes with equal multiples gives the same persistence pairs, except for pairs with
equal birth and death.  This one makes few of those: an edge or vertex that is as full as its
fullest cell comes directly after the first such cell, and every other edge or vertex comes before
all cells of its multiple.  Then nearly every node is added along a contractible part of its link.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.sampling.doubled_grid import Multiples
from tusqh.topology.clamping import FULL


class NodeOrder(NamedTuple):
    """The order in which nodes appear as the threshold falls.

    Parameters
    ----------
    place
        Flat place of every node with a positive multiple, in their order, shape (n,), int32.
    rank
        Position of every flat place in that order, int32; n for places that never appear.
    parity
        Parity of every node, in their order, shape (n,); bit 0 is that of the first axis.
    """

    place: NDArray[np.int32]
    rank: NDArray[np.int32]
    parity: NDArray[np.uint8]


def order_nodes(nodes: Multiples) -> NodeOrder:
    """Return the order of the nodes of a grid in space.

    Parameters
    ----------
    nodes
        Multiples of all nodes, see `tusqh.topology.clamping.clamp_multiples`.

    Examples
    --------
    Two full cells, then the edges and vertices between them and nothing else:

    >>> from tusqh.topology.clamping import clamp_multiples
    >>> multiples = np.zeros((5, 3, 3), dtype=np.int32)
    >>> multiples[1::2, 1, 1] = FULL
    >>> len(order_nodes(clamp_multiples(multiples)).place)
    2
    """
    return NodeOrder(*_order(nodes, nodes.ravel()))


@numba.njit(cache=True)
def _order(nodes, flat):  # type: ignore[no-untyped-def]
    n_x, n_y, n_z = nodes.shape
    start = np.zeros(FULL + 2, dtype=np.int64)
    n = 0
    for i in range(1, n_x - 1):
        for j in range(1, n_y - 1):
            for k in range(1, n_z - 1):
                if i % 2 + j % 2 + k % 2 != 2 and nodes[i, j, k] > 0:
                    start[FULL + 1 - nodes[i, j, k]] += 1
                    n += 1
    start = np.cumsum(start)
    order = np.empty(n, dtype=np.int32)
    rank = np.full(len(flat), n, dtype=np.int32)
    parity = np.empty(n, dtype=np.uint8)
    for n_odd in (1, 0, 3):
        for i in range(2 - n_odd % 2, n_x - 1):
            for j in range(1, n_y - 1):
                for k in range(1, n_z - 1):
                    multiple = nodes[i, j, k]
                    if i % 2 + j % 2 + k % 2 != n_odd or multiple == 0:
                        continue
                    place = (i * n_y + j) * n_z + k
                    if n_odd == 3:
                        _add(order, rank, start, multiple, place)
                        _add_attached(nodes, i, j, k, order, rank, start)
                    elif nodes.ravel()[_first_fullest(nodes, i, j, k)] > multiple:
                        _add(order, rank, start, multiple, place)
    for i in range(1, n_x - 1):
        for j in range(1, n_y - 1):
            for k in range(1, n_z - 1):
                at = rank[(i * n_y + j) * n_z + k]
                if at < n:
                    parity[at] = i % 2 + 2 * (j % 2) + 4 * (k % 2)
    return order, rank, parity


@numba.njit(cache=True)
def _add(order, rank, start, multiple, place):  # type: ignore[no-untyped-def]
    """Append a place to those with its multiple."""
    at = start[FULL - multiple]
    order[at] = place
    rank[place] = at
    start[FULL - multiple] += 1


@numba.njit(cache=True)
def _add_attached(nodes, i, j, k, order, rank, start):  # type: ignore[no-untyped-def]
    """Append the edges, then the vertices, that come directly after a cell."""
    n_y, n_z = nodes.shape[1], nodes.shape[2]
    own, multiple = (i * n_y + j) * n_z + k, nodes[i, j, k]
    for n_signs in (2, 3):
        for x in range(i - 1, i + 2):
            for y in range(j - 1, j + 2):
                for z in range(k - 1, k + 2):
                    if abs(x - i) + abs(y - j) + abs(z - k) != n_signs:
                        continue
                    if nodes[x, y, z] == multiple and _first_fullest(nodes, x, y, z) == own:
                        _add(order, rank, start, multiple, (x * n_y + y) * n_z + z)


@numba.njit(cache=True)
def _first_fullest(nodes, i, j, k):  # type: ignore[no-untyped-def]
    """Return the flat place of the first of the fullest cells around an edge or vertex."""
    n_y, n_z = nodes.shape[1], nodes.shape[2]
    best, found = -1, 0
    for x in range(i - 1 + i % 2, i + 2 - i % 2, 2):
        for y in range(j - 1 + j % 2, j + 2 - j % 2, 2):
            for z in range(k - 1 + k % 2, k + 2 - k % 2, 2):
                if nodes[x, y, z] > best:
                    best, found = nodes[x, y, z], (x * n_y + y) * n_z + z
    return found
