"""Relabel cells from one material to another where this changes no topology, in compiled code.

A cell may be relabelled from one material to another if it is *simple* for both, see
`tusqh.local_topology.simple_cells`: its link in the complex of the one and in that of the other are
contractible.  The contacts around it vote among the materials of their cells, so the relabelling
itself can change which material wins a contact.  It is refused if this joins or separates any
material there: if the contact is pinched for a material before and after, and that material has its
ball or stick only before or only after.
"""

from __future__ import annotations

import heapq

import numba
import numpy as np

#: Presence of a neighbour that a relabelling would change by itself.
_REFUSED = -1


@numba.njit(cache=True)
def relabel_simple(cells, places, goals, labels, entries, thresholds, link):  # type: ignore[no-untyped-def]
    """Give cells the materials they should have while this is simple, in place.

    Of the cells that are simple, the first in the given order is relabelled next.

    Parameters
    ----------
    cells
        Flat indices of the cells, first the most urgent, shape (r,), int64.
    places
        Their places on the doubled grid, shape (r,), int64.
    goals
        The materials they should have, shape (r,).
    labels
        Material of every cell, flat, with a layer of void around them; it changes.
    entries
        `start`, `material` and `multiple` of `tusqh.contacts.MaterialFractions`.
    thresholds
        Threshold of every material, in multiples of 2**-20, shape (m,).
    link
        See `tusqh.local_topology.link.Link`.

    Returns
    -------
    is_changed
        Which of the cells were relabelled, shape (r,).
    """
    n = len(cells)
    is_changed, is_queued = np.zeros(n, dtype=np.bool_), np.ones(n, dtype=np.bool_)
    rank = np.full(len(labels), -1, dtype=np.int64)
    rank[cells] = np.arange(n)
    queue = list(np.arange(n))  # An ascending list is a heap.
    while len(queue):
        r = heapq.heappop(queue)
        is_queued[r] = False
        if not may_relabel(cells[r], places[r], goals[r], labels, entries, thresholds, link):
            continue
        labels[cells[r]] = goals[r]
        is_changed[r] = True
        for step in link.cell:
            other = rank[cells[r] + step]
            if other >= 0 and not is_changed[other] and not is_queued[other]:
                is_queued[other] = True
                heapq.heappush(queue, other)
    return is_changed


@numba.njit(cache=True)
def may_relabel(cell, place, goal, labels, entries, thresholds, link):  # type: ignore[no-untyped-def]
    """Return whether a cell can be relabelled without a change of the topology of any material.

    Parameters
    ----------
    cell, place
        Flat index of the cell, and of its place on the doubled grid.
    goal
        The material it should have, another one than it has.
    labels, entries, thresholds, link
        See `relabel_simple`.
    """
    own = labels[cell]
    loses, gains = 0, 0
    for i in range(len(link.cell)):
        k, mine = link.codimension[i], 1 << link.own[i]
        of_own, of_goal = 0, 0
        for b in range(1 << k):
            if b != link.own[i]:
                of_own |= (labels[cell + link.around[i, b]] == own) << b
                of_goal |= (labels[cell + link.around[i, b]] == goal) << b
        before = after = _REFUSED
        if k > 1 and of_own | of_goal | mine != (1 << (1 << k)) - 1:
            # Cells of a third material: contacts may change their winner.
            before = _winner(i, own, cell, place, labels, entries, thresholds, link)
            after = _winner(i, goal, cell, place, labels, entries, thresholds, link)
            if before != after and (
                _is_third_pinched(i, before, own, goal, cell, labels, link)
                or _is_third_pinched(i, after, own, goal, cell, labels, link)
            ):
                return False
        for material, others in ((own, of_own), (goal, of_goal)):
            without, with_it = link.is_pinched[k, others], link.is_pinched[k, others | mine]
            if not (without or with_it):
                is_present = others != 0
            else:
                if before == _REFUSED:
                    before = _winner(i, own, cell, place, labels, entries, thresholds, link)
                    after = _winner(i, goal, cell, place, labels, entries, thresholds, link)
                if without and with_it and (before == material) != (after == material):
                    return False
                # The one of the two states in which the contact decides about the material.
                now = with_it if material == own else without
                is_present = (before if now else after) == material
            if is_present and material == own:
                loses |= 1 << i
            elif is_present:
                gains |= 1 << i
    every = (1 << len(link.cell)) - 1
    return (
        _is_one_piece(loses, link.joined)
        and _is_one_piece(every & ~loses, link.joined)
        and _is_one_piece(gains, link.joined)
        and _is_one_piece(every & ~gains, link.joined)
    )


@numba.njit(cache=True)
def _winner(i, own, cell, place, labels, entries, thresholds, link):  # type: ignore[no-untyped-def]
    """Return the material for which neighbour i votes if the cell itself has a given material."""
    start, material, multiple = entries
    at = place + link.place[i]
    best, f = own, np.int64(0)
    for e in range(start[at], start[at + 1]):
        if material[e] == own:
            f = np.int64(multiple[e])
    for b in range(1 << link.codimension[i]):
        if b == link.own[i]:
            continue
        k = labels[cell + link.around[i, b]]
        if k == best:
            continue
        g = np.int64(0)
        for e in range(start[at], start[at + 1]):
            if material[e] == k:
                g = np.int64(multiple[e])
        left, right = g, f
        if f > 0 and g > 0:
            left, right = g * thresholds[best], f * thresholds[k]
        if left > right or (left == right and k < best):
            best, f = k, g
    return best


@numba.njit(cache=True)
def _is_third_pinched(i, material, own, goal, cell, labels, link):  # type: ignore[no-untyped-def]
    """Return whether a neighbour is pinched for a material that the cell has neither way."""
    if material in (own, goal):
        return False
    mask = 0
    for b in range(1 << link.codimension[i]):
        if b != link.own[i]:
            mask |= (labels[cell + link.around[i, b]] == material) << b
    return link.is_pinched[link.codimension[i], mask]


# `simple_cells` has the same function.  The kernels that call it are too long for one file, and the
# functions that numba keeps on disk do not notice changes of a function in another file.
@numba.njit(cache=True)
def _is_one_piece(chosen, joined):  # type: ignore[no-untyped-def]
    """Return whether a set of neighbours is connected and not empty."""
    reached = chosen & -chosen
    if reached == 0:
        return False
    while True:
        grown = reached
        for i in range(len(joined)):
            if reached >> i & 1:
                grown |= joined[i]
        grown &= chosen
        if grown == reached:
            return reached == chosen
        reached = grown
