"""Write and read a mesh of hexes in pieces: VTU files, and a PVTU file that names them."""

from __future__ import annotations

import warnings
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from tusqh.atomic import replacing, write_text
from tusqh.errors import MeshError
from tusqh.extras import require
from tusqh.grid import FloatArray
from tusqh.grid.arrays import as_indices
from tusqh.meshes.export import add_numbers, number_of_unit, read_vtu
from tusqh.meshes.seams import Piece

#: Point data of pieces: the number of each point in the whole mesh.
NUMBER = "point_number"

_HEAD = (
    '<?xml version="1.0"?>\n<VTKFile type="PUnstructuredGrid" version="0.1" '
    'byte_order="LittleEndian">\n<PUnstructuredGrid GhostLevel="0">\n<PPoints>\n'
    '<PDataArray type="Float64" Name="Points" NumberOfComponents="3"/>\n</PPoints>\n'
)


def write_piece(
    path: Path, piece: Piece, cell_data: Mapping[str, FloatArray], unit: str = ""
) -> None:
    """Write a piece as binary VTU; the file appears complete or not at all.

    Parameters
    ----------
    path
        File to write, ending in ``.vtu``.
    piece
        The piece.
    cell_data
        Further values, one per element.
    unit
        Unit of length of the points; empty if it is not known.
    """
    import meshio

    data: dict[str, list[Any]] = {"kind": [piece.kind], "grid_cell": [as_indices(piece.grid_cell)]}
    data |= {name: [values] for name, values in cell_data.items()}
    out = meshio.Mesh(
        piece.points,
        [("hexahedron", piece.cells)],
        point_data={NUMBER: piece.numbers},
        cell_data=data,
    )
    with replacing(path) as temporary:
        meshio.vtu.write(temporary, out, binary=True)
        if unit:
            add_numbers(temporary, number_of_unit(unit))


def write_pvtu(path: Path, pieces: Sequence[Path], cell_data: Sequence[str]) -> None:
    """Write a PVTU file; it appears complete or not at all.

    Parameters
    ----------
    path
        File to write, ending in ``.pvtu``.
    pieces
        The files of the pieces, below the folder of the PVTU file.
    cell_data
        Names of the real values that each element has beside `kind` and `grid_cell`.
    """
    # Readers take the types from the pieces, which have 64-bit cells where 32 bits are too few.
    kinds = [("Int8", "kind"), ("Int32", "grid_cell"), *(("Float64", name) for name in cell_data)]
    lines = [f'<PPointData>\n<PDataArray type="Int64" Name="{NUMBER}"/>\n</PPointData>']
    arrays = "\n".join(f'<PDataArray type="{kind}" Name="{name}"/>' for kind, name in kinds)
    lines.append(f"<PCellData>\n{arrays}\n</PCellData>")
    sources = [file.relative_to(path.parent).as_posix() for file in pieces]
    lines += [f"<Piece Source={quoteattr(source)}/>" for source in sources]
    write_text(path, _HEAD + "\n".join(lines) + "\n</PUnstructuredGrid>\n</VTKFile>\n")


def pieces_in(path: Path) -> list[Path]:
    """Return the files of the pieces that a PVTU file names.

    Parameters
    ----------
    path
        The PVTU file.

    Raises
    ------
    MeshError
        It cannot be read, or names no pieces.
    """
    try:
        root = ET.fromstring(path.read_text("utf-8"))
        found = [path.parent / piece.attrib["Source"] for piece in root.iter("Piece")]
    except (OSError, ValueError, KeyError, ET.ParseError) as reason:
        raise _unreadable(path, str(reason)) from reason
    if not found:
        raise _unreadable(path, "it names no pieces")
    return found


def read_pieces(path: Path) -> Iterator[Piece]:
    """Yield the pieces of a mesh of hexes, in their order.

    Parameters
    ----------
    path
        The PVTU file.

    Raises
    ------
    MeshError
        A file is missing or is not a piece that `write_piece` wrote.
    """
    for file in pieces_in(path):
        yield read_piece(file)


def read_piece(path: Path) -> Piece:
    """Return a piece of a mesh of hexes.

    Parameters
    ----------
    path
        The VTU file.

    Raises
    ------
    MeshError
        The file is missing or is not a piece that `write_piece` wrote.
    """
    mesh = read_vtu(path)
    pyvista = require("pyvista", extra="formats")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        data = pyvista.read(path).point_data
    if mesh.dim != 3 or NUMBER not in data:
        raise _unreadable(path, f"it has no point data `{NUMBER}`, or is in the plane")
    numbers = np.asarray(data[NUMBER], dtype=np.int64)
    return Piece(mesh.points, numbers, mesh.cells, mesh.kind, mesh.grid_cell.astype(np.int64))


def _unreadable(path: Path, why: str) -> MeshError:
    return MeshError(
        f"cannot be read as a mesh in pieces: {why}",
        where=str(path),
        expected="a .pvtu file that tusqh wrote, with its pieces",
        remedy="make the mesh again with `--slabs`; other meshes can be checked as one .vtu file",
    )
