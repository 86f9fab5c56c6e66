"""The command line: `tusqh inspect` and `tusqh check`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import pandas as pd
import typer
from rich.console import Console
from rich.table import Table

from tusqh.errors import TusqhError

app = typer.Typer(
    help="Meshes with the topology you ask for, from geometry nobody repaired.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


@app.command()
def inspect(
    geometry: Annotated[
        Path, typer.Argument(help="GeoJSON, SVG, DXF, CSV; STL, OBJ, PLY, OFF, GLB, VTK.")
    ],
) -> None:
    """Measure the defects of a geometry file; nothing is repaired.

    Example: tusqh inspect data_sources/chesapeake/counties.geojson
    """
    from tusqh.geometry.defects import describe_defects
    from tusqh.geometry.files import read_geometry
    from tusqh.geometry.outline import Outline
    from tusqh.geometry.surface_defects import describe_surface_defects
    from tusqh.sampling.crossings import describe_winding

    found = read_geometry(geometry)
    if isinstance(found, Outline):
        table = describe_defects(found)
    else:
        table = pd.concat([describe_surface_defects(found), describe_winding(found)])
    _show(table, title=f"Defects of {geometry.name}")


@app.command()
def check(mesh: Annotated[Path, typer.Argument(help="A .vtu file of quads.")]) -> None:
    """Measure the topology of a mesh and check that it is fit for analysis.

    A certificate.json beside the mesh is recomputed as well: its digests, measurements and,
    where the fractions are there too, its predictions.

    Exit code 0: all holds; 1: something does not; 2: the file cannot be read.
    Example: tusqh check results/chesapeake/mesh.vtu
    """
    from tusqh.certificate import FILE_NAME, check_certificate, read_predicted
    from tusqh.mesh.betti import betti_by_euler
    from tusqh.mesh.export import read_vtu
    from tusqh.quality.elements import element_metrics
    from tusqh.quality.verdict import judge_mesh, overall, to_table

    volume_mesh = read_vtu(mesh)
    certificate = mesh.parent / FILE_NAME
    measured = betti_by_euler(volume_mesh)
    expected = read_predicted(certificate) if certificate.is_file() else measured
    checks = judge_mesh(volume_mesh, expected, element_metrics(volume_mesh))
    if certificate.is_file():
        checks += check_certificate(certificate, mesh, volume_mesh)
    table = to_table(checks)
    _show(table, title=f"{mesh.name}: {volume_mesh.n_cells} elements, Betti numbers {measured}")
    verdict = overall(table)
    Console().print(verdict + ("" if certificate.is_file() else " (no certificate beside it)"))
    raise typer.Exit(0 if verdict.startswith("suitable") else 1)


def main() -> None:
    """Run the command line; errors that a user can mend are messages, not tracebacks."""
    try:
        app()
    except TusqhError as error:
        Console(stderr=True).print(f"error in {error}", style="red", highlight=False, markup=False)
        raise SystemExit(2) from None


def _show(frame: pd.DataFrame, *, title: str) -> None:
    table = Table(title=title, title_justify="left")
    for column in frame.columns:
        table.add_column(str(column))
    for row in frame.itertuples(index=False):
        table.add_row(*[f"{v:.6g}" if isinstance(v, float) else str(v) for v in row])
    Console().print(table)


if __name__ == "__main__":
    main()
