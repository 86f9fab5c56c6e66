"""Reduce the matrix of loops: find, for each edge that creates a class, the loop that ends it.

Columns are the loops that are filled, as sums of edges over GF(2); rows are the edges that create
classes.  The latest edge of a loop is moved to earlier nodes until it creates a class; if a former
loop already ends that class, that loop is added, and else the two are a pair.  Edges before the
pair's are left as they are, because most loops never need them.
"""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid.arrays import IntArray
from tusqh.topology.node_links import NodeLinks
from tusqh.topology.node_order import NodeOrder

#: Entries of the table of parents for roots of a spanning forest: of a component that is joined
#: for the first time, and of one that closes a loop.
JOINS, CREATES = 27, 28

#: An edge is the rank of its later node times this, plus the direction of its other node.
PER_NODE = 32


def reduce_loops(
    created: IntArray,
    loops: IntArray,
    parents: np.ndarray,
    order: NodeOrder,
    links: NodeLinks,
    steps: IntArray,
) -> IntArray:
    """Return the rank of the node that destroys the class of each edge, -1 if none does.

    Parameters
    ----------
    created
        The edges that create classes, ascending, shape (n,).
    loops
        For each loop that is filled, in the order of their nodes, the rank of the node and the
        component of its upper link that the loop goes around, shape (2, m).
    parents
        For each node and each direction in its lower link the next direction towards the root of a
        spanning tree, `JOINS` or `CREATES` at the root, shape (number of nodes, 27).
    order
        The order of the nodes.
    links
        The links of nodes of every parity.
    steps
        Difference of flat places in each direction, shape (8, 27).
    """
    return np.asarray(_reduce(created, loops, parents, order, links, steps))


@numba.njit(cache=True)
def _push(heap, n, key):  # type: ignore[no-untyped-def]
    """Return a binary heap, whose first entry is the largest, with a further key."""
    if n == len(heap):
        heap = np.append(heap, np.empty_like(heap))
    at = n
    while at > 0 and heap[(at - 1) // 2] < key:
        heap[at] = heap[(at - 1) // 2]
        at = (at - 1) // 2
    heap[at] = key
    return heap, n + 1


@numba.njit(cache=True)
def _pop(heap, n):  # type: ignore[no-untyped-def]
    """Remove the largest key of a heap of n keys, and return it."""
    largest, key = heap[0], heap[n - 1]
    at = 0
    while True:
        below = 2 * at + 1
        if below >= n - 1:
            break
        if below + 1 < n - 1 and heap[below + 1] > heap[below]:
            below += 1
        if heap[below] <= key:
            break
        heap[at] = heap[below]
        at = below
    heap[at] = key
    return largest


@numba.njit(cache=True)
def _edge_between(own, a, b, order, links, steps):  # type: ignore[no-untyped-def]
    """Return the edge between two adjacent neighbours of a node."""
    place, parity = order.place[own], order.parity[own]
    rank_a = np.int64(order.rank[place + steps[parity, a]])
    rank_b = np.int64(order.rank[place + steps[parity, b]])
    if rank_a > rank_b:
        return rank_a * PER_NODE + links.seen_from[parity, a, b]
    return rank_b * PER_NODE + links.seen_from[parity, b, a]


@numba.njit(cache=True)
def _push_circle(heap, own, around, order, links, steps):  # type: ignore[no-untyped-def]
    """Return a heap with the edges of the loop around a component of a node's upper link."""
    n = 0
    for corners in links.triangles[order.parity[own]]:
        if corners[0] < 0:
            break
        n_in = 0
        for corner in corners:
            n_in += around >> corner & 1
        if n_in != 1:
            continue
        for c in range(3):
            if around >> corners[c] & 1:
                a, b = corners[(c + 1) % 3], corners[(c + 2) % 3]
                heap, n = _push(heap, n, _edge_between(own, a, b, order, links, steps))
    return heap, n


@numba.njit(cache=True)
def _reduce(created, loops, parents, order, links, steps):  # type: ignore[no-untyped-def]
    """Return the rank of the node that destroys each created class, -1 if none does."""
    killer = np.full(len(created), -1, dtype=np.int64)
    start = np.zeros(len(created) + 1, dtype=np.int64)
    stop = np.zeros(len(created) + 1, dtype=np.int64)
    pool, n_pool = np.empty(1024, dtype=np.int64), 0
    heap = np.empty(1024, dtype=np.int64)
    for column in range(loops.shape[1]):
        own, around = loops[0, column], loops[1, column]
        heap, n = _push_circle(heap, own, around, order, links, steps)
        while n > 0:
            key = _pop(heap, n)
            n -= 1
            if n > 0 and heap[0] == key:
                _pop(heap, n)
                n -= 1
                continue
            later, a = key // PER_NODE, key % PER_NODE
            parent = parents[later, a]
            if parent == JOINS:
                continue
            if parent < JOINS:
                heap, n = _push(heap, n, later * PER_NODE + parent)
                edge = _edge_between(later, a, parent, order, links, steps)
                heap, n = _push(heap, n, edge)
                continue
            row = np.searchsorted(created, key)
            if killer[row] >= 0:
                for entry in pool[start[row] : stop[row]]:
                    heap, n = _push(heap, n, entry)
                continue
            killer[row] = own
            rest = np.sort(heap[:n])
            start[row] = n_pool
            for entry in rest:
                if n_pool > start[row] and pool[n_pool - 1] == entry:
                    n_pool -= 1
                    continue
                if n_pool == len(pool):
                    pool = np.append(pool, np.empty_like(pool))
                pool[n_pool] = entry
                n_pool += 1
            stop[row] = n_pool
            break
    return killer
