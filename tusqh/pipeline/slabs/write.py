"""Write a mesh in slabs: as pieces with a PVTU file, or as one VTU file."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tusqh.errors import MeshError
from tusqh.grid import FloatArray, IntArray
from tusqh.grid.slabs import Slab
from tusqh.meshes.piece_files import write_piece, write_pvtu
from tusqh.meshes.streamed_vtu import Stream, write_streamed
from tusqh.pipeline.slabs.elements import SlabMesh
from tusqh.pipeline.slabs.fractions import SlabFractions
from tusqh.sampling.doubled_grid import RESOLUTION

#: The suffixes of the formats.
SUFFIXES = (".pvtu", ".vtu")

#: Cell data of pieces and files: the volume fraction of the cell in which an element lies.
_FRACTION = "volume_fraction"

#: VTK's number for hexahedra.
_HEXAHEDRON = 12


def require_slab_format(path: Path) -> None:
    """Raise an error if a mesh in slabs cannot be written in the format of a file.

    Parameters
    ----------
    path
        File to write; only its suffix is checked.

    Raises
    ------
    MeshError
        The suffix is neither ``.pvtu`` nor ``.vtu``.
    """
    if path.suffix not in SUFFIXES:
        raise MeshError(
            f"{path.suffix or 'no suffix'}, for a mesh in slabs",
            where=str(path),
            expected=".pvtu (pieces) or .vtu (one file)",
            remedy="change the suffix, or mesh in one piece, without `--slabs`",
        )


def piece_paths(path: Path, n_pieces: int) -> list[Path]:
    """Return the files of the pieces that belong to a PVTU file.

    Parameters
    ----------
    path
        The PVTU file.
    n_pieces
        Number of pieces.
    """
    return [path.parent / f"{path.stem}_pieces" / f"{k:04d}.vtu" for k in range(n_pieces)]


def write_pieces(
    path: Path,
    mesh: SlabMesh,
    fractions: SlabFractions,
    report: Callable[[int, int], None] | None = None,
) -> None:
    """Write a mesh as VTU pieces with a PVTU file, which comes last.

    Parameters
    ----------
    path
        The PVTU file; the pieces are in a folder beside it.
    mesh
        The mesh.
    fractions
        Its volume fractions.
    report
        Called with (slabs done, slabs in all).
    """
    slabs = [slab for slab, size in zip(mesh.slabs, mesh.sizes, strict=True) if size]
    files = piece_paths(path, len(slabs))
    for number, (slab, file) in enumerate(zip(slabs, files, strict=True), start=1):
        write_slab(file, slab, mesh, fractions)
        if report is not None:
            report(number, len(slabs))
    name_pieces(path, files)
    for leftover in files[0].parent.glob("*.vtu"):
        if leftover not in files:
            leftover.unlink()


def write_slab(file: Path, slab: Slab, mesh: SlabMesh, fractions: SlabFractions) -> None:
    """Write the piece of a slab.

    Parameters
    ----------
    file
        File to write, ending in ``.vtu``.
    slab
        The slab.
    mesh, fractions
        The mesh and its volume fractions.
    """
    piece = mesh.piece(slab)
    in_cell = _fractions_of(slab, piece.grid_cell, fractions)
    write_piece(file, piece, {_FRACTION: in_cell}, mesh.grid.unit)


def name_pieces(path: Path, files: Sequence[Path]) -> None:
    """Write the PVTU file that names the pieces of `write_slab`.

    Parameters
    ----------
    path
        The PVTU file.
    files
        The pieces.
    """
    write_pvtu(path, files, [_FRACTION])


def write_one(path: Path, mesh: SlabMesh, fractions: SlabFractions) -> None:
    """Write a mesh as one VTU file, with the bytes of the mesh in one piece.

    Parameters
    ----------
    path
        File to write, ending in ``.vtu``.
    mesh
        The mesh.
    fractions
        Its volume fractions.
    """
    index = np.dtype(np.int32 if mesh.n_points < 2**31 else np.int64)
    of_cell = np.dtype(np.int32 if mesh.grid.n_cells < 2**31 else np.int64)
    ends = np.cumsum(mesh.sizes)

    def arrays() -> Iterator[Stream]:
        yield Stream("Points", "Points", _points(mesh), 3)
        connectivity = (p.numbers.astype(index)[p.cells].ravel() for p in mesh.pieces())
        yield Stream("Cells", "connectivity", connectivity)
        offsets = (
            (8 * np.arange(end - n + 1, end + 1, dtype=np.int64)).astype(index)
            for n, end in zip(mesh.sizes, ends, strict=True)
        )
        yield Stream("Cells", "offsets", offsets)
        types = (np.full(n, _HEXAHEDRON, dtype=np.int64) for n in mesh.sizes)
        yield Stream("Cells", "types", types)
        yield Stream("CellData", "kind", (p.kind for p in mesh.pieces()))
        grid_cells = (p.grid_cell.astype(of_cell) for p in mesh.pieces())
        yield Stream("CellData", "grid_cell", grid_cells)
        values = (_fractions_of(slab, mesh.piece(slab).grid_cell, fractions) for slab in mesh.slabs)
        yield Stream("CellData", _FRACTION, values)

    write_streamed(path, mesh.n_points, mesh.n_cells, arrays(), mesh.grid.unit)


def _points(mesh: SlabMesh) -> Iterator[NDArray[np.float64]]:
    """Yield the points of the whole mesh, which are collected in a temporary file."""
    with tempfile.NamedTemporaryFile(dir=mesh.folder.path, prefix="elements-points-") as file:
        file.truncate(24 * mesh.n_points)
        for piece in mesh.pieces():
            points = np.memmap(file.name, np.float64, "r+", shape=(mesh.n_points, 3))
            points[piece.numbers] = piece.points
            del points  # Otherwise its pages count as memory of this process.
        step = 1_000_000
        for start in range(0, mesh.n_points, step):
            count = 3 * min(step, mesh.n_points - start)
            yield np.fromfile(file.name, np.float64, count, offset=24 * start)


def _fractions_of(slab: Slab, grid_cell: IntArray, fractions: SlabFractions) -> FloatArray:
    """Return the volume fractions of the cells of elements; 0 outside the grid."""
    cells = fractions.multiples(slab)[1::2, 1::2, 1::2].ravel()
    first = slab.begin * int(np.prod(fractions.grid.shape[1:]))
    is_inside = grid_cell >= 0
    in_cell = cells[np.where(is_inside, grid_cell - first, 0)] * RESOLUTION
    return np.asarray(np.where(is_inside, in_cell, 0.0), dtype=np.float64)
