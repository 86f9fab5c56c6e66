"""Pair the holes of the filtration in space: the classes of dimension 1.

The nodes are added one by one.  A node comes with the cone over its *lower link*, the part of its
link that is already there, so what it changes is read off the lower link:

* A component of the lower link that is joined to another one outside the node closes a loop: the
  edge from the node to this component *creates* a class.
* The complement of the lower link on the sphere is the *upper link*.  If two of its components
  belong to the same component of all nodes still to come, the loop around one of them is filled:
  the node *destroys* a class.

Union-find over the nodes, forwards and backwards, therefore lists exactly the edges that create
and the loops that are filled, and only these are paired by reducing a matrix over GF(2).  A loop
consists of edges between nodes that are there; within a lower link an edge is moved along a
spanning tree, to earlier nodes, until only creating edges remain (discrete Morse theory after
Robins, Wood and Sheppard 2011; clearing after Chen and Kerber 2011).
"""

from __future__ import annotations

import numba
import numpy as np

from tusqh.sampling.doubled_grid import Multiples
from tusqh.topology.loop_matrix import CREATES, JOINS, PER_NODE, reduce_loops
from tusqh.topology.node_links import tabulate_links
from tusqh.topology.node_order import order_nodes
from tusqh.topology.union_find import Merges


def pair_loops(nodes: Multiples) -> Merges:
    """Return the persistence pairs of dimension 1 of a grid in space.

    Parameters
    ----------
    nodes
        Multiples of all nodes, see `tusqh.topology.clamping.clamp_multiples`; flat places belong to
        this array.

    Returns
    -------
    pairs
        Birth and death of every class that does not end as soon as it begins; a class that is never
        destroyed has death 0 and death place -1.

    Examples
    --------
    A ring of eight cells around an empty one:

    >>> from tusqh.topology.clamping import FULL, clamp_multiples
    >>> multiples = np.zeros((7, 7, 3), dtype=np.int32)
    >>> multiples[1::2, 1::2, 1] = FULL
    >>> multiples[3, 3, 1] = FULL // 4
    >>> [column.tolist() for column in pair_loops(clamp_multiples(multiples))[:2]]
    [[1048576], [262144]]
    """
    links = tabulate_links()
    strides = np.array([nodes.shape[1] * nodes.shape[2], nodes.shape[2], 1])
    steps = links.offsets @ strides
    order = order_nodes(nodes)
    lower = _find_lower_links(order, nodes.shape, links, steps)
    parents, created = _add_nodes(order, lower, links, steps)
    loops = _remove_nodes(order, lower, nodes.shape, links, steps)
    del lower
    killer = reduce_loops(created, loops, parents, order, links, steps)
    multiples = nodes.ravel()
    birth_place = order.place[created // PER_NODE].astype(np.int64)
    death_place = np.append(order.place.astype(np.int64), -1)[killer]
    birth = multiples[birth_place].astype(np.int64)
    death = np.where(killer < 0, 0, multiples[death_place]).astype(np.int64)
    lives = birth > death
    return Merges(birth[lives], death[lives], birth_place[lives], death_place[lives])


@numba.njit(cache=True)
def _find_lower_links(order, shape, links, steps):  # type: ignore[no-untyped-def]
    """Return the set of neighbours that come before each node, by rank."""
    n_x, n_y, n_z = shape
    rank, n = order.rank, len(order.place)
    lower = np.zeros(n, dtype=np.int32)
    for parity in (7, 1, 2, 4, 0):
        around = [a for a in range(27) if links.members[parity] >> a & 1]
        odd_x, odd_y, odd_z = parity & 1, parity >> 1 & 1, parity >> 2
        for i in range(2 - odd_x, n_x - 1, 2):
            for j in range(2 - odd_y, n_y - 1, 2):
                for k in range(2 - odd_z, n_z - 1, 2):
                    place = (i * n_y + j) * n_z + k
                    own = rank[place]
                    if own == n:
                        continue
                    found = 0
                    for a in around:
                        found |= (rank[place + steps[parity, a]] < own) << a
                    lower[own] = found
    return lower


@numba.njit(cache=True)
def _component(start, within, adjacent):  # type: ignore[no-untyped-def]
    """Return the component of a direction within a set of neighbours."""
    found, frontier = start, start
    while frontier:
        reached = 0
        for a in range(27):
            if frontier >> a & 1:
                reached |= adjacent[a]
        frontier = reached & within & ~found
        found |= frontier
    return found


@numba.njit(cache=True)
def _root(parent, at):  # type: ignore[no-untyped-def]
    """Return the root of a tree of a union-find structure."""
    while parent[at] != at:
        parent[at] = parent[parent[at]]
        at = parent[at]
    return at


@numba.njit(cache=True)
def _add_nodes(order, lower, links, steps):  # type: ignore[no-untyped-def]
    """Return the spanning forests of all lower links, and the edges that create classes.

    The row of a node is its table of parents: for each direction in the lower link the next one
    towards the root of its component, `JOINS` or `CREATES` for the root.
    """
    n = len(lower)
    parents = np.empty((n, 27), dtype=np.uint8)
    forest = np.arange(n, dtype=np.int32)
    created, n_created = np.empty(1024, dtype=np.int64), 0
    queue = np.empty(27, dtype=np.int64)
    joined = np.empty(27, dtype=np.int64)
    for own in range(n):
        place, parity = order.place[own], order.parity[own]
        adjacent = links.adjacent[parity]
        rest = np.int64(lower[own])
        n_joined = 0
        for top in range(27):
            if not rest >> top & 1:
                continue
            rest &= ~(1 << top)
            queue[0], first, last = top, 0, 1
            while first < last:
                a = queue[first]
                first += 1
                reached = adjacent[a] & rest
                rest &= ~reached
                b = 0
                while reached:
                    if reached & 1:
                        parents[own, b] = a
                        queue[last] = b
                        last += 1
                    reached >>= 1
                    b += 1
            component = _root(forest, order.rank[place + steps[parity, top]])
            parents[own, top] = JOINS
            for other in joined[:n_joined]:
                if other == component:
                    parents[own, top] = CREATES
            if parents[own, top] == JOINS:
                joined[n_joined] = component
                n_joined += 1
                continue
            if n_created == len(created):
                created = np.append(created, np.empty_like(created))
            created[n_created] = own * PER_NODE + top
            n_created += 1
        for other in joined[:n_joined]:
            forest[other] = own
    return parents, created[:n_created]


@numba.njit(cache=True)
def _remove_nodes(order, lower, shape, links, steps):  # type: ignore[no-untyped-def]
    """Return the loops that are filled: the rank of the node, and what the loop goes around.

    The nodes are removed from the last to the first, with union-find over those removed; nodes that
    never appear are removed from the start.
    """
    n = len(lower)
    forest = np.arange(len(order.rank), dtype=np.int32)
    _join_absent(forest, order.rank, n, shape, links, steps)
    found, n_found = np.empty((2, 1024), dtype=np.int64), 0
    joined = np.empty(27, dtype=np.int64)
    for own in range(n - 1, -1, -1):
        place, parity = order.place[own], order.parity[own]
        adjacent = links.adjacent[parity]
        rest = links.members[parity] & ~np.int64(lower[own])
        n_joined = 0
        for top in range(27):
            if not rest >> top & 1:
                continue
            component = _component(1 << top, rest, adjacent)
            rest &= ~component
            root = _root(forest, place + steps[parity, top])
            is_new = True
            for other in joined[:n_joined]:
                is_new = is_new and other != root
            if is_new:
                joined[n_joined] = root
                n_joined += 1
                continue
            if n_found == found.shape[1]:
                longer = np.empty((2, 2 * n_found), dtype=np.int64)
                longer[:, :n_found] = found
                found = longer
            found[0, n_found], found[1, n_found] = own, component
            n_found += 1
        for other in joined[:n_joined]:
            forest[other] = place
    return found[:, :n_found][:, ::-1].copy()


@numba.njit(cache=True)
def _join_absent(forest, rank, n, shape, links, steps):  # type: ignore[no-untyped-def]
    """Join the nodes that never appear to their earlier neighbours that never appear."""
    n_x, n_y, n_z = shape
    for i in range(1, n_x - 1):
        for j in range(1, n_y - 1):
            for k in range(1, n_z - 1):
                parity = i % 2 + 2 * (j % 2) + 4 * (k % 2)
                place = (i * n_y + j) * n_z + k
                if rank[place] < n:
                    continue
                for a in range(13):
                    if not links.members[parity] >> a & 1:
                        continue
                    x = i + links.offsets[parity, a, 0]
                    y = j + links.offsets[parity, a, 1]
                    z = k + links.offsets[parity, a, 2]
                    is_inside = x > 0 and 0 < y < n_y - 1 and 0 < z < n_z - 1
                    other = place + steps[parity, a]
                    if is_inside and rank[other] == n:
                        forest[_root(forest, other)] = _root(forest, place)
