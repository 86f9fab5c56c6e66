"""Read and write VTU mesh files, which ParaView, meshio and MFEM read."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from tusqh.atomic import replacing
from tusqh.errors import MeshError
from tusqh.extras import require
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.volume_mesh import KINDS, VolumeMesh

_VTK_QUAD, _VTK_HEXAHEDRON = 9, 12


def write_vtu(
    path: Path, mesh: VolumeMesh, *, cell_data: Mapping[str, FloatArray | IntArray] | None = None
) -> None:
    """Write a mesh as binary VTU; the file appears complete or not at all.

    Every element carries `kind` (index into `tusqh.meshes.volume_mesh.KINDS`) and `grid_cell`.

    Parameters
    ----------
    path
        File to write, ending in ``.vtu``.
    mesh
        The mesh, possibly without elements.
    cell_data
        Further values, one per element.
    """
    import meshio

    out = mesh.to_meshio()
    for name, values in (cell_data or {}).items():
        out.cell_data[name] = [values]
    with replacing(path) as temporary:
        meshio.vtu.write(temporary, out, binary=True)


def read_vtu(path: Path, *, name: str | None = None) -> VolumeMesh:
    """Return the mesh in a VTU file of quads in the plane or of hexes.

    Parameters
    ----------
    path
        The file.
    name
        Name of the mesh for messages; the file name without suffix by default.

    Raises
    ------
    MissingExtraError
        VTK is not installed; it comes with the extra `formats`.
    MeshError
        The file cannot be read or holds other elements.
    """
    pyvista = require("pyvista", extra="formats")
    if not path.is_file():
        raise MeshError(
            "no such file",
            where=str(path),
            expected="a .vtu mesh",
            remedy="check the path, or make the mesh first",
        )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Files without points are rejected below.
            grid = pyvista.read(path)
        types = set(np.unique(grid.celltypes).tolist())
    except Exception as reason:
        raise MeshError(
            f"cannot be read as a mesh: {reason}",
            where=str(path),
            expected="a VTK XML unstructured grid (.vtu)",
            remedy="convert the mesh, for instance with `meshio convert`",
        ) from reason
    if grid.n_cells == 0:
        raise MeshError(
            "holds no elements",
            where=str(path),
            expected="quads or hexahedra",
            remedy="check that the file is whole; a lower threshold keeps more cells",
        )
    if types - {_VTK_QUAD, _VTK_HEXAHEDRON} or len(types) > 1:
        raise MeshError(
            f"holds elements of VTK types {sorted(types)}",
            where=str(path),
            expected=f"quads ({_VTK_QUAD}) or hexahedra ({_VTK_HEXAHEDRON}) only",
            remedy="remove other elements from the mesh",
        )
    dim = 3 if _VTK_HEXAHEDRON in types else 2
    cells = grid.cells.reshape(-1, 2**dim + 1)[:, 1:].astype(np.int64)
    zeros = np.zeros(len(cells), dtype=np.int64)
    kind = np.asarray(grid.cell_data.get("kind", zeros), dtype=np.int64)
    grid_cell = np.asarray(grid.cell_data.get("grid_cell", zeros - 1), dtype=np.int64)
    if kind.size and not (kind.min() >= 0 and kind.max() < len(KINDS)):
        kind = zeros
    return VolumeMesh(
        points=np.ascontiguousarray(grid.points[:, :dim], dtype=np.float64),
        cells=cells,
        kind=kind,
        grid_cell=grid_cell,
        name=name or path.stem,
    )
