"""Separate a component from the rest by the fewest cells: a minimum cut between the two.

A component that ended above the base is joined to others at several places there, which are also
loops.  One event cannot separate it; a minimum cut removes all joints together.  It lies between
the cells that belonged to the component before it ended and the other cells of that level.
"""

from __future__ import annotations

import itertools

import numpy as np

from tusqh.grid import BoolArray, IntArray
from tusqh.local_topology.workspace import Workspace

#: Capacity of a link that is never cut.
_ENDLESS = 1_000_000


def separate(
    space: Workspace, kept: BoolArray, inside: BoolArray, outside: BoolArray, is_fixed: BoolArray
) -> BoolArray | None:
    """Return kept cells without those of a minimum cut between two sets, None if there is none.

    Parameters
    ----------
    space
        Votes of the contacts.
    kept
        Kept cells of the flat grid.
    inside, outside
        Cells on the two sides, of the flat grid; cells of the one that touch the other may be cut.
    is_fixed
        Cells that must not be cut.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import breadth_first_order, maximum_flow

    cells = np.flatnonzero(kept)
    first, second = _find_links(space, kept)
    crosses = (inside[first] & outside[second]) | (outside[first] & inside[second])
    may_be_cut = ~(inside | outside)
    may_be_cut[first[crosses]] = may_be_cut[second[crosses]] = True
    may_be_cut &= ~is_fixed
    number = np.full(len(kept), -1, dtype=np.int64)
    number[cells] = np.arange(len(cells))
    n = len(cells)
    source, sink = 2 * n, 2 * n + 1
    # Every cell is a link from its entrance k to its exit k + n.
    sides = number[inside & kept & ~may_be_cut], number[outside & kept & ~may_be_cut]
    if not len(sides[0]) or not len(sides[1]):
        return None
    a, b = number[first], number[second]
    start = np.concatenate(
        [np.arange(n), a + n, b + n, np.full(len(sides[0]), source), sides[1] + n]
    )
    end = np.concatenate([np.arange(n) + n, b, a, sides[0], np.full(len(sides[1]), sink)])
    capacity = np.full(len(start), _ENDLESS, dtype=np.int32)
    capacity[:n] = np.where(may_be_cut[cells], 1, _ENDLESS)
    graph = coo_array((capacity, (start, end)), shape=(2 * n + 2,) * 2).tocsr()
    found = maximum_flow(graph, source, sink)
    if found.flow_value >= _ENDLESS:
        return None
    rest = graph - found.flow
    rest.data[rest.data < 0] = 0
    rest.eliminate_zeros()
    is_reached = np.zeros(2 * n + 2, dtype=bool)
    is_reached[breadth_first_order(rest, source, return_predecessors=False)] = True
    cut = cells[is_reached[:n] & ~is_reached[n : 2 * n]]
    without = kept.copy()
    without[cut] = False
    return without


def _find_links(space: Workspace, kept: BoolArray) -> tuple[IntArray, IntArray]:
    """Return the pairs of kept cells that a face, edge or vertex may join.

    An edge or vertex joins cells if it votes to connect, whatever other cells are kept around it.
    """
    grid, connects = kept.reshape(space.shape), _widen(np.pad(space.votes, 2))
    flat = np.arange(grid.size).reshape(space.shape)
    pairs = []
    for step in itertools.product((-1, 0, 1), repeat=space.dim):
        if step <= (0,) * space.dim:
            continue
        along = list(zip(step, space.shape, strict=True))
        here = tuple(slice(max(0, -s), n - max(0, s)) for s, n in along)
        there = tuple(slice(max(0, s), n - max(0, -s)) for s, n in along)
        both = grid[here] & grid[there]
        if sum(map(abs, step)) > 1:
            both &= connects[
                tuple(slice(2 * max(0, -s) + 1 + s, 2 * (n - max(0, s)) + s, 2) for s, n in along)
            ]
        pairs.append((flat[here][both], flat[there][both]))
    first, second = (np.concatenate(side) for side in zip(*pairs, strict=True))
    return first, second


def _widen(votes: BoolArray) -> BoolArray:
    """Return which edges and vertices join cells; an edge also does so by a vertex at its ends."""
    connects = votes.copy()
    if votes.ndim == 3:
        for axis in range(3):
            edges = tuple(slice(1, -1, 2) if k == axis else slice(0, None, 2) for k in range(3))
            ends = votes[tuple(slice(0, None, 2) for _ in range(3))]
            lower = tuple(slice(0, -1) if k == axis else slice(None) for k in range(3))
            upper = tuple(slice(1, None) if k == axis else slice(None) for k in range(3))
            connects[edges] |= ends[lower] | ends[upper]
    return connects
