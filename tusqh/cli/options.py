"""Options that several commands share, and how their text is read."""

from __future__ import annotations

from typing import Annotated, Any

import typer

#: What a geometry argument may be.
FORMATS = "GeoJSON, SHP, SVG, DXF, CSV; STL, OBJ, PLY, OFF, GLB, VTK; NPY, TIFF, NRRD"


def to_betti(text: str) -> list[Any]:
    """Return wanted Betti numbers from text; each a number, a range, or ``*`` for any.

    >>> to_betti("1,0..2,*")
    [1, {'min': 0, 'max': 2}, None]
    >>> to_betti("2..")
    [{'min': 2}]
    """
    return [_to_wanted(entry.strip(), text) for entry in text.split(",")]


def _to_wanted(entry: str, text: str) -> int | dict[str, int] | None:
    low, dots, high = entry.partition("..")
    try:
        if entry == "*":
            return None
        if not dots:
            return int(entry)
        ends = {"min": low, "max": high}
        wanted = {key: int(end) for key, end in ends.items() if end}
    except ValueError:
        wanted = {}
    if not wanted:
        raise typer.BadParameter(
            f"{entry!r} in {text!r} is no Betti number; write 1,0,0 for one component without "
            "holes and voids, 1..3 for a range, * for any"
        )
    return wanted


def to_cells(text: str) -> Any:
    """Return cells along the longest side, or along each axis.

    >>> to_cells("64"), to_cells("60,79")
    (64, [60, 79])
    """
    try:
        numbers = [int(entry) for entry in text.split(",")]
    except ValueError:
        raise typer.BadParameter(f"{text!r} is no number of cells; write 64, or 60,79") from None
    return numbers if len(numbers) > 1 else numbers[0]


def to_window(text: str) -> Any:
    """Return a box from its lowest and its highest corner.

    >>> to_window("0,0,4,3")
    [[0.0, 0.0], [4.0, 3.0]]
    """
    try:
        numbers = [float(entry) for entry in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (4, 6):
        raise typer.BadParameter(
            f"{text!r} is no box; write X0,Y0,X1,Y1, or X0,Y0,Z0,X1,Y1,Z1 in space"
        )
    half = len(numbers) // 2
    return [numbers[:half], numbers[half:]]


Source = Annotated[
    str, typer.Argument(metavar="GEOMETRY", help=f"{FORMATS}; or package:NAME/FILE.")
]
Cells = Annotated[
    Any,
    typer.Option(
        "--cells",
        parser=to_cells,
        metavar="N",
        help="Cells along the longest side, or one number for each axis (60,79). (default 64)",
    ),
]
CellSize = Annotated[
    float | None,
    typer.Option(help="Edge length of a cell in units of the geometry, instead of --cells."),
]
Betti = Annotated[
    Any,
    typer.Option(
        "--betti",
        parser=to_betti,
        metavar="B0,B1,B2",
        help="Wanted components, holes and voids: 1,0,0. Ranges are 1..3, any number is `*`.",
    ),
]
Threshold = Annotated[
    float | None,
    typer.Option(
        help="Keep cells with at least this volume fraction; 0.5 when nothing is asked for."
    ),
]
Persistence = Annotated[
    float | None,
    typer.Option(help="Keep only features that live over at least this range of thresholds."),
]
MatchVolume = Annotated[
    bool,
    typer.Option("--match-volume", help="Take the threshold whose mesh has the right volume."),
]
Window = Annotated[
    Any,
    typer.Option(
        "--window",
        parser=to_window,
        metavar="X0,Y0,X1,Y1",
        help="Box to mesh in; in space six numbers. (default the bounding box)",
    ),
]
Domain = Annotated[
    str, typer.Option(help="Mesh what the geometry encloses, or what it leaves out: outside.")
]
Samples = Annotated[int, typer.Option(help="Samples along each side of a cell, even.")]
Rule = Annotated[str, typer.Option(help="average; or clamped, right for parts that overlap.")]
Sampler = Annotated[
    str, typer.Option(help="crossings; or libigl, to compare (slower, in space to 2 digits).")
]
Tolerance = Annotated[
    float, typer.Option(help="Largest error of a volume fraction where the geometry is open.")
]
Orientation = Annotated[
    str, typer.Option(help="auto turns geometries that are inside out; as-is; flip.")
]
MinCells = Annotated[int | None, typer.Option(help="Remove components of fewer cells than this.")]
VoxelSize = Annotated[
    float | None, typer.Option(help="Images: edge length of a voxel. (default of the file, or 1)")
]
Empty = Annotated[float | None, typer.Option(help="Images: grey value of no material.")]
Full = Annotated[float | None, typer.Option(help="Images: grey value of nothing but material.")]


def to_image(
    voxel_size: float | None, empty: float | None, full: float | None
) -> dict[str, float] | None:
    """Return what the voxels of an image mean, None where nothing is said.

    >>> to_image(0.5, None, 255.0)
    {'voxel_size': 0.5, 'full': 255.0}
    """
    values = {"voxel_size": voxel_size, "empty": empty, "full": full}
    return {key: value for key, value in values.items() if value is not None} or None
