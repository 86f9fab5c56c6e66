"""Find the topology that most grid placements share, and the grid that makes it robust."""

from __future__ import annotations

import numpy as np
import pandas as pd

from studies.orientation import BETTI, SCHEMES
from tusqh.grid import BoolArray, FloatArray
from tusqh.settings.goal import Target
from tusqh.threshold.goals import matches
from tusqh.topology.betti_numbers import BettiNumbers

#: A topology is robust if at least the first share of placements has it at some threshold, and an
#: accident if at most the second share has it at every threshold.
ROBUST, ACCIDENT = 0.9, 0.1


def map_stability(table: pd.DataFrame, *, name: str, target: Target | None = None) -> pd.DataFrame:
    """Return the most frequent topology at each grid size and threshold, and its share.

    Parameters
    ----------
    table
        See `vary_placement`.
    name
        The model.
    target
        The Betti numbers that the model must have.

    Returns
    -------
    stability
        One row per `cells`, `threshold` and `scheme`: the most frequent `betti_*`, the share of
        placements with them (`agreement`), the number of distinct `topologies`, and the share of
        placements with the `wanted` topology (missing without a target).
    """
    rows = []
    for (cells, threshold, scheme), group in table.groupby(
        ["cells", "threshold", "scheme"], sort=True
    ):
        topologies, agreement, betti = most_frequent(group[BETTI].to_numpy(float))
        share = float(matches(group, target).mean()) if target is not None else float("nan")
        rows.append(
            {
                "model": name,
                "cells": cells,
                "threshold": threshold,
                "scheme": scheme,
                **betti._asdict(),
                "agreement": agreement,
                "topologies": topologies,
                "wanted": share,
            }
        )
    return pd.DataFrame(rows)


def recommend_grid(stability: pd.DataFrame, table: pd.DataFrame) -> pd.DataFrame:
    """Return the coarsest grid on which a topology is robust, and the other topologies on it.

    Parameters
    ----------
    stability
        The stability of one model, see `map_stability`.
    table
        The placements from which it was made.

    Returns
    -------
    recommended
        One row per scheme: the `cells` along the longest side of the coarsest grid on which at
        least nine of ten placements share a topology (the wanted one, if there is one) at one
        `threshold`, the middle of the longest run of such thresholds, or, without such a grid, of
        the grid with the largest share; the `share` of placements; whether it is `robust`; the
        `betti_*`; and, over all thresholds of that grid, the numbers of `topologies`, of those that
        are robust at some threshold (`robust_topologies`), and of `accidents`, which at most one of
        ten placements has at every threshold.
    """
    rows = []
    for scheme in SCHEMES:
        of_scheme = stability[stability["scheme"] == scheme]
        of_scheme = of_scheme.sort_values(["cells", "threshold"])
        # The empty mesh is robust too, but useless.
        agreement = of_scheme["agreement"].where(of_scheme["betti_0"] > 0, 0.0)
        share = of_scheme["wanted"].fillna(agreement)
        is_robust = share >= ROBUST
        cells = of_scheme["cells"][is_robust].min() if is_robust.any() else None
        if cells is None:
            place = int(share.to_numpy().argmax())
        else:
            on_grid = (of_scheme["cells"] == cells).to_numpy()
            place = _middle_of_longest_run(on_grid & is_robust.to_numpy())
        row = of_scheme.iloc[place]
        found = float(share.iloc[place])
        placed = table[(table["scheme"] == scheme) & (table["cells"] == row["cells"])]
        counts = placed.groupby(["threshold", *BETTI]).size() / placed["placement"].nunique()
        largest = counts.groupby(BETTI).max()
        rows.append(
            {
                "model": row["model"],
                "scheme": scheme,
                "cells": row["cells"],
                "threshold": row["threshold"],
                "share": found,
                "robust": found >= ROBUST,
                **{key: row[key] for key in BETTI},
                "topologies": len(largest),
                "robust_topologies": int((largest >= ROBUST).sum()),
                "accidents": int((largest <= ACCIDENT).sum()),
            }
        )
    return pd.DataFrame(rows)


def most_frequent(numbers: FloatArray) -> tuple[int, float, BettiNumbers]:
    """Return the number of distinct topologies, and the share and numbers of the most frequent.

    Parameters
    ----------
    numbers
        Betti numbers, one row per placement, shape (n, 3).

    Returns
    -------
    count, share, numbers
        Number of distinct topologies; share of the most frequent one, from 0 to 1; its Betti
        numbers.
    """
    rows, counts = np.unique(numbers.astype(np.int64), axis=0, return_counts=True)
    most = int(counts.argmax())
    return len(rows), float(counts[most] / counts.sum()), BettiNumbers(*rows[most].tolist())


def _middle_of_longest_run(flags: BoolArray) -> int:
    """Return the index in the middle of the longest run of true flags.

    >>> _middle_of_longest_run(np.array([True, False, True, True, True]))
    3
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    starts, stops = edges[::2], edges[1::2]
    longest = int((stops - starts).argmax())
    return int((starts[longest] + stops[longest] - 1) // 2)
