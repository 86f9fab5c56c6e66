"""The choice of a threshold.

A user fixes the threshold, or asks for Betti numbers, for features that live long, or for the
volume of the geometry (algorithm 3).
"""

from __future__ import annotations

import pandas as pd

from tusqh.settings.goal import Goal
from tusqh.threshold.by_persistence import choose_by_persistence
from tusqh.threshold.by_target import choose_by_target
from tusqh.threshold.by_threshold import take_threshold
from tusqh.threshold.by_volume import choose_by_volume
from tusqh.threshold.plateaus import Plateaus
from tusqh.threshold.selection import Selection


def choose_threshold(
    plateaus: Plateaus, goal: Goal | None = None, *, name: str = "model"
) -> tuple[Selection, pd.DataFrame]:
    """Return the threshold that gives what was asked for, and all candidates.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold, with cells and topology.
    goal
        What was asked for; a threshold of 1/2 by default.
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
        Nothing gives what is wanted; the message lists what is reachable.
    """
    goal = goal or Goal()
    if goal.target is not None:
        return choose_by_target(plateaus, goal.target, name=name)
    if goal.persistence is not None:
        return choose_by_persistence(plateaus, goal.persistence, name=name)
    if goal.volume is not None:
        return choose_by_volume(plateaus, name=name)
    assert goal.threshold is not None  # `Goal` fills it in.
    return take_threshold(plateaus, goal.threshold, name=name)
