"""`tusqh check`: say whether a mesh is fit for analysis, and as certified."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from tusqh.cli.show import make_console, show

if TYPE_CHECKING:
    from tusqh.meshes.checks import Check


def check(
    mesh: Annotated[Path, typer.Argument(help="A .vtu file of quads or hexes.")],
    *,
    all_checks: Annotated[
        bool,
        typer.Option("--all-checks", help="Let VTK, MFEM and pymeshlab check large meshes too."),
    ] = False,
) -> None:
    """Measure the topology of a mesh and check that it is fit for analysis.

    A certificate.json beside the mesh is recomputed as well: its digests, measurements and,
    where the fractions are there too, its predictions. With the geometry, the fractions, the place
    of the grid and the warnings are recomputed; without it, the warnings are those recorded.

    Exit code 0: all holds; 1: something does not; 2: the file cannot be read.

    For example:

    * `tusqh check results/chesapeake/mesh.vtu`
    """
    from tusqh.certificate import FILE_NAME, check_certificate, read_predicted
    from tusqh.meshes.export import read_vtu
    from tusqh.pipeline.judge import judge
    from tusqh.pipeline.recheck import recheck

    volume_mesh = read_vtu(mesh)
    certificate = mesh.parent / FILE_NAME
    measured = volume_mesh.measurement.by_euler
    expected = read_predicted(certificate) if certificate.is_file() else measured
    claims: list[Check] = []
    if certificate.is_file():
        claims += check_certificate(certificate, mesh, volume_mesh.measurement)
        claims += recheck(certificate, volume_mesh)
    checks: Literal["all"] | None = "all" if all_checks else None
    judgement = judge(volume_mesh, expected, comparison=claims, checks=checks)
    show(
        judgement.verdict,
        title=f"{mesh.name}: {volume_mesh.n_cells} elements, Betti numbers {measured}",
    )
    verdict = str(judgement)
    where = "" if certificate.is_file() else f" (there is no {FILE_NAME} in its folder)"
    make_console(markup=False, highlight=False).print(verdict + where)
    raise typer.Exit(0 if verdict.startswith("suitable") else 1)
