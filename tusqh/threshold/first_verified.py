"""Verify a choice: predict, mesh and measure each candidate until one agrees."""

from __future__ import annotations

import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.threshold.candidates import CHOSEN, DISAGREES, Trial, try_cells


def find_first_verified(
    cell_sets: CellSets, candidates: pd.DataFrame, *, name: str
) -> tuple[pd.Series, Trial] | None:
    """Return the first candidate whose mesh measures as predicted.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    candidates
        Intervals in the order in which they are tried; `status` receives each outcome.
    name
        The model, for messages.

    Returns
    -------
    row, trial
        The candidate and its mesh; None if every measurement disagrees.
    """
    for index, threshold in enumerate(candidates["threshold"].to_numpy()):
        trial = try_cells(cell_sets.at(threshold), cell_sets.fractions.grid, name=name)
        is_verified = trial.is_verified
        candidates.loc[index, "status"] = CHOSEN if is_verified else DISAGREES
        if is_verified:
            return candidates.iloc[index], trial
    return None
