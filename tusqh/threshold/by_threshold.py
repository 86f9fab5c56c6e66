"""A threshold that is given, and how far it can move."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.threshold.candidates import rank_candidates
from tusqh.threshold.describe_choice import describe_choice
from tusqh.threshold.errors import nothing_kept, threshold_out_of_range
from tusqh.threshold.plateaus import BETTI, PREDICTED, Plateaus
from tusqh.threshold.selection import Interval, Selection
from tusqh.topology.betti_numbers import BettiNumbers


def take_threshold(
    plateaus: Plateaus, threshold: float, *, name: str
) -> tuple[Selection, pd.DataFrame]:
    """Return a given threshold; nothing is meshed, and its interval is found when needed.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold; those of the interval are examined when it is needed.
    threshold
        Volume fraction in (0, 1].
    name
        The model, for messages.

    Returns
    -------
    selection, candidates
        See `tusqh.threshold.choose.choose_threshold`; there are no candidates.

    Raises
    ------
    TopologyError
        The threshold is out of range or keeps no cell.
    """
    if not 0 < threshold <= 1:
        raise threshold_out_of_range(threshold, name)
    cell_sets = plateaus.cell_sets
    cells = cell_sets.at(threshold)
    if not cells.kept.any():
        raise nothing_kept(cell_sets, threshold, name)
    selection = describe_choice(
        plateaus,
        {
            "threshold": threshold,
            "cell_margin": _cell_margin(cell_sets, threshold),
        },
        cells,
        wanted=f"the threshold {threshold:g}",
        reason="given",
        find_interval=partial(_find_interval, plateaus, threshold, cells.predicted),
    )
    none = pd.DataFrame(columns=PREDICTED, dtype=float)
    return selection, rank_candidates(none, pd.Series(dtype=bool))


def _cell_margin(cell_sets: CellSets, threshold: float) -> float:
    """Return the distance to where any cell changes; to 0 if every fraction is 0 or above 1."""
    levels = cell_sets.levels if len(cell_sets.levels) else np.zeros(1)
    return float(np.abs(levels - threshold).min())


def _find_interval(plateaus: Plateaus, threshold: float, betti: BettiNumbers) -> Interval:
    """Return the interval in which a threshold can move with the same Betti numbers."""
    row = plateaus.find_interval(threshold)
    if row is None or tuple(row[BETTI]) != tuple(betti):
        row = _unexamined_plateau(plateaus.cell_sets, threshold)
    lower, upper = float(row["lower"]), float(row["upper"])
    return Interval(
        lower=lower,
        upper=upper,
        margin=min(threshold - lower, upper - threshold),
        unexamined=float(row["unexamined"]),
    )


def _unexamined_plateau(cell_sets: CellSets, threshold: float) -> pd.Series:
    """Return the extent of the plateau around a threshold that was not examined."""
    levels = np.concatenate([[1.0], cell_sets.levels, [0.0]])
    upper, lower = levels[levels >= threshold].min(), levels[levels < threshold].max()
    return pd.Series({"lower": lower, "upper": upper, "unexamined": 0.0})
