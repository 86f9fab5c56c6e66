"""Write coarse meshes for MFEM and as VTU, and read the latter."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tusqh.atomic import write_text
from tusqh.coarsening.coarse_mesh import CoarseMesh
from tusqh.coarsening.conforming import ConformingMesh
from tusqh.coarsening.mfem_text import write_mfem_text
from tusqh.errors import ConfigError, MeshError
from tusqh.extras import require
from tusqh.grid import BackgroundGrid
from tusqh.meshes.export import Numbers, read_vtu, write_vtu
from tusqh.meshes.formats import Export, write_mesh

#: Suffixes of the formats that can hold hanging vertices.
SUFFIXES = (".vtu", ".mesh", ".mfem")

#: Cell data of VTU files with the level of every element.
LEVEL = "level"


def require_coarse_format(
    path: Path, *, element: str | None = None, layer: float | None = None
) -> None:
    """Raise an error if a mesh with hanging vertices cannot be written to a file in this way.

    Parameters
    ----------
    path
        File to write; only its suffix is checked.
    element, layer
        Kind of the elements and thickness of a layer; None: neither is asked for.

    Raises
    ------
    MeshError
        The format cannot hold hanging vertices.
    ConfigError
        Other elements than linear ones, or a layer, are asked for.
    """
    if path.suffix not in SUFFIXES:
        raise MeshError(
            f"the format {path.suffix!r} cannot hold the hanging vertices of a coarse mesh",
            where=str(path),
            expected="one of " + ", ".join(SUFFIXES),
            remedy="write .mesh for MFEM, or coarsen to a `conforming` mesh",
        )
    if element is not None or layer is not None:
        what = f"element {element!r}" if layer is None else f"layer {layer:g}"
        raise ConfigError(
            f"{what} of a coarse mesh",
            where=str(path),
            expected="the linear elements of its dimension",
            remedy="coarsen to a `conforming` mesh, or leave out `element` and `layer`",
        )


def write_coarse(
    path: Path, coarse: CoarseMesh | ConformingMesh, export: Export | None = None
) -> None:
    """Write a coarse mesh in the format of a file's suffix; it appears complete or not at all.

    In a ``.vtu`` file every element carries its `level`, and the field data describe the grid, so
    that the mesh can be checked.  With hanging vertices, a ``.mesh`` file is in MFEM's format
    1.1, whose section `vertex_parents` constrains them, and no other format can hold them; a
    conforming mesh can be written in all.

    Parameters
    ----------
    path
        File to write.
    coarse
        The mesh.
    export
        How it is written; None: linear elements, with the sets that the mesh alone gives.

    Raises
    ------
    MeshError
        The format does not exist or cannot hold hanging vertices.
    ConfigError
        Elements that the mesh or the format does not have, or a layer, are asked for.
    """
    how = export or Export()
    if isinstance(coarse, CoarseMesh):
        require_coarse_format(path, element=how.element, layer=how.layer)
    if path.suffix == ".vtu" and how.is_plain(coarse.mesh.dim):
        _write_vtu(path, coarse)
    elif isinstance(coarse, ConformingMesh):
        write_mesh(path, coarse.mesh, export=how)
    else:
        write_text(path, write_mfem_text(coarse, how))


def _write_vtu(path: Path, coarse: CoarseMesh | ConformingMesh) -> None:
    grid = coarse.grid
    numbers: dict[str, Numbers] = {
        "grid_shape": grid.shape,
        "grid_origin": grid.origin,
        "grid_cell_size": grid.cell_size,
    }
    if isinstance(coarse, ConformingMesh):
        numbers["uniform_elements"] = coarse.n_uniform
    level = {LEVEL: coarse.level.astype(np.int64)}
    write_vtu(path, coarse.mesh, cell_data=level, numbers=numbers)


def read_coarse(path: Path, *, name: str | None = None) -> CoarseMesh | ConformingMesh | None:
    """Return the coarse mesh in a VTU file that `write_coarse` wrote; None if it holds none.

    Parameters
    ----------
    path
        The file.
    name
        Name of the mesh for messages; the file name without suffix by default.

    Raises
    ------
    MeshError
        The file cannot be read, or its levels or its grid are not valid.
    """
    mesh = read_vtu(path, name=name)
    data = require("pyvista", extra="formats").read(path)
    if LEVEL not in data.cell_data or "grid_shape" not in data.field_data:
        return None
    level, stored = np.asarray(data.cell_data[LEVEL]), data.field_data
    shape = tuple(int(n) for n in stored["grid_shape"])
    grid = BackgroundGrid(
        shape, float(stored["grid_cell_size"][0]), tuple(float(x) for x in stored["grid_origin"])
    )
    of_blocks = mesh.grid_cell[level > 0]
    is_in_grid = (of_blocks >= 0) & (of_blocks < grid.n_cells)
    if level.min() < 0 or level.max() > 30 or not is_in_grid.all():
        raise MeshError(
            f"has levels from {level.min()} to {level.max()}, and "
            f"{(~is_in_grid).sum()} blocks outside the grid {grid.label}",
            where=str(path),
            expected="a coarse mesh as `tusqh` writes it",
            remedy="make it again",
        )
    if "uniform_elements" in stored:
        n_uniform = int(stored["uniform_elements"][0])
        return ConformingMesh(mesh, level.astype(np.int8), grid, n_uniform)
    return CoarseMesh(mesh, level.astype(np.int8), grid)
