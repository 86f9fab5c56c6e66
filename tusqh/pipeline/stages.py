"""Run all stages for typed settings, from a geometry to a judged mesh."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from tusqh.geometry.image import Image
from tusqh.geometry.outline import Outline
from tusqh.geometry.remark import Remark
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.build import Built, build, require_volume
from tusqh.pipeline.coarsen import Coarsened
from tusqh.pipeline.coarsen import coarsen as coarsen_built
from tusqh.pipeline.describe_reading import describe_reading
from tusqh.pipeline.judge import judge_built
from tusqh.pipeline.original import Original
from tusqh.pipeline.persistence import find_persistence
from tusqh.pipeline.result import Result
from tusqh.pipeline.select import select
from tusqh.pipeline.unused_settings import read_with
from tusqh.progress import Progress, log_progress
from tusqh.readers.reading import Reading
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.orient import orient
from tusqh.settings.model import Settings

if TYPE_CHECKING:
    from tusqh.pipeline.fit import Fit


def run_stages(
    source: Any,
    settings: Settings,
    *,
    name: str | None = None,
    progress: Progress = log_progress,
) -> Result:
    """Return the mesh of a geometry for typed settings, as `tusqh.mesh` does.

    Parameters
    ----------
    source
        The geometry, see `tusqh.pipeline.ingest.ingest`.
    settings
        How it is meshed.
    name
        Name of the model in files and messages; None: the name of the file.
    progress
        Shows the progress of long steps.
    """
    if name is None:
        name = Path(source).stem if isinstance(source, (str, Path)) else "model"
    progress("reading")
    reading = read_with(source, settings, name=name)
    original = Original(
        reading.geometry,
        settings.grid,
        settings.sampling,
        settings.window,
        settings.quality,
        settings.goal.threshold,
    )
    fractions, reference = original.sample_with_reference(progress)
    progress("persistence")
    found = find_persistence(fractions, name=name)
    choice = select(
        fractions,
        found.topology,
        policy=settings.policy,
        goal=settings.goal,
        reference=reference,
        name=name,
        progress=progress,
    )
    progress("mesh")
    built = build(fractions, choice.selection, name=name, original=original, reference=reference)
    if settings.goal.volume is not None:
        require_volume(built)
    fitted = _fit(built, original, settings, progress)
    coarse = _coarsen(built.mesh if fitted is None else fitted.mesh, fractions, settings, progress)
    progress("quality")
    return Result(
        reading.geometry,
        fractions,
        found,
        choice,
        built,
        judge_built(built, fitted, settings.quality),
        settings,
        describe_reading(reading),
        _remarks(reading, settings, built),
        fitted,
        coarse,
    )


def _fit(built: Built, original: Original, settings: Settings, progress: Progress) -> Fit | None:
    """Return the fitted mesh if the settings ask for it."""
    if not settings.fitting.fit:
        return None
    from tusqh.pipeline.fit import fit as fit_built

    progress("fit")
    return fit_built(built.mesh, built.selection, built.fractions, original, built.facts)


def _coarsen(
    mesh: VolumeMesh, fractions: VolumeFractions, settings: Settings, progress: Progress
) -> Coarsened | None:
    """Return the coarse mesh if the settings ask for it."""
    if settings.coarsening.coarsen is None:
        return None
    progress("coarsen")
    return coarsen_built(mesh, fractions.grid, settings.coarsening.coarsen)


def _remarks(reading: Reading, settings: Settings, built: Built) -> tuple[Remark, ...]:
    """Return the remarks on what reading, orienting and meshing left out, changed or noted."""
    geometry, remarks = reading.geometry, reading.remarks
    if not isinstance(geometry, Image):
        remarks += orient(geometry, settings.sampling.orientation).remarks
    if isinstance(geometry, Outline):
        from tusqh.geometry.small_pieces import remarks_on_small_polygons

        is_outside = settings.sampling.domain == "outside"
        cells = built.resolved.cells
        remarks += remarks_on_small_polygons(
            geometry, built.fractions.grid, cells.kept, is_outside=is_outside
        )
    return remarks
