"""The topology that the mesh will have at every threshold, as plateaus and as intervals."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.grid import FloatArray, IntArray

BETTI = ["betti_0", "betti_1", "betti_2"]

#: Fields of open outlines have tens of thousands of plateaus, nearly all too narrow to be a
#: robust choice.  So many are looked at on a small grid, fewer where each one takes longer.
MAX_PLATEAUS = 1000
MIN_PLATEAUS = 100
_CELLS_TO_LOOK_AT = 20_000_000


def predict_plateaus(
    cell_sets: CellSets,
    raw: pd.DataFrame,
    *,
    progress: Callable[[int, int], None] | None = None,
) -> pd.DataFrame:
    """Return plateaus of the threshold with the Betti numbers that their meshes will have.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    raw
        Plateaus with raw Betti numbers, see `tusqh.topology.curves.betti_curves`.
    progress
        Called with (plateaus done, plateaus in all).

    Returns
    -------
    predicted
        One row per plateau, from high to low: every threshold ``t`` with ``lower < t <= upper``
        gives the same mesh; `width`; `threshold`, its middle; `cells` kept; `clusters` of
        pinches and how many were `overruled`; `bridges`, components `removed` and `filled`
        holes or voids; `betti_0`, `betti_1`, `betti_2` of the mesh and ``raw_betti_*`` of the
        filtration; `raw_agrees`, whether these are the same.  Of too many plateaus the widest
        half and an even spread of the others are looked at.
    """
    levels = np.append(cell_sets.levels, 0.0)
    if levels[0] < 1.0:
        levels = np.append(1.0, levels)
    upper, lower = levels[:-1], levels[1:]
    chosen = _choose(upper, lower, cell_sets.fractions.grid.n_cells)
    upper, lower = upper[chosen], lower[chosen]
    of_raw = _row_of(raw, upper)
    rows = []
    for done, threshold in enumerate((upper + lower) / 2, start=1):
        cells = cell_sets.at(threshold)
        n_removed = cells.n_removed
        rows.append(
            {
                "threshold": threshold,
                "cells": int(cells.kept.sum()),
                "clusters": cells.decisions.n_clusters,
                "overruled": cells.decisions.clusters_overruled,
                "bridges": cells.n_bridges,
                "removed": n_removed,
                "filled": cells.n_filled,
                **cells.predicted._asdict(),
            }
        )
        if progress is not None:
            progress(done, len(upper))
    predicted = pd.DataFrame({"upper": upper, "lower": lower, "width": upper - lower})
    predicted = pd.concat([predicted, pd.DataFrame(rows)], axis=1)
    for name in BETTI:
        predicted[f"raw_{name}"] = raw[name].to_numpy()[of_raw]
    raw_numbers = predicted[[f"raw_{name}" for name in BETTI]].to_numpy()
    predicted["raw_agrees"] = (raw_numbers == predicted[BETTI].to_numpy()).all(axis=1)
    return predicted


def merge_intervals(predicted: pd.DataFrame, is_wanted: pd.Series | None = None) -> pd.DataFrame:
    """Return the runs of plateaus whose meshes have the same Betti numbers.

    Parameters
    ----------
    predicted
        See `predict_plateaus`.
    is_wanted
        Plateaus to use, all of those that keep a cell by default; others end a run.

    Returns
    -------
    intervals
        One row per run, from high to low: `upper`, `lower`, `width`; `unexamined`, the width
        within it that no examined plateau covers; `threshold`, the middle of the plateau nearest
        to the middle of the run; `margin`, its distance to the ends of the run; `cell_margin`,
        its distance to where any cell or sub-cell changes; and the columns of that plateau.

    Examples
    --------
    >>> predicted = pd.DataFrame({
    ...     "upper": [1.0, 0.5, 0.25], "lower": [0.5, 0.25, 0.0], "width": [0.5, 0.25, 0.25],
    ...     "threshold": [0.75, 0.375, 0.125], "cells": [3, 4, 5],
    ...     "betti_0": [1, 1, 2], "betti_1": [0, 0, 0], "betti_2": [0, 0, 0]})
    >>> merge_intervals(predicted)[["upper", "lower", "threshold", "margin"]].values.tolist()
    [[1.0, 0.25, 0.75, 0.25], [0.25, 0.0, 0.125, 0.125]]
    """
    use = (predicted["cells"] > 0).to_numpy()
    if is_wanted is not None:
        use = use & is_wanted.to_numpy()
    betti = predicted[BETTI].to_numpy()
    begins = np.ones(len(predicted), dtype=bool)
    begins[1:] = (betti[1:] != betti[:-1]).any(axis=1) | (use[1:] != use[:-1])
    run = np.cumsum(begins) - 1
    rows = []
    for _, members in predicted[use].groupby(run[use], sort=True):
        upper, lower = float(members["upper"].iloc[0]), float(members["lower"].iloc[-1])
        nearest = int((members["threshold"] - (upper + lower) / 2).abs().to_numpy().argmin())
        plateau: dict[str, Any] = {str(k): v for k, v in members.iloc[nearest].items()}
        threshold = plateau.pop("threshold")
        extent = {
            "threshold": threshold,
            "upper": upper,
            "lower": lower,
            "width": upper - lower,
            "margin": min(threshold - lower, upper - threshold),
            "cell_margin": plateau.pop("width") / 2,
            "unexamined": max(0.0, upper - lower - float(members["width"].sum())),
            "plateaus": len(members),
        }
        rows.append({**{k: v for k, v in plateau.items() if k not in extent}, **extent})
    columns = ["threshold", "upper", "lower", "width", "margin", "cell_margin", "unexamined"]
    columns += ["plateaus", *(c for c in predicted.columns if c not in (*columns, "plateaus"))]
    return pd.DataFrame(rows, columns=columns)


def list_reachable(predicted: pd.DataFrame) -> str:
    """Return the reachable Betti numbers as lines of text, one per interval, from high to low."""
    return "\n".join(
        f"    {row.lower:.4f} < t <= {row.upper:.4f}: betti_0 = {row.betti_0}, "
        f"betti_1 = {row.betti_1}, betti_2 = {row.betti_2}"
        for row in merge_intervals(predicted).itertuples()
    )


def _choose(upper: FloatArray, lower: FloatArray, n_cells: int) -> IntArray:
    """Return the plateaus to look at: all, or the widest half and an even spread."""
    limit = int(np.clip(_CELLS_TO_LOOK_AT // n_cells, MIN_PLATEAUS, MAX_PLATEAUS))
    if len(upper) <= limit:
        return np.arange(len(upper), dtype=np.int64)
    widest = np.argsort(lower - upper, kind="stable")[: limit // 2]
    thresholds = (np.arange(limit - len(widest)) + 0.5) / (limit - len(widest))
    # Plateaus go from high to low: the first whose lower end is below the threshold holds it.
    spread = np.searchsorted(-lower, -thresholds, side="right")
    return np.unique(np.concatenate([widest, spread])).astype(np.int64)


def _row_of(raw: pd.DataFrame, thresholds: FloatArray) -> IntArray:
    """Return the raw plateau that holds each threshold."""
    return np.searchsorted(-raw["lower"].to_numpy(), -thresholds, side="right").astype(np.int64)
