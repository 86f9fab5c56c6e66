"""Compute the Betti curves of the filtration by union-find and counting, without a matrix.

One union-find counts the components.  The complement of a full subcomplex retracts onto the full
subcomplex of the other nodes, so the components of these nodes, less the outside, are the classes
of the highest dimension; the same union-find on the complement counts them.  The Euler
characteristic is counted directly and gives H_1 in 3D (algorithm 2).
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.doubled_grid import RESOLUTION, Multiples
from tusqh.topology.clamping import FULL, MARGIN
from tusqh.topology.euler_count import count_euler
from tusqh.topology.union_find import Merges


def tabulate_curves(nodes: Multiples, kept: Merges, empty: Merges) -> pd.DataFrame:
    """Return the Betti numbers between all distinct fractions.

    Parameters
    ----------
    nodes
        Multiples of all nodes, see `tusqh.topology.clamping.clamp_multiples`.
    kept, empty
        Merges of the nodes and of their complement, see `tusqh.topology.union_find`.

    Returns
    -------
    curves
        One row per plateau, from high to low thresholds: `upper` and `lower` (every threshold ``t``
        with ``lower < t <= upper`` gives the same complex); `width`; `betti_0`, `betti_1`,
        `betti_2` of that complex (raw: every pinch follows its own sub-cell fraction); `euler`, its
        Euler characteristic.
    """
    euler = np.cumsum(count_euler(nodes)[::-1])[::-1]
    return combine_counts(_levels(nodes), euler, (kept, empty), dim=nodes.ndim)


def combine_counts(
    levels: IntArray,
    euler: IntArray,
    merges: tuple[Merges, Merges],
    *,
    dim: int,
    n_outside: int = 1,
) -> pd.DataFrame:
    """Return the Betti numbers that components and Euler characteristics give.

    Parameters
    ----------
    levels
        The distinct multiples of all nodes, with 0 and FULL, from high to low.
    euler
        Euler characteristic at every level, shape (FULL + 1,).
    merges
        Merges of the kept nodes and of their complement, whose multiples are FULL + 1 less those
        of the nodes.
    dim
        Dimension of the complex.
    n_outside
        Number of components of the complement that enclose no hole or void.

    Returns
    -------
    curves
        See `tabulate_curves`.
    """
    kept, empty = merges
    upper, lower = levels[:-1], levels[1:]
    euler = euler[upper]
    components = _count_at_least(kept.birth, upper) - _count_at_least(kept.death, upper)
    outside = FULL + 2 - upper  # Lowest complement multiple of an absent node.
    enclosed = _count_at_least(empty.birth, outside) - _count_at_least(empty.death, outside)
    enclosed -= n_outside
    if dim == 2:
        betti = [components, enclosed, np.zeros_like(components)]
    else:
        betti = [components, components + enclosed - euler, enclosed]
    return pd.DataFrame(
        {
            "upper": upper * RESOLUTION,
            "lower": lower * RESOLUTION,
            "width": (upper - lower) * RESOLUTION,
            **{f"betti_{k}": numbers for k, numbers in enumerate(betti)},
            "euler": euler,
        }
    )


def persistence_by_cell(
    nodes: Multiples, kept: Merges, empty: Merges
) -> tuple[FloatArray, FloatArray]:
    """Return the persistence of the classes that each cell creates and of those it destroys.

    Parameters
    ----------
    nodes, kept, empty
        See `tabulate_curves`.

    Returns
    -------
    of_components
        Persistence of the component that begins in a cell, shape n; 0 elsewhere.
    of_enclosed
        Persistence of the hole (in 3D the void) that is filled last in a cell, shape n; 0
        elsewhere.

    Examples
    --------
    >>> from tusqh.topology.topology import Topology
    >>> fractions = np.zeros((7, 7))
    >>> fractions[1:-1, 1:-1] = 1.0
    >>> fractions[3, 3] = fractions[2:5, 2:5][1, 1] = 0.25      # a ring around one cell
    >>> components, holes = Topology.from_fractions(fractions).persistence_by_cell
    >>> float(components.max()), float(holes[1, 1])
    (1.0, 0.75)
    """
    shape = tuple((n - 2 * MARGIN) // 2 for n in nodes.shape)
    found = []
    # The complement's multiples are larger by one, so that the empty outside never merges.
    for merges, never in ((kept, 0), (empty, 1)):
        places = np.stack(np.unravel_index(merges.birth_place, nodes.shape)) // 2 - MARGIN // 2
        is_inside = ((places >= 0) & (places < np.array(shape)[:, None])).all(axis=0)
        lives = np.zeros(shape)
        lived = merges.birth - np.maximum(merges.death, never)
        lives[tuple(places[:, is_inside])] = lived[is_inside]
        found.append(lives * RESOLUTION)
    return found[0], found[1]


def _levels(nodes: Multiples) -> IntArray:
    """Return the distinct multiples of all nodes, with 0 and FULL, from high to low."""
    is_there = np.zeros(FULL + 1, dtype=bool)
    is_there[[0, FULL]] = True
    for index, layer in enumerate(nodes):
        # All places are nodes except edges in 2D and faces in 3D, which have dim - 1 odd indices.
        n_odd = index % 2 + np.indices(layer.shape).__mod__(2).sum(axis=0)
        is_there[layer[n_odd != nodes.ndim - 1]] = True
    return np.flatnonzero(is_there)[::-1].astype(np.int64)


def _count_at_least(keys: IntArray, levels: IntArray) -> IntArray:
    """Count the keys that are at least as large as each level."""
    ascending = np.sort(keys)
    return (len(keys) - np.searchsorted(ascending, levels, side="left")).astype(np.int64)
