"""Mesh a surface in slabs: the same mesh as in one piece, with less memory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from tusqh.atomic import write_text
from tusqh.geometry.canonical import write_geometry
from tusqh.geometry.soup import Soup
from tusqh.hashing import canonical_json, hash_value
from tusqh.meshes.measure_pieces import PiecesMeasurement, measure_pieces
from tusqh.meshes.piece_files import read_pieces
from tusqh.pipeline.describe_reading import describe_reading
from tusqh.pipeline.report import Report
from tusqh.pipeline.slabs.cells import SlabCells
from tusqh.pipeline.slabs.elements import SlabMesh
from tusqh.pipeline.slabs.folder import WorkFolder
from tusqh.pipeline.slabs.found import Found
from tusqh.pipeline.slabs.fractions import SlabFractions
from tusqh.pipeline.slabs.limits import require_possible
from tusqh.pipeline.slabs.sample import Sampled, original_of, sample_in_slabs
from tusqh.pipeline.slabs.write import require_slab_format, write_one, write_pieces
from tusqh.pipeline.unused_settings import read_with
from tusqh.progress import Progress, log_progress
from tusqh.sampling.orient import orient
from tusqh.settings.model import Settings


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
    original = original_of(geometry, settings)
    written = list(outputs) if results is None else [results / "mesh.pvtu", *outputs]
    folder = WorkFolder(written[0].parent / f"{written[0].stem}_slabs")
    folder.require_own()
    sampled = sample_in_slabs(original, settings, folder, name=name, progress=progress)
    cells, mesh = _make(sampled, folder, name, progress)
    measured = _write(written, mesh, sampled.fractions, name, progress)
    oriented = orient(geometry, settings.sampling.orientation)
    found = Found(original, sampled, cells, measured, name)
    report = found.report(describe_reading(reading), (*reading.remarks, *oriented.remarks))
    if results is not None:
        write_geometry(results / "geometry.vtp", geometry)
        write_text(results / "reading.json", canonical_json(report.reading))
        found.certify(results, report)
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


__all__ = ["SlabResult", "mesh_in_slabs"]
