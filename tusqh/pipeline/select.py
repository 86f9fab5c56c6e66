"""Stage 4: the threshold that gives what was asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.progress import Progress, log_progress
from tusqh.sampling.fractions import VolumeFractions
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
    policy: Mapping[str, Any] | None = None,
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
        Settings for `tusqh.settings.policy.Policy.from_dict`.
    progress
        Shows how many plateaus have been looked at.
    """
    cell_sets = CellSets(fractions, Policy.from_dict(policy or {}))
    return cell_sets, predict_plateaus(cell_sets, curves, progress=progress("plateaus"))


def select(
    fractions: VolumeFractions,
    curves: pd.DataFrame,
    diagram: pd.DataFrame,
    *,
    policy: Mapping[str, Any] | None = None,
    wanted: Mapping[str, Any] | None = None,
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
        Settings for `tusqh.settings.policy.Policy.from_dict`.
    wanted
        One of `threshold`, `target`, `persistence` and `volume`; a threshold of 1/2 by default.
    name
        The model, for messages.
    progress
        Shows how many plateaus have been looked at.

    Raises
    ------
    TopologyError
        Nothing gives what is wanted; the message lists what is reachable.
    """
    cell_sets, topologies = predict(fractions, curves, policy=policy, progress=progress)
    selection, candidates = choose_threshold(
        cell_sets, topologies, pairs=diagram, name=name, **(wanted or {})
    )
    return Choice(selection, topologies, candidates)
