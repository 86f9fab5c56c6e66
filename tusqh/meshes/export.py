"""Read and write VTU mesh files, which ParaView, meshio and MFEM read."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from tusqh.atomic import replacing
from tusqh.errors import MeshError
from tusqh.extras import require
from tusqh.geometry.units import metres_in
from tusqh.grid import FloatArray, IntArray
from tusqh.grid.arrays import as_indices
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import KINDS, VolumeMesh

_VTK_QUAD, _VTK_HEXAHEDRON = 9, 12

#: Field data of VTU files with the size of a unit of length are called this and its name.
UNIT = "unit of length "

#: Field data of VTU files with the sides of cells that are not cubes are called this and the axis.
SIDE = "side of a cell along "

#: Field data of VTU files with the number of a material are called this and its name.
NAME = "material "

#: What field data hold: a number or several.
Numbers = float | Sequence[float]

#: Start of the content of a VTU file.
_HEAD = b"<UnstructuredGrid>"


def write_vtu(
    path: Path,
    mesh: VolumeMesh,
    *,
    cell_data: Mapping[str, FloatArray | IntArray] | None = None,
    regions: Regions | None = None,
    numbers: Mapping[str, Numbers] | None = None,
) -> None:
    """Write a mesh as binary VTU; the file appears complete or not at all.

    Every element carries `kind` (index into `tusqh.meshes.volume_mesh.KINDS`) and `grid_cell`.
    With regions it carries the number of its `material`, from 1, and the field data have the number
    of each as ``material NAME``; the last one is the void.  If the mesh has a unit of length, the
    field data have its size in metres, 0 if that is not known, as ``unit of length NAME``, and the
    `sides` of cells that are not cubes.

    Parameters
    ----------
    path
        File to write, ending in ``.vtu``.
    mesh
        The mesh, possibly without elements.
    cell_data
        Further values, one per element.
    regions
        Material of every element; None: there is one.
    numbers
        Further field data by name.
    """
    import meshio

    out = mesh.to_meshio()
    for name, values in (cell_data or {}).items():
        out.cell_data[name] = [values]
    if regions is not None:
        out.cell_data["material"] = [regions.material + 1]
    with replacing(path) as temporary:
        meshio.vtu.write(temporary, out, binary=True)
        names = () if regions is None else regions.names
        stored: dict[str, Numbers] = {NAME + n: number for number, n in enumerate(names, start=1)}
        stored |= number_of_unit(mesh.unit) | dict(numbers or {})
        stored |= {SIDE + axis: side for axis, side in zip("xyz", mesh.sides, strict=False)}
        if stored:
            add_numbers(temporary, stored)


def add_numbers(path: Path, numbers: Mapping[str, Numbers]) -> None:
    """Add named numbers as field data to a VTU file; meshio writes no field data.

    An array of texts would be natural, but meshio cannot read files that have one.

    Parameters
    ----------
    path
        The file.
    numbers
        The numbers by name.
    """
    content = path.read_bytes()
    path.write_bytes(content.replace(_HEAD, _HEAD + field_data(numbers), 1))


def field_data(numbers: Mapping[str, Numbers]) -> bytes:
    """Return named numbers as the field data of a VTU file.

    Parameters
    ----------
    numbers
        The numbers by name.
    """
    arrays = "".join(_data_array(name, number) for name, number in numbers.items())
    return f"<FieldData>{arrays}</FieldData>".encode()


def _data_array(name: str, number: Numbers) -> str:
    values = [number] if isinstance(number, (int, float)) else list(number)
    kind = "Int64" if all(isinstance(value, int) for value in values) else "Float64"
    return (
        f'<DataArray type="{kind}" Name={quoteattr(name)} NumberOfTuples="{len(values)}" '
        f'format="ascii">{" ".join(repr(value) for value in values)}</DataArray>'
    )


def number_of_unit(unit: str) -> dict[str, float]:
    """Return the size of a unit of length by its name in field data; empty without a unit.

    Parameters
    ----------
    unit
        The unit; empty if it is not known.
    """
    return {UNIT + unit: float(metres_in(unit) or 0.0)} if unit else {}


def read_regions(path: Path) -> Regions | None:
    """Return the materials in a VTU file that `write_vtu` wrote; None if it has none.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    MeshError
        The numbers of the materials do not fit their names.
    """
    pyvista = require("pyvista", extra="formats")
    grid = pyvista.read(path)
    numbers = {key: int(grid.field_data[key][0]) for key in grid.field_data if key.startswith(NAME)}
    if "material" not in grid.cell_data or not numbers:
        return None
    names = tuple(key.removeprefix(NAME) for key in sorted(numbers, key=lambda k: numbers[k]))
    material = np.asarray(grid.cell_data["material"], dtype=np.int64) - 1
    if material.min() < 0 or material.max() >= len(names):
        raise MeshError(
            f"has materials from {material.min() + 1} to {material.max() + 1}",
            where=str(path),
            expected=f"numbers from 1 to {len(names)}, the number of names",
            remedy="export the mesh again",
        )
    return Regions(names, material)


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
    cells = as_indices(grid.cells.reshape(-1, 2**dim + 1)[:, 1:])
    zeros = np.zeros(len(cells), dtype=np.int8)
    kind = np.asarray(grid.cell_data.get("kind", zeros))
    if kind.size and not (kind.min() >= 0 and kind.max() < len(KINDS)):
        kind = zeros
    grid_cell = np.asarray(grid.cell_data.get("grid_cell", np.full(len(cells), -1)))
    return VolumeMesh(
        points=np.ascontiguousarray(grid.points[:, :dim], dtype=np.float64),
        cells=cells,
        kind=kind.astype(np.int8),
        grid_cell=as_indices(grid_cell.astype(np.int64, copy=False)),
        name=name or path.stem,
        unit=next((k.removeprefix(UNIT) for k in grid.field_data if k.startswith(UNIT)), ""),
        sides=tuple(
            float(grid.field_data[SIDE + axis][0])
            for axis in "xyz"[:dim]
            if SIDE + axis in grid.field_data
        ),
    )
