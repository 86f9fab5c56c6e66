"""`tusqh background`: make background meshes, and mesh a geometry on one."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tusqh.cli.options import Command
from tusqh.cli.show import make_console
from tusqh.errors import ConfigError

if TYPE_CHECKING:
    from tusqh.background.background_mesh import BackgroundMesh

app = typer.Typer(
    help="Make a background mesh, or mesh a geometry in the cells of one.",
    no_args_is_help=True,
    rich_markup_mode="markdown",
)

_Output = Annotated[Path, typer.Option("--output", "-o", help="The mesh file to write.")]
_Lower = Annotated[str, typer.Option(help="Lower corner, as 0,0,0; two numbers for quads.")]
_Upper = Annotated[str, typer.Option(help="Upper corner, likewise.")]
_Cells = Annotated[str, typer.Option(help="Cells along each axis, as 10,10,20.")]
_Unit = Annotated[str, typer.Option(help="Unit of length of the numbers, such as mm.")]


@app.command("box", cls=Command)
def _box(lower: _Lower, upper: _Upper, cells: _Cells, output: _Output, unit: _Unit = "") -> None:
    """Write a box of equal cells.

    For example: `tusqh background box --lower 0,0,0 --upper 4,2,2 --cells 40,20,20 -o box.vtu`
    """
    from tusqh.background.makers import make_box

    corners = _numbers(lower), _numbers(upper)
    _write(make_box(*corners, _counts(cells), unit=unit), output)


@app.command("layers", cls=Command)
def _layers(
    lower: _Lower,
    upper: _Upper,
    cells: _Cells,
    output: _Output,
    growth: Annotated[
        float, typer.Option(help="Thickness of a layer over that of the one below.")
    ] = 1.2,
    unit: _Unit = "",
) -> None:
    """Write a box whose layers along its last axis become thicker.

    For example:
    `tusqh background layers --lower 0,0,0 --upper 4,4,2 --cells 20,20,16 --growth 1.1 -o bed.vtu`
    """
    from tusqh.background.makers import make_layers

    corners = _numbers(lower), _numbers(upper)
    _write(make_layers(*corners, _counts(cells), growth=growth, unit=unit), output)


@app.command("cylinder", cls=Command)
def _cylinder(
    radius: Annotated[float, typer.Option(help="Radius.")],
    output: _Output,
    centre: Annotated[str, typer.Option(help="Centre of the base, as 0,0,0.")] = "0,0,0",
    height: Annotated[float | None, typer.Option(help="Height along z. (default: a disc)")] = None,
    core: Annotated[int, typer.Option(help="Cells along each side of the square core.")] = 6,
    rings: Annotated[int, typer.Option(help="Rings of cells around the core.")] = 4,
    layers: Annotated[int, typer.Option(help="Layers of cells along the height.")] = 8,
    unit: _Unit = "",
) -> None:
    """Write a cylinder of hexes or a disc of quads: a square core with rings around it (O-grid).

    For example: `tusqh background cylinder --radius 2 --height 5 --layers 20 -o pipe.vtu`
    """
    from tusqh.background.makers import make_cylinder

    place = _numbers(centre)[: 2 if height is None else 3]
    counts = {"core": core, "rings": rings, "layers": layers}
    _write(make_cylinder(place, radius, height, **counts, unit=unit), output)


@app.command("mesh", cls=Command)
def _mesh(
    geometry: Annotated[str, typer.Argument(help="A surface or an outline.")],
    background: Annotated[Path, typer.Argument(help="A mesh of hexes, or of quads.")],
    output: _Output,
    threshold: Annotated[
        float | None, typer.Option(help="Keep cells with this volume fraction. (default 0.5)")
    ] = None,
    betti: Annotated[
        str | None, typer.Option(help="Betti numbers that the mesh must have, as 1,0,0.")
    ] = None,
    match_volume: Annotated[
        bool, typer.Option("--match-volume", help="Choose the threshold with the best volume.")
    ] = False,
    samples: Annotated[int, typer.Option(help="Samples along each side of a cell, even.")] = 4,
    unit: Annotated[
        str | None, typer.Option(help="Unit of the geometry, where its file states none.")
    ] = None,
) -> None:
    """Mesh a geometry in the cells of a background mesh.

    All cells are those of one threshold, which the Betti numbers or the volume choose. The mesh is
    measured before it is written; it has no certificate.

    For example: `tusqh background mesh branch.stl pipe.vtu --betti 1,1,0 -o mesh.vtu`
    """
    from tusqh.background.reading import read_background
    from tusqh.background.run import mesh_on_background
    from tusqh.meshes.formats import write_mesh
    from tusqh.meshes.formats.write import require_format
    from tusqh.pipeline.ingest import read_source
    from tusqh.settings.goal import Goal
    from tusqh.settings.lengths import Lengths
    from tusqh.settings.sampling import Sampling

    require_format(output)
    cells = read_background(background, unit=unit or "")
    reading = read_source(geometry, name=Path(geometry).stem, lengths=Lengths(unit=unit))
    console = make_console(markup=False, highlight=False)
    for remark in (*reading.remarks, *cells.remarks):
        console.print(str(remark))
    target = None if betti is None else _target(betti)
    wishes = {"threshold": threshold, "target": target, "volume": "match" if match_volume else None}
    goal = Goal.from_dict({key: wish for key, wish in wishes.items() if wish is not None})
    result = mesh_on_background(
        reading.geometry, cells, goal=goal, sampling=Sampling(samples=samples)
    )
    write_mesh(output, result.mesh)
    worst = float(result.mesh.jacobians.scaled.min())
    console.print(
        f"{output}: {result.mesh.n_cells:,} elements in {int(result.cells.kept.sum()):,} cells of "
        f"{cells.name}\n"
        f"threshold {result.threshold:.6g}, {result.cells.n_contacts} pinches, Betti numbers "
        f"{result.mesh.measurement.by_euler} as predicted\n"
        f"smallest scaled Jacobian {worst:.3g} (background "
        f"{float(cells.jacobians.scaled.min()):.3g})"
    )


def _write(background: BackgroundMesh, output: Path) -> None:
    """Write a background mesh as a plain mesh."""
    from dataclasses import replace

    from tusqh.meshes.formats import write_mesh
    from tusqh.meshes.volume_mesh import VolumeMesh

    plain = VolumeMesh.from_arrays(background.points, background.cells, name=background.name)
    write_mesh(output, replace(plain, unit=background.unit))
    typer.echo(f"{output}: {background.n_cells:,} cells")


def _target(text: str) -> Any:
    """Return Betti numbers such as 1,0..2,* as the values of a target."""
    from tusqh.settings.goal import Target

    try:
        return Target.from_option(text)
    except ValueError as reason:
        raise ConfigError(
            f"`{text}`", where="--betti", expected=str(reason), remedy="correct the option"
        ) from None


def _numbers(text: str) -> tuple[float, ...]:
    """Return the numbers of a text such as 0,0,0.5."""
    try:
        return tuple(float(word) for word in text.split(","))
    except ValueError:
        raise ConfigError(
            f"`{text}`",
            where="command line",
            expected="numbers with commas between them, as 0,0,0.5",
            remedy="correct the option",
        ) from None


def _counts(text: str) -> tuple[int, ...]:
    """Return the whole numbers of a text such as 10,10,20."""
    numbers = _numbers(text)
    if any(number != int(number) for number in numbers):
        raise ConfigError(
            f"`{text}` cells",
            where="command line",
            expected="whole numbers, as 10,10,20",
            remedy="correct `--cells`",
        )
    return tuple(int(number) for number in numbers)
