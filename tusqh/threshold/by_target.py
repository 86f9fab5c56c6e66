"""The threshold whose mesh has wanted Betti numbers."""

from __future__ import annotations

import pandas as pd

from tusqh.settings.goal import Target
from tusqh.threshold.candidates import rank_candidates
from tusqh.threshold.describe_choice import describe_choice
from tusqh.threshold.errors import unreachable_target
from tusqh.threshold.first_verified import find_first_verified
from tusqh.threshold.goals import matches
from tusqh.threshold.plateaus import Plateaus
from tusqh.threshold.selection import Selection


def choose_by_target(
    plateaus: Plateaus, target: Target, *, name: str
) -> tuple[Selection, pd.DataFrame]:
    """Return the first interval with wanted Betti numbers whose mesh measures so.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold.
    target
        The wanted Betti numbers.
    name
        The model, for messages.

    Returns
    -------
    selection, candidates
        See `tusqh.threshold.choose.choose_threshold`.

    Raises
    ------
    TopologyError
        No threshold has them; the message lists what is reachable.
    """
    predicted = plateaus.table
    candidates = rank_candidates(predicted, pd.Series(matches(predicted, target)))
    found = find_first_verified(plateaus.cell_sets, candidates, name=name)
    if found is None:
        raise unreachable_target(predicted, target, name)
    row, trial = found
    selection = describe_choice(
        plateaus,
        row,
        trial.cells,
        wanted=str(target),
        reason=f"number {row['rank']} of {len(candidates)} intervals with {target}: "
        f"{row['lower']:.4g} < t <= {row['upper']:.4g}",
        resolved=trial.resolved,
    )
    return selection, candidates
