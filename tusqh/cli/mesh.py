"""`tusqh mesh`: a quad or hex mesh with the topology that was asked for."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table

from tusqh.cli import options, outputs
from tusqh.cli.materials import Shown, mesh_and_show
from tusqh.cli.progress import shown
from tusqh.cli.show import make_console, print_table, report_error
from tusqh.cli.slabs import mesh_slabs, require_one_in_slabs
from tusqh.errors import ConfigError, TopologyError
from tusqh.settings.model import Settings

if TYPE_CHECKING:
    from tusqh.pipeline.report import Report


@options.with_settings()
def mesh(
    geometry: options.Sources,
    output: outputs.Paths = None,
    results: outputs.Folder = None,
    *,
    element: outputs.ElementName = None,
    layer: outputs.Layer = None,
    name_set: outputs.Names = None,
    sets: outputs.Tables = None,
    picture: outputs.Picture = None,
    settings: Settings,
    strict: Annotated[
        bool, typer.Option("--strict", help="End with exit code 3 where there are warnings.")
    ] = False,
    materials: Annotated[
        bool,
        typer.Option(
            "--materials",
            help="Mesh several materials: a file for each, of which earlier ones have priority "
            "where they overlap; or one file, whose parts or labels they are (label 0 is void).",
        ),
    ] = False,
    material: Annotated[
        list[str] | None,
        typer.Option(
            help="Threshold or Betti numbers of one of the materials, as ring=0.4 or ball=1,0,0; "
            "`bone=label 2` names a label. May be given several times.",
            metavar="NAME=WISH",
        ),
    ] = None,
    rest: Annotated[
        str | None,
        typer.Option(help="Material that fills what the others leave of the grid.", metavar="NAME"),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the report as JSON.")] = False,
) -> None:
    """Mesh a dirty geometry with the topology you ask for.

    Exit code 0: the mesh measures the topology that was asked for and predicted, and no check
    fails; 1: no threshold gives it, or a check fails; 2: bad input or output; 3: there are
    warnings, with --strict; 141: the program that reads the output ended first, as head does.

    For example:

    * `tusqh mesh part.stl --cells 64 --betti 1,0,0 -o part.vtu`

    * `tusqh mesh bearing.stl --rule clamped --betti 3,* -o bearing.msh -o bearing.inp`

    * `tusqh mesh map.geojson --domain outside --threshold 0.4 --results out/map`

    * `tusqh mesh part.stl --fit --element C3D20R --set bolt=near:30,20,0 -o part.inp`

    * `tusqh mesh huge.stl --cells 512 --slabs auto -o huge.pvtu`

    * `tusqh mesh ring.stl ball.stl --materials --material ball=1,0,0 -o assembly.exo`
    """
    stem = Path(geometry[0]).stem if len(geometry) == 1 else "materials"
    in_slabs = settings.memory.slabs is not None
    paths = output or [Path(stem + (".pvtu" if in_slabs else ".vtu"))]
    written = outputs.Outputs(
        paths, results, element, layer, name_set or (), sets, picture, in_slabs=in_slabs
    )
    is_several = materials or bool(material) or rest is not None
    if in_slabs:
        require_one_in_slabs(geometry, is_several=is_several)
    has_hanging = settings.coarsening.coarsen == "interior" and not is_several
    written.require(geometry, has_hanging=has_hanging)
    if is_several:
        shown_as = Shown(as_json=as_json, is_strict=strict)
        mesh_and_show(geometry, material or [], settings, rest=rest, files=written, shown=shown_as)
        return
    if len(geometry) > 1:
        raise ConfigError(
            f"{len(geometry)} geometries",
            where="tusqh mesh",
            expected="one geometry, or --materials for one mesh of several materials",
            remedy="add --materials, or mesh one after the other",
        )
    from tusqh.pipeline.stages import run_stages

    try:
        if in_slabs:
            report = mesh_slabs(geometry[0], settings, paths, results).report
            paths = [*paths, *filter(None, [results])]
        else:
            with shown() as progress:
                result = run_stages(geometry[0], settings, progress=progress)
    except TopologyError as error:
        report_error(str(error))
        raise typer.Exit(1) from None
    if not in_slabs:
        paths = written.write(result)
        report = result.report
    if as_json:
        typer.echo(json.dumps(_to_plain(report), indent=2))
    else:
        _show(report, paths)
    if not (report.is_met and report.is_suitable):
        raise typer.Exit(1)
    raise typer.Exit(3 if strict and report.has_warnings else 0)


def _show(report: Report, written: list[Path]) -> None:
    """Print the report, and what fails."""
    table = Table.grid(padding=(0, 2))
    for title, text in report.lines().items():
        table.add_row(title, text)
    table.add_row("written", ", ".join(str(path) for path in written))
    console = make_console(highlight=False, markup=False)
    print_table(console, table)
    failed = report.verdict[report.verdict["holds"] == "no"]
    for row in failed.itertuples():
        console.print(f"fails: {row.name}: {row.found}, required {row.required}", style="red")
        if str(row.remedy):
            console.print(f"remedy: {row.remedy!s}", style="red")


def _to_plain(report: Report) -> dict[str, Any]:
    chosen = report.selection
    return {
        "model": report.name,
        "wanted": chosen.wanted,
        "threshold": chosen.threshold,
        "margin": chosen.margin,
        "predicted": list(report.predicted),
        "measured": list(report.measured),
        "met": report.is_met,
        "suitable": report.is_suitable,
        "warnings": report.has_warnings,
        "read": report.reading,
        "remarks": [str(remark) for remark in report.remarks],
        "mesh": report.facts,
        "checks": report.verdict.to_dict("records"),
    }
