"""`tusqh recommend`: the coarsest grid that robustly has a topology, and the command for it."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from tusqh.cli import options
from tusqh.cli.progress import shown
from tusqh.cli.show import make_console, report_error, show
from tusqh.settings.model import Settings

if TYPE_CHECKING:
    from tusqh.pipeline.recommend import Recommendation


@options.with_settings(
    without=(
        *(f"goal.{name}" for name in ("threshold", "persistence", "volume", "scope", "base")),
        *(f"grid.{name}" for name in ("cells", "cell_size", "placement", "offset")),
        *("goal.features", "memory"),
    )
)
def recommend(
    geometry: options.Source,
    *,
    settings: Settings,
    finest: Annotated[
        int | None,
        typer.Option(
            min=6,
            metavar="N",
            help="Finest grid to try, in cells along the longest side. (default: 128 in 2D, 64 in "
            "3D)",
        ),
    ] = None,
) -> None:
    """Recommend the coarsest grid, the threshold and the placement that robustly have a topology.

    Grids from coarse to fine are sampled at four positions; no mesh is made. A grid is robust if
    all positions have the topology at one threshold and at all others up to 0.05 away from it. The
    coarsest robust grid whose next finer one is robust too is recommended, with the command that
    makes its mesh.

    For example:

    * `tusqh recommend part.stl --betti 1,2,0`

    * `tusqh recommend part.stl --betti 1,2,0 --snap --finest 96`
    """
    from tusqh.pipeline.recommend import recommend as find
    from tusqh.pipeline.unused_settings import read_with

    reading = read_with(geometry, settings)
    for remark in reading.remarks:
        typer.echo(str(remark))
    target = settings.goal.target
    with shown() as progress:
        found = find(reading.geometry, target, settings, finest=finest, progress=progress)
    _show(found, str(target))
    if found.cells is None:
        report_error(
            f"no grid that was tried has {target} robustly; the interval with the largest margin "
            "is in the table. Try a larger `--finest`, another `--inside` or `--snap`; `tusqh mesh "
            "--betti` changes single cells where no threshold has the topology"
        )
        raise typer.Exit(1)
    typer.echo("command")
    typer.echo(f"  tusqh mesh {shlex.quote(str(geometry))} {shlex.join(found.words)}")


def _show(found: Recommendation, wanted: str) -> None:
    """Print the grids that were tried."""
    table = found.table.copy().astype(object)
    counts = zip(found.table["have_it"], found.table["positions"], strict=True)
    table["have it"] = [f"{a} of {b}" for a, b in counts]
    table["robust"] = ["yes" if value else "no" for value in found.table["is_robust"]]
    names = {"lower": "lower <", "upper": "t <= upper"}
    names |= {"volume_from": "volume from", "volume_to": "to"}
    columns = ["cells", "have it", "lower", "upper", "threshold", "margin"]
    columns += ["volume_from", "volume_to", "robust"]
    shown_table = table[columns].where(table[columns].notna(), "")
    show(cast(Any, shown_table.rename(columns=names)), title=f"Grids tried for {wanted}")
    console = make_console()
    console.print("lower, upper: thresholds at which all positions have it; volume: at threshold t")
    if found.two_cells is not None:
        console.print(
            f"cells of {found.two_cells:.3g} put two cells across all but the thinnest 5 % of walls"
        )
