"""Mesh a surface in slabs: the same mesh as in one piece, with less memory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from tusqh.antialias.resolve import Resolved, describe_mesh
from tusqh.atomic import write_text
from tusqh.certificate import FILE_NAME, certify
from tusqh.geometry.canonical import write_geometry
from tusqh.geometry.soup import Soup
from tusqh.hashing import canonical_json, hash_value
from tusqh.meshes.checks import Check
from tusqh.meshes.measure_pieces import PiecesMeasurement, measure_pieces
from tusqh.meshes.piece_files import read_pieces
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.describe_reading import describe_reading
from tusqh.pipeline.original import Original, to_warnings
from tusqh.pipeline.report import Report
from tusqh.pipeline.slabs.cells import SlabCells
from tusqh.pipeline.slabs.certificate import digests, write_fractions
from tusqh.pipeline.slabs.elements import SlabMesh
from tusqh.pipeline.slabs.folder import WorkFolder
from tusqh.pipeline.slabs.fractions import SlabFractions
from tusqh.pipeline.slabs.limits import require_possible
from tusqh.pipeline.slabs.sample import Sampled, sample_in_slabs
from tusqh.pipeline.slabs.write import require_slab_format, write_one, write_pieces
from tusqh.pipeline.unused_settings import read_with
from tusqh.progress import Progress, log_progress
from tusqh.quality.elements import summarise_metrics
from tusqh.quality.verdict import judge_alone, to_table
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.orient import orient
from tusqh.settings.model import Settings
from tusqh.tables import write_csv
from tusqh.threshold.selection import Interval, Selection


@dataclass(frozen=True)
class PiecedMesh:
    """A mesh in pieces, in the form in which checks and tables take a mesh.

    Parameters
    ----------
    name
        The model.
    measurement
        The measurement of the pieces.
    """

    name: str
    measurement: PiecesMeasurement

    @property
    def dim(self) -> int:
        """Dimension of the mesh."""
        return 3

    @property
    def n_cells(self) -> int:
        """Number of elements."""
        return self.measurement.n_cells

    @property
    def n_points(self) -> int:
        """Number of points."""
        return self.measurement.n_points

    @property
    def kind(self) -> NDArray[np.int64]:
        """The kinds of element that occur."""
        return np.array(self.measurement.kinds, dtype=np.int64)

    def as_mesh(self) -> VolumeMesh:
        """Return this object under the type of a mesh; it has no points and no elements."""
        return cast("VolumeMesh", self)


@dataclass(frozen=True)
class SlabResult:
    """A mesh in slabs, which is on disk.

    Parameters
    ----------
    paths
        The files of the mesh.
    measurement
        Its measurement.
    report
        The request, prediction, measurement and verdict.
    settings
        How it was made.
    """

    paths: tuple[Path, ...]
    measurement: PiecesMeasurement
    report: Report
    settings: Settings


def mesh_in_slabs(
    source: Any,
    settings: Settings,
    outputs: Sequence[Path],
    *,
    results: Path | None = None,
    name: str | None = None,
    progress: Progress = log_progress,
) -> SlabResult:
    """Write the mesh of a surface, made in slabs.

    The slabs that are finished are kept in a folder until the mesh is complete, so that the same
    call goes on where it was interrupted.

    Parameters
    ----------
    source
        The geometry, see `tusqh.pipeline.ingest.ingest`.
    settings
        How it is meshed.
    outputs
        Files to write: pieces (``.pvtu``) or one file (``.vtu``).
    results
        Folder for the mesh in pieces, its fractions, certificate and verdict; None: none.
    name
        Name of the model in files and messages; None: the name of the file.
    progress
        Shows the progress of long steps.

    Returns
    -------
    result
        Where the mesh is, its measurement and its report.

    Raises
    ------
    ConfigError
        A setting is not available in slabs.
    SamplingError
        The slabs do not fit into memory, or nothing is inside.
    MeshError
        An output has another format.
    """
    if name is None:
        name = Path(source).stem if isinstance(source, (str, Path)) else "model"
    for path in outputs:
        require_slab_format(path)
    progress("reading")
    reading = read_with(source, settings, name=name)
    require_possible(settings, reading.geometry, name)
    geometry = cast("Soup", reading.geometry)
    original = Original(
        geometry,
        settings.grid,
        settings.sampling,
        settings.window,
        settings.quality,
        settings.goal.threshold,
    )
    written = list(outputs) if results is None else [results / "mesh.pvtu", *outputs]
    folder = WorkFolder(written[0].parent / f"{written[0].stem}_slabs")
    folder.require_own()
    sampled = sample_in_slabs(original, settings, folder, name=name, progress=progress)
    cells, mesh = _make(sampled, folder, name, progress)
    measured = _write(written, mesh, sampled.fractions, name, progress)
    oriented = orient(geometry, settings.sampling.orientation)
    found = _Found(original, sampled, cells, measured, name)
    report = found.report(describe_reading(reading), (*reading.remarks, *oriented.remarks))
    if results is not None:
        found.save(results, report)
    folder.remove()
    return SlabResult(tuple(written), measured, report, settings)


def _make(
    sampled: Sampled, folder: WorkFolder, name: str, progress: Progress
) -> tuple[SlabCells, SlabMesh]:
    """Return the cells and the mesh, whose elements are on disk."""
    progress("contacts")
    fractions = sampled.fractions
    cells = SlabCells.of(sampled.survey, name)
    key = {
        "fractions": fractions.digest,
        "threshold": cells.threshold,
        "slabs": [tuple(slab) for slab in fractions.slabs],
    }
    digest = hash_value(key)
    folder.keep([*sampled.digests, digest])
    mesh = SlabMesh(fractions.grid, fractions.slabs, lambda: cells.decision, folder, digest)
    mesh.make(progress("mesh"))
    cells.forget_decision()
    return cells, mesh


def _write(
    written: Sequence[Path],
    mesh: SlabMesh,
    fractions: SlabFractions,
    name: str,
    progress: Progress,
) -> PiecesMeasurement:
    """Write the mesh, and return its measurement, of the pieces as written if there are some."""
    for path in written:
        report = progress("writing")
        if path.suffix == ".pvtu":
            write_pieces(path, mesh, fractions, report)
        else:
            write_one(path, mesh, fractions)
    progress("checks")
    in_pieces = [path for path in written if path.suffix == ".pvtu"]
    pieces = read_pieces(in_pieces[0]) if in_pieces else mesh.pieces()
    return measure_pieces(pieces, name=name)


@dataclass(frozen=True)
class _Found:
    """Everything that is known about a finished mesh in slabs."""

    original: Original
    sampled: Sampled
    cells: SlabCells
    measured: PiecesMeasurement
    name: str

    @property
    def resolved(self) -> Resolved:
        """The mesh with its cells."""
        return Resolved(PiecedMesh(self.name, self.measured).as_mesh(), self.cells)

    def selection(self) -> Selection:
        """Return the threshold; it is examined only where the cells stay the same."""
        cells, survey = self.cells, self.sampled.survey
        lower, upper = survey.lower * RESOLUTION, survey.upper * RESOLUTION
        margin = min(cells.threshold - lower, upper - cells.threshold)
        return Selection(
            threshold=cells.threshold,
            cells_lower=lower,
            cells_upper=upper,
            wanted=f"the threshold {cells.threshold:g}",
            raw=cells.raw,
            predicted=cells.predicted,
            reason="given; in slabs only thresholds with the same cells are examined",
            policy=self.sampled.policy,
            find_interval=lambda: Interval(lower, upper, max(margin, 0.0), 0.0),
            cells=cells,
        )

    def comparison(self) -> list[Check]:
        """Return the checks of the mesh against the geometry."""
        return self.original.compare(self.resolved, self.sampled.survey, self.sampled.reference)

    def report(self, reading: dict[str, Any], remarks: tuple[Any, ...]) -> Report:
        """Return the report."""
        comparison, selection = self.comparison(), self.selection()
        mesh = PiecedMesh(self.name, self.measured).as_mesh()
        skipped = "a mesh in slabs; other programs need it in one piece"
        verdict = to_table([*judge_alone(mesh, selection.predicted, skipped), *comparison])
        facts = {
            "threshold": selection.threshold,
            "margin": selection.margin,
            **describe_mesh(self.resolved, self.sampled.survey),
            "slabs": len(self.sampled.fractions.slabs),
            "reference_volume": self.sampled.reference.volume,
            "reference_source": self.sampled.reference.source,
            "comparison": [asdict(check) for check in comparison],
        }
        if self.sampled.placement is not None:
            facts["placement"] = self.sampled.placement.to_dict()
        nothing = summarise_metrics(pd.DataFrame())
        return Report(self.name, selection, facts, nothing, verdict, reading, remarks)

    def save(self, folder: Path, report: Report) -> None:
        """Write the certificate with everything that it needs, and the tables."""
        write_geometry(folder / "geometry.vtp", self.original.geometry)
        named = write_fractions(folder, self.sampled.fractions)
        files = digests(folder / "mesh.pvtu", named)
        claim = certify(report.selection, self.cells, self.measured, files, name=self.name)
        if self.sampled.placement is not None:
            claim["placement"] = self.sampled.placement.to_dict()
        claim["settings"] = self.original.to_dict()
        claim["warnings"] = to_warnings(self.comparison())
        write_text(folder / FILE_NAME, canonical_json(claim))
        write_text(folder / "facts.json", canonical_json(report.facts))
        write_text(folder / "reading.json", canonical_json(report.reading))
        write_csv(folder / "verdict.csv", report.verdict)


__all__ = ["PiecedMesh", "SlabResult", "mesh_in_slabs"]
