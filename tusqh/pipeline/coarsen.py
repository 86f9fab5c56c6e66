"""Stage 7: merge grid cells inside the mesh, and record what was merged."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np

from tusqh import __version__
from tusqh.atomic import write_text
from tusqh.coarsening import CoarseMesh, ConformingMesh, coarsen_conforming
from tusqh.coarsening import coarsen as coarsen_hanging
from tusqh.coarsening.checks import check_coarse, check_conforming, check_same_domain
from tusqh.coarsening.files import read_coarse, write_coarse
from tusqh.errors import MeshError
from tusqh.files import path_of
from tusqh.grid import BackgroundGrid
from tusqh.hashing import canonical_json, hash_file
from tusqh.meshes.checks import Check
from tusqh.meshes.export import read_vtu
from tusqh.meshes.volume_mesh import VolumeMesh

#: The files of the stage, by their names in `tusqh.files`.
WRITTEN = ("coarse", "coarse_mfem", "coarsening")


@dataclass(frozen=True)
class Coarsened:
    """A coarse mesh that has passed its checks.

    Parameters
    ----------
    coarse
        The mesh.
    """

    coarse: CoarseMesh | ConformingMesh

    @cached_property
    def facts(self) -> dict[str, Any]:
        """Numbers that describe the mesh."""
        coarse = self.coarse
        facts: dict[str, Any] = {
            "elements": coarse.mesh.n_cells,
            "uniform_elements": coarse.n_uniform,
            "elements_by_level": np.bincount(coarse.level).tolist(),
        }
        if isinstance(coarse, ConformingMesh):
            return facts | {"least_scaled_jacobian_inside": round(coarse.least_new, 6)}
        return facts | {"hanging_vertices": len(coarse.hanging)}

    def line(self) -> str:
        """Return the facts as a sentence."""
        facts = self.facts
        is_conforming = isinstance(self.coarse, ConformingMesh)
        largest = (3 if is_conforming else 2) ** (len(facts["elements_by_level"]) - 1)
        return (
            f"{facts['elements']:,} elements instead of {facts['uniform_elements']:,}, the largest "
            f"of {largest} cells along each axis, "
        ) + (
            "conforming, scaled Jacobian inside at least "
            f"{facts['least_scaled_jacobian_inside']:.3f}"
            if is_conforming
            else f"{facts['hanging_vertices']:,} hanging vertices"
        )

    def write(self, *, source: Path, coarse: Path, coarse_mfem: Path, coarsening: Path) -> None:
        """Write the coarse mesh as VTU and for MFEM, and the record that `tusqh check` recomputes.

        Parameters
        ----------
        source
            The existing file of the mesh from which it was made; the record names it.
        coarse, coarse_mfem, coarsening
            The files to write.
        """
        write_coarse(coarse, self.coarse)
        write_coarse(coarse_mfem, self.coarse)
        record = {
            "coarsening": 1,
            "model": self.coarse.mesh.name,
            "tusqh": __version__,
            "source": {"file": source.name, "sha256": hash_file(source)},
            "coarse": {"file": coarse.name, "sha256": hash_file(coarse)},
            **self.facts,
        }
        write_text(coarsening, canonical_json(record))


def coarsen(
    mesh: VolumeMesh, grid: BackgroundGrid, kind: Literal["interior", "conforming"]
) -> Coarsened:
    """Return the coarse mesh of a staircase or of a fitted mesh.

    Parameters
    ----------
    mesh
        The mesh.
    grid
        The grid of which it was made.
    kind
        ``"interior"``: with hanging vertices; ``"conforming"``: without.

    Raises
    ------
    MeshError
        The coarse mesh fails a check.
    """
    coarse: CoarseMesh | ConformingMesh
    if kind == "conforming":
        coarse = coarsen_conforming(mesh, grid)
        checks = check_conforming(coarse) + check_same_domain(coarse, mesh)
    else:
        coarse = coarsen_hanging(mesh, grid)
        checks = check_coarse(coarse)
    failed = [check for check in checks if not check.holds]
    if failed:
        raise MeshError(
            "; ".join(f"{check.name}: {check.found}" for check in failed),
            where=mesh.name,
            expected="a coarse mesh that passes its checks",
            remedy="this is a fault of tusqh: please report it; mesh without `coarsen`",
        )
    return Coarsened(coarse)


def recheck_coarse(path: Path, coarse: CoarseMesh | ConformingMesh) -> list[Check]:
    """Return the checks of a coarse mesh, of its record, and of the mesh from which it was made.

    Parameters
    ----------
    path
        The file of the coarse mesh.
    coarse
        That mesh, as read.

    Raises
    ------
    MeshError
        The record in its folder cannot be read.
    """
    if isinstance(coarse, ConformingMesh):
        checks = check_conforming(coarse)
    else:
        checks = check_coarse(coarse)
    record_file = path_of("coarsening", path.parent)
    if not record_file.is_file():
        return checks
    record = _load_record(record_file)
    if record["coarse"]["file"] != path.name:
        return checks
    checks.append(_digest("coarse_digest", path, record["coarse"]["sha256"]))
    source = path.parent / record["source"]["file"]
    if not source.is_file():
        return [
            *checks,
            Check(
                id="coarse_source",
                name="coarse mesh of the recorded mesh",
                found=f"not recomputed: {source.name} is missing from the folder",
                required="the same elements",
                holds=None,
            ),
        ]
    before = read_vtu(source)
    again: CoarseMesh | ConformingMesh
    if isinstance(coarse, ConformingMesh):
        again = coarsen_conforming(before, coarse.grid)
        checks += check_same_domain(coarse, before)
    else:
        again = coarsen_hanging(before, coarse.grid)
    is_same = again.mesh.n_cells == coarse.mesh.n_cells and all(
        np.array_equal(a, b)
        for a, b in (
            (again.level, coarse.level),
            (again.mesh.cells, coarse.mesh.cells),
            (again.mesh.points, coarse.mesh.points),
        )
    )
    return [
        *checks,
        _digest("coarse_source_digest", source, record["source"]["sha256"]),
        Check(
            id="coarse_source",
            name="coarse mesh of the recorded mesh",
            found="the same elements" if is_same else "other elements",
            required="the same elements",
            holds=is_same,
        ),
    ]


def find_coarse(path: Path) -> tuple[CoarseMesh | ConformingMesh, Path | None] | None:
    """Return the coarse mesh in a file and the mesh from which it was made; None if it holds none.

    Parameters
    ----------
    path
        A VTU file.

    Returns
    -------
    coarse, source
        The mesh; the file that its record names, None without a record.

    Raises
    ------
    MeshError
        The file cannot be read or is not valid.
    """
    coarse = read_coarse(path)
    if coarse is None:
        return None
    record = path_of("coarsening", path.parent)
    if not record.is_file():
        return coarse, None
    return coarse, path.parent / _load_record(record)["source"]["file"]


def _digest(key: str, path: Path, recorded: str) -> Check:
    found = hash_file(path)
    return Check(
        id=key,
        name=f"SHA-256 of {path.name}",
        found=found[:12],
        required=recorded[:12],
        holds=found == recorded,
    )


def _load_record(path: Path) -> dict[str, Any]:
    try:
        stored = dict(json.loads(path.read_text("utf-8")))
    except (OSError, ValueError) as reason:
        raise _wrong(path, str(reason)) from reason
    missing = {"coarse", "source"} - set(stored)
    if missing:
        raise _wrong(path, f"lacks {', '.join(sorted(missing))}")
    return stored


def _wrong(path: Path, found: str) -> MeshError:
    return MeshError(
        f"is not a valid record of a coarse mesh: {found}",
        where=str(path),
        expected="a file that the step `coarsen` wrote, unchanged",
        remedy="make the mesh again, or check the mesh in another folder",
    )
