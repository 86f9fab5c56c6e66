"""Stage 4: the threshold that gives what was asked for."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.progress import Progress, log_progress
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.goal import Goal
from tusqh.settings.policy import Policy
from tusqh.threshold.plateaus import predict_plateaus
from tusqh.threshold.select import Selection, choose_threshold


@dataclass(frozen=True)
class Choice:
    """A threshold and everything it was chosen from.

    Parameters
    ----------
    selection
        The threshold, why, and how robust the choice is.
    topologies
        The Betti numbers that meshes will have, by plateau of the threshold, see
        `tusqh.threshold.plateaus.predict_plateaus`.
    candidates
        The intervals that give what was asked for, ranked.
    """

    selection: Selection
    topologies: pd.DataFrame
    candidates: pd.DataFrame


def predict(
    fractions: VolumeFractions,
    curves: pd.DataFrame,
    *,
    policy: Policy | None = None,
    progress: Progress = log_progress,
) -> tuple[CellSets, pd.DataFrame]:
    """Return the cells of every threshold and the topology that their meshes will have.

    Parameters
    ----------
    fractions
        Volume fractions.
    curves
        Raw Betti numbers by plateau, of these fractions.
    policy
        What to do about pinches and small features; None: the defaults.
    progress
        Shows how many plateaus have been examined.

    Returns
    -------
    cell_sets
        The cells of every threshold.
    topologies
        Betti numbers of the mesh, by plateau of the threshold.
    """
    cell_sets = CellSets(fractions, policy or Policy())
    return cell_sets, predict_plateaus(cell_sets, curves, progress=progress("plateaus"))


def select(
    fractions: VolumeFractions,
    curves: pd.DataFrame,
    diagram: pd.DataFrame,
    *,
    policy: Policy | None = None,
    goal: Goal | None = None,
    name: str = "model",
    progress: Progress = log_progress,
) -> Choice:
    """Return the threshold that gives what was asked for, verified by meshing and measuring.

    Parameters
    ----------
    fractions
        Volume fractions.
    curves, diagram
        Their topology, see `tusqh.pipeline.persistence`.
    policy
        What to do about pinches and small features; None: the defaults.
    goal
        How the threshold is chosen; None: 1/2.
    name
        The model, for messages.
    progress
        Shows how many plateaus have been examined.

    Raises
    ------
    TopologyError
        Nothing gives what is wanted; the message lists what is reachable.
    """
    cell_sets, topologies = predict(fractions, curves, policy=policy, progress=progress)
    selection, candidates = choose_threshold(
        cell_sets, topologies, pairs=diagram, goal=goal, name=name
    )
    return Choice(selection, topologies, candidates)
