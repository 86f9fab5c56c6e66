"""Choose a threshold.

A user gives the threshold, or asks for Betti numbers, for persistent features, for the volume of
the geometry, or for that volume among the thresholds that meet one of the other requests
(algorithm 3).
"""

from __future__ import annotations

import pandas as pd

from tusqh.local_topology.base import find_base
from tusqh.settings.goal import Goal
from tusqh.threshold.by_features import choose_by_features
from tusqh.threshold.by_persistence import choose_by_persistence
from tusqh.threshold.by_target import choose_by_target
from tusqh.threshold.by_threshold import take_threshold
from tusqh.threshold.by_volume import choose_by_volume
from tusqh.threshold.errors import unknown_volume
from tusqh.threshold.plateaus import Plateaus
from tusqh.threshold.selection import Selection


def choose_threshold(
    plateaus: Plateaus, goal: Goal | None = None, *, name: str = "model"
) -> tuple[Selection, pd.DataFrame]:
    """Return the threshold that reaches the goal, and all candidates.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold, with cells and topology.
    goal
        The goal; by default a threshold of 1/2.
    name
        The model, for messages.

    Returns
    -------
    selection
        The choice.
    candidates
        Intervals in the order in which they are tried, with width, margin and `status`.

    Raises
    ------
    TopologyError
        No threshold reaches the goal; the message lists the reachable Betti numbers.
    """
    goal = goal or Goal()
    if goal.features:
        return choose_by_features(
            plateaus,
            goal.features,
            _base_of_features(plateaus, goal, name),
            target=goal.target,
            name=name,
        )
    matches_volume = goal.volume is not None
    if goal.target is not None:
        return choose_by_target(
            plateaus,
            goal.target,
            matches_volume=matches_volume,
            base=_find_base(plateaus, goal, name),
            name=name,
        )
    if goal.persistence is not None:
        return choose_by_persistence(
            plateaus,
            goal.persistence,
            matches_volume=matches_volume,
            base=_find_base(plateaus, goal, name),
            name=name,
        )
    if matches_volume:
        return choose_by_volume(plateaus, name=name)
    assert goal.threshold is not None  # `Goal` fills it in.
    return take_threshold(plateaus, goal.threshold, name=name)


def _base_of_features(plateaus: Plateaus, goal: Goal, name: str) -> float:
    """Return the threshold whose cells are kept beside the wished features."""
    if goal.threshold is not None and goal.base == Goal().base:
        return goal.threshold
    return _resolve_base(plateaus, goal, name)


def _find_base(plateaus: Plateaus, goal: Goal, name: str) -> float | None:
    """Return the threshold of the base, None for the global scope."""
    if not goal.is_local:
        return None
    return _resolve_base(plateaus, goal, name)


def _resolve_base(plateaus: Plateaus, goal: Goal, name: str) -> float:
    """Return the threshold of the base."""
    volume = plateaus.reference.volume
    if goal.base == "match" and volume <= 0:
        raise unknown_volume(name, wish="`base: match`")
    return find_base(plateaus.cell_sets.fractions, goal.base, volume=volume)
