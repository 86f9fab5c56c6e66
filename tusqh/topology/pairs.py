"""List the persistence pairs of the filtration, and count those with equal birth and death.

Components, and the classes of the highest dimension, come from union-find (the complement gives the
latter); the classes of dimension 1 in space come from `tusqh.topology.loops`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.grid import IntArray
from tusqh.sampling.doubled_grid import RESOLUTION, Multiples
from tusqh.topology.clamping import FULL, MARGIN, complement
from tusqh.topology.euler_count import count_simplices
from tusqh.topology.loops import pair_loops
from tusqh.topology.union_find import Merges, merge_components


def tabulate_pairs(nodes: Multiples, kept: Merges, empty: Merges) -> pd.DataFrame:
    """Return the persistence pairs of all dimensions with positive persistence.

    Parameters
    ----------
    nodes, kept, empty
        See `tusqh.topology.curves.tabulate_curves`.

    Returns
    -------
    pairs
        See `tusqh.topology.topology.Topology.pairs`.
    """
    tables = [_to_table(0, kept), _to_table(nodes.ndim - 1, _enclosed(empty))]
    if nodes.ndim == 3:
        tables.insert(1, _to_table(1, pair_loops(nodes)))
    pairs = _on_grid(pd.concat(tables, ignore_index=True), nodes.shape)
    pairs.loc[pairs["essential"], "death_place"] = -1
    order = ["dimension", "persistence", "birth", "birth_place"]
    return pairs.sort_values(order, ascending=[True, False, False, True]).reset_index(drop=True)


def tabulate_dimension(nodes: Multiples, dimension: int) -> pd.DataFrame:
    """Return the persistence pairs of one dimension above 0, in no particular order.

    Parameters
    ----------
    nodes
        See `tusqh.topology.curves.tabulate_curves`.
    dimension
        1, or 2 in space.

    Returns
    -------
    pairs
        See `tusqh.topology.topology.Topology.pairs`.
    """
    if dimension == nodes.ndim - 1:
        pairs = find_enclosed(nodes, merge_components(complement(nodes)))
    else:
        pairs = _on_grid(_to_table(dimension, pair_loops(nodes)), nodes.shape)
    return pairs


def find_enclosed(nodes: Multiples, empty: Merges) -> pd.DataFrame:
    """Return the pairs of the highest dimension, all with a place where they would end.

    Parameters
    ----------
    nodes, empty
        See `tusqh.topology.curves.tabulate_curves`.

    Returns
    -------
    pairs
        See `tusqh.topology.topology.Topology.pairs`; a class that never ends has a cell of its
        region as `death_place`.
    """
    return _on_grid(_to_table(nodes.ndim - 1, _enclosed(empty)), nodes.shape)


def count_on_diagonal(nodes: Multiples, pairs: pd.DataFrame) -> pd.DataFrame:
    """Return the number of pairs with equal birth and death, by dimension and birth.

    Every simplex either creates a class of its dimension or destroys one of the dimension below, so
    the numbers of simplices at each level, less those of the listed pairs, give them.

    Parameters
    ----------
    nodes
        Multiples of all nodes, see `tusqh.topology.clamping.clamp_multiples`.
    pairs
        See `tabulate_pairs`.

    Returns
    -------
    diagonal
        The columns `dimension`, `birth` and `pairs`; rows with no pair are left out.
    """
    rest = count_simplices(nodes)
    tables = []
    for dimension in range(nodes.ndim):
        of_dimension = pairs[pairs["dimension"] == dimension]
        level = {e: np.rint(of_dimension[e] / RESOLUTION).astype(int) for e in ("birth", "death")}
        rest[dimension] -= np.bincount(level["birth"], minlength=FULL + 1)
        rest[dimension + 1] -= np.bincount(level["death"], minlength=FULL + 1) + rest[dimension]
        at = 1 + np.flatnonzero(rest[dimension, 1:])  # Nothing happens at level 0.
        columns = {"dimension": dimension, "birth": at * RESOLUTION, "pairs": rest[dimension, at]}
        tables.append(pd.DataFrame(columns))
    return pd.concat(tables, ignore_index=True)


def _enclosed(empty: Merges) -> Merges:
    """Return the classes of the highest dimension, given how components of the complement merge."""
    is_enclosed = empty.death > 0  # A component that never merges in the complement is outside.
    # A class exists from the multiple at which its void is cut off until it is filled.
    return Merges(
        birth=FULL + 1 - empty.death[is_enclosed],
        death=FULL + 1 - empty.birth[is_enclosed],
        birth_place=empty.death_place[is_enclosed],
        death_place=empty.birth_place[is_enclosed],
    )


def _on_grid(pairs: pd.DataFrame, shape: tuple[int, ...]) -> pd.DataFrame:
    """Return pairs with flat places of the doubled grid, given those of all nodes."""
    for event in ("birth", "death"):
        pairs[f"{event}_place"] = _without_margin(pairs[f"{event}_place"].to_numpy(), shape)
    return pairs


def _to_table(dimension: int, merges: Merges) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "dimension": dimension,
            "birth": merges.birth * RESOLUTION,
            "death": merges.death * RESOLUTION,
            "persistence": (merges.birth - merges.death) * RESOLUTION,
            "essential": merges.death == 0,
            "birth_place": merges.birth_place,
            "death_place": merges.death_place,
        }
    )


def _without_margin(places: IntArray, shape: tuple[int, ...]) -> IntArray:
    """Return flat places of the doubled grid without its margin; -1 stays."""
    index = np.array(np.unravel_index(np.maximum(places, 0), shape)) - MARGIN
    inner = np.ravel_multi_index(tuple(np.maximum(index, 0)), tuple(n - 2 * MARGIN for n in shape))
    return np.asarray(np.where(places < 0, -1, inner), dtype=np.int64)
