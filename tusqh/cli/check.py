"""`tusqh check`: say whether a mesh is fit for analysis, and as certified."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, NoReturn

import typer

from tusqh.cli.show import make_console, show
from tusqh.errors import ConfigError

if TYPE_CHECKING:
    import pandas as pd

    from tusqh.coarsening import CoarseMesh, ConformingMesh
    from tusqh.meshes.checks import Check
    from tusqh.meshes.volume_mesh import VolumeMesh
    from tusqh.topology.betti_numbers import BettiNumbers


def check(
    mesh: Annotated[
        Path, typer.Argument(help="A .vtu file of quads or hexes, or a .pvtu file of `--slabs`.")
    ],
    *,
    all_checks: Annotated[
        bool,
        typer.Option("--all-checks", help="Let VTK, MFEM and pymeshlab check large meshes too."),
    ] = False,
) -> None:
    """Measure the topology of a mesh and check that it is fit for analysis.

    A certificate.json beside the mesh is recomputed as well: its digests, measurements and,
    where the fractions are there too, its predictions. With the geometry, the fractions, the place
    of the grid and the warnings are recomputed; without it, the warnings are those recorded. In a
    mesh of several materials, each material is checked. A fitted.vtu is compared with fit.json and
    with the geometry: its topology, its validity and its distances. A coarse.vtu with hanging
    vertices is split into its grid cells, which are checked; the vertices must lie between their
    parents. A conforming one is checked itself. Both are made again from the recorded mesh.

    Exit code 0: all holds; 1: something does not; 2: the file cannot be read.

    For example:

    * `tusqh check results/chesapeake/mesh.vtu`

    * `tusqh check huge.pvtu`
    """
    from tusqh.certificate import FILE_NAME
    from tusqh.coarsening import CoarseMesh
    from tusqh.meshes.export import read_regions, read_vtu
    from tusqh.pipeline.coarsen import find_coarse
    from tusqh.pipeline.materials.recheck import check_materials

    certificate = mesh.parent / FILE_NAME
    if mesh.suffix == ".pvtu":
        from tusqh.cli.slabs import check_pieces

        if all_checks:
            raise ConfigError(
                "--all-checks of a mesh in pieces",
                where=str(mesh),
                expected="a mesh in one piece, which other programs need",
                remedy="leave out --all-checks, or check a .vtu file",
            )
        table, pieces = check_pieces(mesh)
        _end(f"{mesh.name}: {pieces.n_cells} elements", table, pieces.by_euler, certificate)
    volume_mesh = read_vtu(mesh)
    found = find_coarse(mesh)
    title = f"{mesh.name}: {volume_mesh.n_cells} elements"
    if found is not None:
        coarse, source = found
        title += f", which stand for {coarse.n_uniform}"
        volume_mesh = coarse.uniform if isinstance(coarse, CoarseMesh) else coarse.mesh
        table = _check_coarse(mesh, coarse, source, certificate, all_checks=all_checks)
    elif read_regions(mesh) is None:
        table = _check_single(mesh, volume_mesh, certificate, all_checks=all_checks)
    else:
        table = check_materials(mesh, checks="all" if all_checks else None)
    _end(title, table, volume_mesh.measurement.by_euler, certificate)


def _end(title: str, table: pd.DataFrame, measured: BettiNumbers, certificate: Path) -> NoReturn:
    """Show the checks of a mesh, and end with the exit code that they give."""
    from tusqh.certificate import FILE_NAME
    from tusqh.quality.verdict import overall

    show(table, title=f"{title}, Betti numbers {measured}")
    verdict = overall(table)
    where = "" if certificate.is_file() else f" (there is no {FILE_NAME} in its folder)"
    make_console(markup=False, highlight=False).print(verdict + where)
    raise typer.Exit(0 if verdict.startswith("suitable") else 1)


def _check_coarse(
    path: Path,
    coarse: CoarseMesh | ConformingMesh,
    source: Path | None,
    certificate: Path,
    *,
    all_checks: bool,
) -> pd.DataFrame:
    """Return the checks of a coarse mesh; with hanging vertices of the mesh for which it stands."""
    from tusqh.antialias.scheme import PINCH_TEMPLATES
    from tusqh.certificate import read_predicted
    from tusqh.coarsening import CoarseMesh, ConformingMesh
    from tusqh.coarsening.checks import with_transitions
    from tusqh.pipeline.coarsen import recheck_coarse
    from tusqh.pipeline.judge import judge
    from tusqh.pipeline.recheck_fit import is_fitted
    from tusqh.quality.fit_checks import FITTED

    judged = coarse.uniform if isinstance(coarse, CoarseMesh) else coarse.mesh
    expected = judged.measurement.by_euler
    if source is not None and certificate.is_file():
        expected = read_predicted(certificate)
    scheme = FITTED if source is not None and is_fitted(source) else PINCH_TEMPLATES
    if isinstance(coarse, ConformingMesh):
        scheme = with_transitions(scheme)
    claims = recheck_coarse(path, coarse)
    checks: Literal["all"] | None = "all" if all_checks else None
    verdict = judge(judged, expected, comparison=claims, checks=checks, scheme=scheme).verdict
    return verdict.drop(columns="material")


def _check_single(
    path: Path, mesh: VolumeMesh, certificate: Path, *, all_checks: bool
) -> pd.DataFrame:
    """Return the checks of a mesh of one material, and of its certificate if it has one."""
    from tusqh.antialias.scheme import PINCH_TEMPLATES
    from tusqh.certificate import check_certificate, read_predicted
    from tusqh.pipeline.judge import judge
    from tusqh.pipeline.recheck import recheck
    from tusqh.pipeline.recheck_fit import is_fitted, recheck_fit
    from tusqh.quality.fit_checks import FITTED

    claims: list[Check] = []
    expected, scheme = mesh.measurement.by_euler, PINCH_TEMPLATES
    if certificate.is_file():
        expected = read_predicted(certificate)
    if is_fitted(path):
        scheme = FITTED
        claims += recheck_fit(path, mesh)
    elif certificate.is_file():
        claims += check_certificate(certificate, path, mesh)
        claims += recheck(certificate, mesh)
    checks: Literal["all"] | None = "all" if all_checks else None
    verdict = judge(mesh, expected, comparison=claims, checks=checks, scheme=scheme).verdict
    return verdict.drop(columns="material")
