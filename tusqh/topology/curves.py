"""Betti curves of the filtration at any size: union-find and counting, no matrix.

Components are counted by one union-find.  The complement of a full subcomplex retracts onto the
full subcomplex of the other nodes, so the components of those, less the outside, are the classes
of the highest dimension: the same union-find on the complement.  The Euler characteristic is
counted, and gives H_1 in 3D (algorithm 2).
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.doubled_grid import RESOLUTION, Multiples
from tusqh.topology.clamping import FULL, clamp_multiples, complement
from tusqh.topology.euler_count import count_euler
from tusqh.topology.union_find import merge_components


def betti_curves(values: FloatArray) -> pd.DataFrame:
    """Return the Betti numbers between all distinct fractions.

    Parameters
    ----------
    values
        Fractions on the doubled grid, shape ``2 n + 1``, multiples of `RESOLUTION`.

    Returns
    -------
    plateaus
        One row per plateau, from high to low thresholds: every threshold ``t`` with
        ``lower < t <= upper`` gives the same complex; `width`; `betti_0`, `betti_1`, `betti_2`
        of that complex (raw: every pinch follows its own sub-cell fraction); `euler`, its Euler
        characteristic.

    Examples
    --------
    >>> import numpy as np
    >>> fractions = np.zeros((5, 3))
    >>> fractions[1, 1], fractions[3, 1] = 0.75, 0.25
    >>> betti_curves(fractions).iloc[:, :4].values
    array([[1.  , 0.75, 0.25, 0.  ],
           [0.75, 0.25, 0.5 , 1.  ],
           [0.25, 0.  , 0.25, 1.  ]])
    """
    keys = clamp_multiples(_to_multiples(values))
    levels = _levels(keys)
    upper, lower = levels[:-1], levels[1:]
    euler = np.cumsum(count_euler(keys)[::-1])[::-1][upper]
    born, died, _, _ = merge_components(keys)
    components = _count_at_least(born, upper) - _count_at_least(died, upper)
    born, died, _, _ = merge_components(complement(keys))
    outside = FULL + 2 - upper  # The lowest complement key of a node that is out.
    enclosed = _count_at_least(born, outside) - _count_at_least(died, outside) - 1
    if values.ndim == 2:
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


def outer_pairs(values: FloatArray) -> pd.DataFrame:
    """Return the persistence pairs of the lowest and the highest dimension, from union-find.

    The table is that of `tusqh.topology.persistence.persistence_pairs` without its rows of
    dimension 1 in 3D; `birth_place` and `death_place` are flat indices into the doubled grid of
    shape ``2 n + 1``, -1 where nothing destroys the class.

    Examples
    --------
    Two cells that only their vertex joins: the younger component dies when it enters.

    >>> import numpy as np
    >>> fractions = np.zeros((5, 5))
    >>> fractions[1, 1], fractions[3, 3], fractions[2, 2] = 1.0, 0.75, 0.5
    >>> outer_pairs(fractions)[["dimension", "birth", "death", "death_place"]].values
    array([[ 0.  ,  1.  ,  0.  , -1.  ],
           [ 0.  ,  0.75,  0.5 , 12.  ]])
    """
    keys = clamp_multiples(_to_multiples(values))
    born, died, born_at, died_at = merge_components(keys)
    tables = [_to_table(0, born, died, born_at, died_at)]
    born, died, born_at, died_at = merge_components(complement(keys))
    is_enclosed = died > 0  # What never merges in the complement is the outside.
    tables.append(
        _to_table(
            values.ndim - 1,
            # A class exists from the key at which its void is cut off until it is filled.
            FULL + 1 - died[is_enclosed],
            FULL + 1 - born[is_enclosed],
            died_at[is_enclosed],
            born_at[is_enclosed],
        )
    )
    pairs = pd.concat(tables, ignore_index=True)
    for event in ("birth", "death"):
        place = np.array(np.unravel_index(np.maximum(pairs[f"{event}_place"], 0), keys.shape)) - 2
        inner = np.ravel_multi_index(tuple(np.maximum(place, 0)), values.shape)
        pairs[f"{event}_place"] = np.where(pairs[f"{event}_place"] < 0, -1, inner)
    pairs.loc[pairs["essential"], "death_place"] = -1
    order = ["dimension", "persistence", "birth", "birth_place"]
    return pairs.sort_values(order, ascending=[True, False, False, True]).reset_index(drop=True)


def persistence_by_cell(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how long the classes live that each cell creates, and those that each destroys.

    Parameters
    ----------
    values
        Fractions on the doubled grid, shape ``2 n + 1``.

    Returns
    -------
    of_components
        Persistence of the component that begins in a cell, shape n; 0 elsewhere.
    of_enclosed
        Persistence of the hole (in 3D the void) that closes up in a cell, shape n; 0 elsewhere.

    Examples
    --------
    >>> import numpy as np
    >>> fractions = np.zeros((7, 7))
    >>> fractions[1:-1, 1:-1] = 1.0
    >>> fractions[3, 3] = fractions[2:5, 2:5][1, 1] = 0.25      # a ring around one cell
    >>> components, holes = persistence_by_cell(fractions)
    >>> float(components.max()), float(holes[1, 1])
    (1.0, 0.75)
    """
    keys = clamp_multiples(_to_multiples(values))
    shape = tuple(n // 2 for n in values.shape)
    found = []
    for of_nodes in (keys, complement(keys)):
        born, died, born_at, _ = merge_components(of_nodes)
        places = np.stack(np.unravel_index(born_at, keys.shape)) // 2 - 1
        is_inside = ((places >= 0) & (places < np.array(shape)[:, None])).all(axis=0)
        lives = np.zeros(shape)
        # The complement's keys are above 0 by one, so that the empty outside never merges.
        never = 0 if of_nodes is keys else 1
        lives[tuple(places[:, is_inside])] = (born - np.maximum(died, never))[is_inside]
        found.append(lives * RESOLUTION)
    return found[0], found[1]


def _to_table(
    dimension: int, born: IntArray, died: IntArray, born_at: IntArray, died_at: IntArray
) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "dimension": dimension,
            "birth": born * RESOLUTION,
            "death": died * RESOLUTION,
            "persistence": (born - died) * RESOLUTION,
            "essential": died == 0,
            "birth_place": born_at,
            "death_place": died_at,
        }
    )


def _to_multiples(values: FloatArray) -> Multiples:
    """Return fractions as multiples of `RESOLUTION`."""
    return np.rint(np.asarray(values) / RESOLUTION).astype(np.int32)


def _levels(keys: Multiples) -> IntArray:
    """Return the distinct keys of all nodes, with 0 and FULL, from high to low."""
    is_there = np.zeros(FULL + 1, dtype=bool)
    is_there[[0, FULL]] = True
    for index, layer in enumerate(keys):
        # Nodes are all places but edges in 2D and faces in 3D: those with dim - 1 odd indices.
        n_odd = index % 2 + np.indices(layer.shape).__mod__(2).sum(axis=0)
        is_there[layer[n_odd != keys.ndim - 1]] = True
    return np.flatnonzero(is_there)[::-1].astype(np.int64)


def _count_at_least(keys: IntArray, levels: IntArray) -> IntArray:
    """Count the keys that are at least as large as each level."""
    ascending = np.sort(keys)
    return (len(keys) - np.searchsorted(ascending, levels, side="left")).astype(np.int64)
