"""Choose the threshold whose mesh has the target Betti numbers."""

from __future__ import annotations

import pandas as pd

from tusqh.local_topology.move import approach
from tusqh.settings.goal import Target
from tusqh.threshold.by_features import choose_by_features
from tusqh.threshold.by_volume import choose_by_volume
from tusqh.threshold.candidates import rank_candidates
from tusqh.threshold.describe_choice import describe_choice, describe_rank
from tusqh.threshold.errors import unreachable_target
from tusqh.threshold.first_verified import find_first_verified
from tusqh.threshold.goals import matches
from tusqh.threshold.plateaus import Plateaus
from tusqh.threshold.selection import Selection


def choose_by_target(
    plateaus: Plateaus,
    target: Target,
    *,
    matches_volume: bool = False,
    base: float | None = None,
    name: str,
) -> tuple[Selection, pd.DataFrame]:
    """Return the first interval with the target Betti numbers whose measured mesh confirms them.

    If there is none and a base is given, features of the base are opened, cut and filled instead,
    see `tusqh.threshold.by_features`.

    Within the interval the threshold is 1/2 or the one with the best volume, see
    `tusqh.threshold.within_interval.take_threshold_of`.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold.
    target
        The target Betti numbers.
    matches_volume
        Whether to choose, among all thresholds with these Betti numbers, the one whose mesh has the
        volume nearest to that of the geometry.
    base
        The threshold whose cells are kept except where the topology needs others, see
        `tusqh.local_topology.move`; None: the chosen threshold keeps its own cells.
    name
        The model, for messages.

    Returns
    -------
    selection, candidates
        See `tusqh.threshold.choose.choose_threshold`.

    Raises
    ------
    TopologyError
        No threshold gives them; the message lists the reachable Betti numbers.
    """
    predicted = plateaus.table
    is_wanted = matches(predicted, target)
    if not (is_wanted & (predicted["cells"] > 0)).any():
        if base is None or matches_volume:
            raise unreachable_target(predicted, target, name)
        return choose_by_features(plateaus, (), base, target=target, name=name)
    if matches_volume:
        return choose_by_volume(plateaus, is_wanted, also=str(target), base=base, name=name)
    candidates = rank_candidates(predicted, pd.Series(is_wanted), base=base)
    found = find_first_verified(approach(plateaus.cell_sets, base), candidates, name=name)
    if found is None:
        raise unreachable_target(predicted, target, name)
    row, trial = found
    selection = describe_choice(
        plateaus,
        row,
        trial.cells,
        wanted=str(target),
        reason=describe_rank(row, candidates, str(target), base),
        resolved=trial.resolved,
    )
    return selection, candidates
