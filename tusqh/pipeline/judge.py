"""Stage 6: judge whether the mesh is suitable for analysis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import pandas as pd

from tusqh.antialias.scheme import PINCH_TEMPLATES, Scheme
from tusqh.extras import MissingExtraError
from tusqh.meshes.checks import Check
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.build import Built
from tusqh.quality.elements import element_metrics, summarise_metrics
from tusqh.quality.fit_checks import FITTED
from tusqh.quality.verdict import judge_alone, judge_mesh, overall, to_table
from tusqh.settings.quality import MOST_ELEMENTS, Quality
from tusqh.topology.betti_numbers import BettiNumbers

if TYPE_CHECKING:
    from tusqh.pipeline.fit import Fit


@dataclass(frozen=True)
class Judgement:
    """All checks of a mesh.

    Parameters
    ----------
    elements
        Summary of VTK's element metrics, with one row per metric; empty if VTK did not run.
    verdict
        One row per check, see `tusqh.quality.verdict.to_table`.
    """

    elements: pd.DataFrame
    verdict: pd.DataFrame

    @property
    def is_suitable(self) -> bool:
        """Whether no check fails; there may be warnings."""
        return not (self.verdict["holds"] == "no").any()

    @property
    def has_warnings(self) -> bool:
        """Whether the mesh is suitable with warnings only."""
        return self.is_suitable and bool((self.verdict["holds"] == "warning").any())

    def __str__(self) -> str:
        return overall(self.verdict)


def judge(
    mesh: VolumeMesh,
    predicted: BettiNumbers,
    *,
    comparison: Sequence[Check] = (),
    checks: Literal["all"] | None = None,
    scheme: Scheme = PINCH_TEMPLATES,
) -> Judgement:
    """Return all checks of a mesh, by our own counts, VTK, pymeshlab and MFEM.

    Parameters
    ----------
    mesh
        The mesh.
    predicted
        Betti numbers that it must have.
    comparison
        Further checks, against the geometry, see `tusqh.pipeline.build.Built.comparison`.
    checks
        Whether other programs check large meshes too, see `tusqh.settings.quality.Quality`.
    scheme
        How the mesh was made, which bounds the scaled Jacobians of its elements.
    """
    if checks != "all" and mesh.n_cells > MOST_ELEMENTS:
        skipped = f"{mesh.n_cells:,} elements; `--all-checks` runs them"
        verdict = to_table([*judge_alone(mesh, predicted, skipped, scheme=scheme), *comparison])
        return Judgement(summarise_metrics(pd.DataFrame()), verdict)
    try:
        metrics = element_metrics(mesh)
    except MissingExtraError:
        metrics = None
    verdict = to_table([*judge_mesh(mesh, predicted, metrics, scheme=scheme), *comparison])
    return Judgement(
        summarise_metrics(pd.DataFrame() if metrics is None else metrics, unit=mesh.unit), verdict
    )


def judge_built(built: Built, fitted: Fit | None, quality: Quality) -> Judgement:
    """Return all checks of a mesh that was built, and fitted where that was asked for.

    Parameters
    ----------
    built
        The staircase.
    fitted
        The fitted mesh; None: the staircase is judged.
    quality
        Which programs check it.
    """
    final = built if fitted is None else fitted
    return judge(
        final.mesh,
        built.selection.predicted,
        comparison=final.comparison,
        checks=quality.checks,
        scheme=PINCH_TEMPLATES if fitted is None else FITTED,
    )
