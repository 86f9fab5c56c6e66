"""Write and read snapshots as VTU files, with a PVD collection that ParaView animates."""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from tusqh.atomic import replacing, write_text
from tusqh.extras import require
from tusqh.grid import FloatArray, IntArray
from tusqh.simulate.diffusion import DiffusionResult

_VTK_QUAD, _VTK_HEXAHEDRON = 9, 12


def write_snapshots(collection: Path, files: list[Path], result: DiffusionResult) -> None:
    """Write one VTU per snapshot, and the PVD file that lists them with their times in s.

    Parameters
    ----------
    collection
        The PVD file.
    files
        The VTU files, in the order of the snapshots.
    result
        The simulation.
    """
    pyvista = require("pyvista", extra="simulate")
    dim = result.points.shape[1]
    points = np.zeros((len(result.points), 3))
    points[:, :dim] = result.points
    cell_type = _VTK_QUAD if dim == 2 else _VTK_HEXAHEDRON
    for path, field in zip(files, result.fields, strict=True):
        grid = pyvista.UnstructuredGrid({cell_type: result.cells}, points)
        grid.point_data["concentration"] = field
        with replacing(path) as temporary:
            grid.save(temporary, binary=True)
    entries = [
        f'    <DataSet timestep="{time!r}" part="0" '
        f"file={quoteattr(path.relative_to(collection.parent).as_posix())}/>\n"
        for path, time in zip(files, result.table["time_s"].tolist(), strict=True)
    ]
    write_text(
        collection,
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
        + "".join(entries)
        + "  </Collection>\n</VTKFile>\n",
    )


def read_snapshot(path: Path) -> tuple[FloatArray, IntArray, FloatArray]:
    """Read a snapshot that `write_snapshots` wrote.

    Parameters
    ----------
    path
        The VTU file.

    Returns
    -------
    points : numpy.ndarray
        Coordinates, shape (n, dim), in the model's unit.
    cells : numpy.ndarray
        Corners of the elements, shape (m, 2**dim).
    field : numpy.ndarray
        The field at the points, shape (n,).
    """
    pyvista = require("pyvista", extra="simulate")
    grid = pyvista.read(path)
    dim = 2 if grid.celltypes[0] == _VTK_QUAD else 3
    cells = grid.cells.reshape(-1, 2**dim + 1)[:, 1:].astype(np.int64)
    return grid.points[:, :dim].copy(), cells, np.array(grid.point_data["concentration"])
