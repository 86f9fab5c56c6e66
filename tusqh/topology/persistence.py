"""Persistence pairs of the filtration by gudhi, and the Betti numbers of every plateau."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.grid import BackgroundGrid, FloatArray, IntArray
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.filtration import Filtration


def persistence_pairs(filtration: Filtration) -> pd.DataFrame:
    """Return the pairs that live over a range of thresholds, and the classes that never die.

    Parameters
    ----------
    filtration
        The filtration, whose nodes enter by decreasing value.

    Returns
    -------
    pairs
        One row per pair, sorted: `dimension`; `birth` and `death`, the fractions at which the
        class appears and disappears as the threshold falls (death is 0 for classes that are
        still there at every threshold above 0, and `essential` is then True); `persistence` =
        birth - death; `birth_node` and `death_node`, the nodes whose entry creates and destroys
        the class (-1 where nothing destroys it).

    Examples
    --------
    Two cells that only their vertex joins: the younger component dies when it enters.

    >>> import numpy as np
    >>> from tusqh.topology.filtration import build_filtration
    >>> fractions = np.zeros((5, 5))
    >>> fractions[1, 1], fractions[3, 3], fractions[2, 2] = 1.0, 0.75, 0.5
    >>> persistence_pairs(build_filtration(fractions))[["dimension", "birth", "death"]].values
    array([[0.  , 1.  , 0.  ],
           [0.  , 0.75, 0.5 ]])
    """
    import gudhi

    tree = gudhi.SimplexTree()
    for k, simplices in enumerate(filtration.simplices):
        if len(simplices):
            tree.insert_batch(simplices.T.astype(np.int32), -filtration.simplex_values(k))
    tree.compute_persistence(homology_coeff_field=2, min_persistence=0.0)
    rows = [
        (len(born) - 1, _last_node(born, filtration), _last_node(died, filtration))
        for born, died in tree.persistence_pairs()
    ]
    dimension, birth_node, death_node = np.array(rows, dtype=np.int64).reshape(-1, 3).T
    birth = filtration.values[birth_node]
    is_essential = death_node < 0
    death = np.where(is_essential, 0.0, filtration.values[death_node])
    pairs = pd.DataFrame(
        {
            "dimension": dimension,
            "birth": birth,
            "death": death,
            "persistence": birth - death,
            "essential": is_essential,
            "birth_node": birth_node,
            "death_node": death_node,
        }
    )
    pairs = pairs[pairs["persistence"] > 0]
    order = ["dimension", "persistence", "birth", "birth_node"]
    return pairs.sort_values(order, ascending=[True, False, False, True]).reset_index(drop=True)


def locate_pairs(pairs: pd.DataFrame, filtration: Filtration, grid: BackgroundGrid) -> pd.DataFrame:
    """Return the pairs with the places, in model units, that create and destroy each class.

    The node columns give way to ``birth_x``, ``birth_y``, ..., ``death_x``, ..., empty (NaN)
    where nothing destroys the class.
    """
    located = pairs.drop(columns=["birth_node", "death_node"])
    for event in ("birth", "death"):
        node = pairs[f"{event}_node"].to_numpy()
        places = grid.to_points(filtration.positions[node] / 2.0)
        places[node < 0] = np.nan
        for axis in range(grid.dim):
            located[f"{event}_{'xyz'[axis]}"] = places[:, axis]
    return located


def list_plateaus(filtration: Filtration, pairs: pd.DataFrame) -> pd.DataFrame:
    """Return the thresholds between which neither cells nor sub-cells change.

    Parameters
    ----------
    filtration
        The filtration.
    pairs
        Its pairs, see `persistence_pairs`.

    Returns
    -------
    plateaus
        One row per plateau, from high to low thresholds: every threshold ``t`` with
        ``lower < t <= upper`` gives the same complex; `width`; `betti_0`, `betti_1`, `betti_2`
        of that complex (raw: every pinch follows its own sub-cell fraction).

    Examples
    --------
    >>> import numpy as np
    >>> from tusqh.topology.filtration import build_filtration
    >>> fractions = np.zeros((5, 3))
    >>> fractions[1, 1], fractions[3, 1] = 0.75, 0.25
    >>> filtration = build_filtration(fractions)
    >>> list_plateaus(filtration, persistence_pairs(filtration)).iloc[:, :4].values
    array([[1.  , 0.75, 0.25, 0.  ],
           [0.75, 0.25, 0.5 , 1.  ],
           [0.25, 0.  , 0.25, 1.  ]])
    """
    levels = np.unique(filtration.values)[::-1]
    levels = np.unique(np.concatenate([[0.0, 1.0], levels[levels <= 1.0]]))[::-1]
    upper, lower = levels[:-1], levels[1:]
    plateaus = pd.DataFrame({"upper": upper, "lower": lower, "width": upper - lower})
    for dimension in range(3):
        of_dimension = pairs[pairs["dimension"] == dimension]
        born = _count_at_least(of_dimension["birth"].to_numpy(), upper)
        dead = _count_at_least(of_dimension["death"].to_numpy(), upper)
        plateaus[f"betti_{dimension}"] = born - dead
    return plateaus


def betti_at(plateaus: pd.DataFrame, threshold: float) -> BettiNumbers:
    """Return the raw Betti numbers of the plateau that holds a threshold in (0, 1]."""
    row = plateaus[(plateaus["lower"] < threshold) & (threshold <= plateaus["upper"])].iloc[0]
    return BettiNumbers(int(row["betti_0"]), int(row["betti_1"]), int(row["betti_2"]))


def _last_node(simplex: list[int], filtration: Filtration) -> int:
    """Return the node of a simplex that enters last; the highest number among equals."""
    return max(simplex, key=lambda node: (-filtration.values[node], node)) if simplex else -1


def _count_at_least(values: FloatArray, thresholds: FloatArray) -> IntArray:
    """Count the values that are at least as large as each threshold."""
    ascending = np.sort(values)
    return (len(values) - np.searchsorted(ascending, thresholds, side="left")).astype(np.int64)
