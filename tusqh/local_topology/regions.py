"""Follow kept or empty cells from one to the next, in compiled code.

Kept cells are joined across a face, and around an edge or vertex that votes to connect; empty cells
across a face, and around an edge or vertex that votes to separate.  Whether such an edge or vertex
is pinched does not matter, because cells around others are joined across faces anyway.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid import BoolArray, IntArray
from tusqh.local_topology.link import Link

#: Marks of cells: reached from neither side, or from one of the two.
_FREE = -1


class Field(NamedTuple):
    """What decides which cells are joined; a kernel takes it as one argument.

    Parameters
    ----------
    votes
        Which places of the doubled grid vote to connect, flat.
    link
        See `tusqh.local_topology.link.Link`.
    shape, place_step
        Number of cells along every axis, and the difference of the flat numbers of places between
        neighbours on the doubled grid, shape (dim,).
    bridged
        Pairs of kept cells that bridges join, shape (r, 2).
    side
        From which side each cell was reached; `_FREE` everywhere between two calls, shape (n,).
    """

    votes: BoolArray
    link: Link
    shape: IntArray
    place_step: IntArray
    bridged: IntArray
    side: NDArray[np.int8]


@numba.njit(cache=True)
def split_around(cell, first, second, kept, follows_kept, known, field):  # type: ignore[no-untyped-def]
    """Return whether two pieces of the neighbours of a cell are joined without this cell.

    Both sides grow in turns, so the time depends on the smaller one.

    Parameters
    ----------
    cell
        The flat cell, which is passed by neither side.
    first, second
        Numbers of the neighbours in each piece, as bits.
    kept
        Kept cells, flat, with a layer of empty cells around them.
    follows_kept
        Whether kept cells are followed, not empty ones.
    known
        Names of some cells, above 0, of which each side finds one if it is not joined to the other,
        shape (n,); empty: none are wanted.
    field
        See `Field`.

    Returns
    -------
    is_joined
        Whether the two are joined.
    cells
        All cells of the side that was exhausted.
    names
        Name of a cell of this side, and of one of the other; 0 if unknown.
    """
    side, link = field.side, field.link
    queues = np.empty((2, 256), dtype=np.int64)
    lengths, heads = np.zeros(2, dtype=np.int64), np.zeros(2, dtype=np.int64)
    names, is_outside = np.zeros(2, dtype=np.int64), np.zeros(2, dtype=np.bool_)
    side[cell] = 2
    is_joined = False
    near = np.empty(256, dtype=np.int64)
    for s in range(2):
        bits = first if s == 0 else second
        n = 0
        for i in range(len(link.cell)):
            if bits >> i & 1:
                n = _add_around(cell, i, kept, follows_kept, link, near, n)
        queues, is_met = _visit(near, n, s, side, queues, lengths)
        is_joined = is_joined or is_met
    finished = -1
    while not is_joined:
        s = 0 if lengths[0] <= lengths[1] else 1
        if finished >= 0:
            s = 1 - finished
        if heads[s] == lengths[s]:
            if finished >= 0:
                break
            finished = s
            if len(known) == 0 and not is_outside[s]:
                break
            if names[1 - s] > 0 and not is_outside[s]:
                break
            continue
        at = queues[s, heads[s]]
        heads[s] += 1
        if len(known) and known[at] > 0:
            names[s] = known[at]
            if finished >= 0:
                break
        n = _find_next(at, kept, follows_kept, field, near)
        if n < 0:
            is_outside[s] = True
            is_joined = is_outside[0] and is_outside[1]
            continue
        queues, is_joined = _visit(near, n, s, side, queues, lengths)
    side[cell] = _FREE
    for s in range(2):
        side[queues[s, : lengths[s]]] = _FREE
    done = max(finished, 0)
    found = np.array([names[done], names[1 - done]])
    return is_joined, queues[done, : lengths[done]].copy(), found


@numba.njit(cache=True)
def flood(starts, kept, follows_kept, known, field):  # type: ignore[no-untyped-def]
    """Return all cells that are joined to some cells, and whether they reach the outside.

    Parameters
    ----------
    starts
        Flat cells, shape (r,).
    kept, follows_kept
        See `split_around`.
    known
        Names of cells, shape (n,).  A cell with a name above 0 is reached but not passed; empty:
        all cells are passed.
    field
        See `Field`.

    Returns
    -------
    cells
        All cells that were reached, the first ones among them.
    is_outside
        Whether the outermost layer was reached.
    """
    queues, lengths = np.empty((2, 256), dtype=np.int64), np.zeros(2, dtype=np.int64)
    queues, _ = _visit(starts, len(starts), 0, field.side, queues, lengths)
    near = np.empty(256, dtype=np.int64)
    head, is_outside = 0, False
    while head < lengths[0]:
        at = queues[0, head]
        head += 1
        if len(known) and known[at] > 0:
            continue
        n = _find_next(at, kept, follows_kept, field, near)
        if n < 0:
            is_outside = True
            continue
        queues, _ = _visit(near, n, 0, field.side, queues, lengths)
    found = queues[0, : lengths[0]].copy()
    field.side[found] = _FREE
    return found, is_outside


@numba.njit(cache=True)
def _visit(cells, n, s, side, queues, lengths):  # type: ignore[no-untyped-def]
    """Append the first n cells to the queue of a side; return it, and if the other had one."""
    is_met = False
    for cell in cells[:n]:
        if side[cell] == 1 - s:
            is_met = True
        if side[cell] != _FREE:
            continue
        side[cell] = s
        if lengths[s] == queues.shape[1]:
            longer = np.empty((2, 2 * queues.shape[1]), dtype=np.int64)
            longer[:, : queues.shape[1]] = queues
            queues = longer
        queues[s, lengths[s]] = cell
        lengths[s] += 1
    return queues, is_met


@numba.njit(cache=True)
def _find_next(cell, kept, follows_kept, field, near):  # type: ignore[no-untyped-def]
    """Write the cells joined to one; return how many, or -1 for a cell in the outermost layer."""
    link, place, rest = field.link, 0, cell
    for axis in range(len(field.shape) - 1, -1, -1):
        index = rest % field.shape[axis]
        if index == 0 or index == field.shape[axis] - 1:
            return -1
        place += (2 * index + 1) * field.place_step[axis]
        rest //= field.shape[axis]
    n = 0
    for i in range(len(link.cell)):
        if link.codimension[i] == 1 or field.votes[place + link.place[i]] == follows_kept:
            n = _add_around(cell, i, kept, follows_kept, link, near, n)
    if follows_kept:
        for pair in field.bridged:
            for k in range(2):
                if pair[k] == cell:
                    near[n] = pair[1 - k]
                    n += 1
    return n


@numba.njit(cache=True)
def _add_around(cell, i, kept, follows_kept, link, near, n):  # type: ignore[no-untyped-def]
    """Append the kept or empty cells around a neighbour but one; return the new number."""
    for b in range(1 << link.codimension[i]):
        other = cell + link.around[i, b]
        if b != link.own[i] and kept[other] == follows_kept:
            near[n] = other
            n += 1
    return n
