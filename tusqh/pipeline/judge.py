"""Stage 6: whether the mesh is fit for analysis."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from tusqh.extras import MissingExtraError
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.quality.elements import element_metrics, summarise_metrics
from tusqh.quality.verdict import judge_mesh, overall, to_table
from tusqh.topology.betti_numbers import BettiNumbers


@dataclass(frozen=True)
class Judgement:
    """Every check of a mesh.

    Parameters
    ----------
    elements
        Element metrics, summarised: one row per metric; empty where VTK is not installed.
    verdict
        One row per check: `name`, `found`, `required`, `holds` (yes, no or not run).
    """

    elements: pd.DataFrame
    verdict: pd.DataFrame

    @property
    def is_suitable(self) -> bool:
        """Whether no check fails."""
        return not (self.verdict["holds"] == "no").any()

    def __str__(self) -> str:
        return overall(self.verdict)


def judge(mesh: VolumeMesh, predicted: BettiNumbers) -> Judgement:
    """Return every check of a mesh, by our own count, VTK, pymeshlab and MFEM.

    Parameters
    ----------
    mesh
        The mesh.
    predicted
        Betti numbers it must have.
    """
    try:
        metrics = element_metrics(mesh)
    except MissingExtraError:
        metrics = None
    verdict = to_table(judge_mesh(mesh, predicted, metrics))
    return Judgement(summarise_metrics(pd.DataFrame() if metrics is None else metrics), verdict)
