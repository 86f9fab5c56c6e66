"""Add and remove simple cells, which change nothing about the topology, in compiled code.

A cell is *simple* if the neighbours of its link that are present form a contractible set.  On a
sphere (in the plane, on a circle) this means that they are not none and connected, and so are the
neighbours that are absent.  Which ones are present:

* a cell across a face, if it is kept;
* an edge or vertex that is pinched with or without the cell, if it votes to connect;
* any other edge or vertex, if another kept cell touches it.  Its own link is contractible with and
  without the cell, so the choice does not matter except where only this cell touches it.
"""

from __future__ import annotations

import heapq

import numba
import numpy as np


@numba.njit(cache=True)
def is_simple(cell, place, kept, votes, link):  # type: ignore[no-untyped-def]
    """Return whether a cell can be added or removed without a change of topology.

    Parameters
    ----------
    cell, place
        Flat index of the cell, and of its place on the doubled grid.
    kept
        Kept cells, flat, with a layer of empty cells around them.
    votes
        Which edges and vertices vote to connect, on the doubled grid of these cells, flat.
    link
        See `tusqh.local_topology.link.Link`.
    """
    present = _find_present(cell, place, kept, votes, link)
    every = (1 << len(link.cell)) - 1
    return _is_one_piece(present, link.joined) and _is_one_piece(every & ~present, link.joined)


@numba.njit(cache=True)
def find_pieces(cell, place, kept, votes, link):  # type: ignore[no-untyped-def]
    """Return the connected pieces of the present neighbours and of the absent ones, as bits.

    There is one of each for a simple cell.  No present one makes an island, two join or close a
    loop; two absent ones close a membrane, and no absent one fills a void (in the plane a hole).

    Parameters
    ----------
    cell, place, kept, votes, link
        See `is_simple`.
    """
    present = _find_present(cell, place, kept, votes, link)
    every = (1 << len(link.cell)) - 1
    return _split(present, link.joined), _split(every & ~present, link.joined)


@numba.njit(cache=True)
def find_events(cells, places, pieces, most, kept, votes, link):  # type: ignore[no-untyped-def]
    """Return the first cells whose neighbours have given numbers of pieces.

    Parameters
    ----------
    cells, places
        Flat indices of the cells, and of their places on the doubled grid, shape (r,), int64.
    pieces
        The numbers of present and of absent pieces, see `find_pieces`.
    most
        Largest number of cells to return.
    kept, votes, link
        See `is_simple`.
    """
    found = np.empty(most, dtype=np.int64)
    n = 0
    for r in range(len(cells)):
        present, absent = find_pieces(cells[r], places[r], kept, votes, link)
        if len(present) == pieces[0] and len(absent) == pieces[1]:
            found[n] = cells[r]
            n += 1
            if n == most:
                break
    return found[:n]


@numba.njit(cache=True)
def _find_present(cell, place, kept, votes, link):  # type: ignore[no-untyped-def]
    """Return the neighbours of a cell that are present, as bits."""
    present = 0
    for i in range(len(link.cell)):
        k, others = link.codimension[i], 0
        for b in range(1 << k):
            if b != link.own[i] and kept[cell + link.around[i, b]]:
                others |= 1 << b
        if link.is_pinched[k, others] or link.is_pinched[k, others | 1 << link.own[i]]:
            is_present = votes[place + link.place[i]]
        else:
            is_present = others != 0
        if is_present:
            present |= 1 << i
    return present


@numba.njit(cache=True)
def _split(chosen, joined):  # type: ignore[no-untyped-def]
    """Return the connected pieces of a set of neighbours, as bits."""
    pieces, n = np.empty(len(joined), dtype=np.int64), 0
    while chosen:
        reached = chosen & -chosen
        while True:
            grown = reached
            for i in range(len(joined)):
                if reached >> i & 1:
                    grown |= joined[i]
            grown &= chosen
            if grown == reached:
                break
            reached = grown
        chosen &= ~reached
        pieces[n] = reached
        n += 1
    return pieces[:n]


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


@numba.njit(cache=True)
def change_simple(cells, places, kept, votes, link, rank):  # type: ignore[no-untyped-def]
    """Add or remove cells while they are simple, in place, until none of those left is.

    Of the cells that are simple, the first in the given order is changed next.

    Parameters
    ----------
    cells
        Flat indices of the cells to change, first the most urgent, shape (r,), int64.
    places
        Their places on the doubled grid, shape (r,), int64.
    kept, votes, link
        See `is_simple`; `kept` changes.
    rank
        Room for a number per cell, all -1 before and after, shape (n,), int32.

    Returns
    -------
    is_changed
        Which of the cells were changed, shape (r,).
    """
    n = len(cells)
    is_changed, is_queued = np.zeros(n, dtype=np.bool_), np.ones(n, dtype=np.bool_)
    rank[cells] = np.arange(n)
    queue = list(np.arange(n))  # An ascending list is a heap.
    while len(queue):
        r = heapq.heappop(queue)
        is_queued[r] = False
        if not is_simple(cells[r], places[r], kept, votes, link):
            continue
        kept[cells[r]] = not kept[cells[r]]
        is_changed[r] = True
        # The cell is in the link of all its neighbours, which may have become simple.
        for step in link.cell:
            other = np.int64(rank[cells[r] + step])
            if other >= 0 and not is_changed[other] and not is_queued[other]:
                is_queued[other] = True
                heapq.heappush(queue, other)
    rank[cells] = -1
    return is_changed
