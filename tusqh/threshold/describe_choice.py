"""The selection that describes a choice."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import pandas as pd

from tusqh.antialias.cells import CellSet
from tusqh.antialias.resolve import Resolved
from tusqh.settings.goal import Target
from tusqh.settings.policy import Policy
from tusqh.threshold.candidates import rank_candidates
from tusqh.threshold.goals import matches
from tusqh.threshold.plateaus import Plateaus
from tusqh.threshold.selection import Interval, Selection
from tusqh.topology.betti_numbers import BettiNumbers


def describe_choice(
    plateaus: Plateaus,
    row: Mapping[str, float] | pd.Series,
    cells: CellSet,
    *,
    wanted: str,
    reason: str,
    find_interval: Callable[[], Interval] | None = None,
    policy: Policy | None = None,
    resolved: Resolved | None = None,
) -> Selection:
    """Return the selection of a candidate.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold.
    row
        The candidate: `threshold`, `cell_margin`, `lower`, `upper`, `margin`, `unexamined`.
    cells
        The cells of the candidate.
    wanted, reason
        The request, and why this candidate was chosen, in words.
    find_interval
        Computes `lower`, `upper`, `margin` and `unexamined` for a candidate without them.
    policy
        The settings for pinches and small features, if they differ from those of the plateaus.
    resolved
        The mesh, if one was made.
    """
    threshold = float(row["threshold"])
    return Selection(
        threshold=threshold,
        cell_margin=float(row["cell_margin"]),
        wanted=wanted,
        raw=plateaus.cell_sets.topology.betti_at(threshold),
        predicted=cells.predicted,
        reason=reason,
        policy=policy or plateaus.cell_sets.policy,
        find_interval=find_interval or partial(_interval_of, row),
        find_without_features=(
            partial(_list_without_features, plateaus, cells.predicted)
            if len(cells.features)
            else str
        ),
        cells=cells,
        resolved=resolved,
    )


def _interval_of(row: Mapping[str, float] | pd.Series) -> Interval:
    return Interval(**{key: float(row[key]) for key in Interval._fields})


def _list_without_features(plateaus: Plateaus, betti: BettiNumbers) -> str:
    """Return the intervals with these Betti numbers in which nothing is removed or filled."""
    predicted = plateaus.table
    is_untouched = predicted["removed"] + predicted["filled"] == 0
    is_wanted = is_untouched & matches(predicted, Target(**betti._asdict()))
    return "; ".join(
        f"{interval.lower:.4g} < t <= {interval.upper:.4g}"
        for interval in rank_candidates(predicted, is_wanted).head(3).itertuples()
    )
