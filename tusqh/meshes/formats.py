"""Write meshes for MFEM, Gmsh, Exodus and Abaqus, with the sides of their boundary."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.atomic import replacing, write_text
from tusqh.errors import MeshError
from tusqh.extras import require
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.boundary import SIDES, Boundary, describe_side
from tusqh.meshes.export import write_vtu
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh

#: Number of each local facet of a hex in a format, in the order of `HEX_FACETS`; all formats number
#: the sides of quads alike.
_EXODUS_FACES = np.array([4, 2, 1, 3, 5, 6])
_ABAQUS_FACES = np.array([6, 4, 3, 5, 1, 2])

#: CalculiX reads the first 20 characters of a number and cuts off the rest, even the exponent.
#: A sign, 14 digits, a point and an exponent of three digits need up to 21; "%.13g" needs 20.
_ABAQUS_NUMBER = "%.13g"

#: Coordinates smaller than this fraction of the largest extent are written as zeros.
_DUST = 1e-12


def write_mesh(path: Path, mesh: VolumeMesh, regions: Regions | None = None) -> None:
    """Write a mesh in the format of a file's suffix; the file appears complete or not at all.

    The suffixes are ``.vtu`` (VTK), ``.mesh`` (MFEM, boundary attributes), ``.msh`` (Gmsh 2.2 in
    ASCII, physical groups), ``.exo`` (Exodus, side sets) and ``.inp`` (Abaqus, surfaces).  The
    sides are those of `tusqh.meshes.boundary.SIDES`, which attributes of MFEM number from 1.  VTU
    has no sides.

    Parameters
    ----------
    path
        File to write.
    mesh
        The mesh.
    regions
        Material of every element.  It becomes cell data `material` in VTU, attributes in MFEM,
        physical groups in Gmsh, blocks in Exodus and element sets in Abaqus, numbered from 1; None:
        a single material, `solid`.

    Raises
    ------
    MeshError
        The suffix names no format, or the mesh has no elements.
    """
    require_format(path)
    if mesh.n_cells == 0:
        raise MeshError(
            "the mesh has no elements",
            where=mesh.name,
            expected="at least one",
            remedy="lower the threshold",
        )
    if path.suffix == ".vtu":
        numbers = None if regions is None else {"material": regions.material + 1}
        write_vtu(path, mesh, cell_data=numbers)
    else:
        regions = regions or Regions.single(mesh.n_cells)
        _WRITERS[path.suffix](path, mesh, regions, mesh.boundary)


def require_format(path: Path) -> None:
    """Raise a `MeshError` if the suffix of a file names no format of `write_mesh`.

    Parameters
    ----------
    path
        File to write; only its suffix is checked.

    Raises
    ------
    MeshError
        The suffix names no format.
    """
    if path.suffix not in (".vtu", *_WRITERS):
        raise MeshError(
            f"the suffix {path.suffix!r} names no format",
            where=str(path),
            expected="one of " + ", ".join((".vtu", *_WRITERS)),
            remedy="change the suffix",
        )


def _write_mfem(path: Path, mesh: VolumeMesh, regions: Regions, boundary: Boundary) -> None:
    text = io.StringIO()
    geometry, facet = (3, 1) if mesh.dim == 2 else (5, 3)
    text.write("MFEM mesh v1.0\n\n# Boundary attributes:\n")
    for attribute in np.unique(boundary.attribute):
        name = SIDES[attribute - 1]
        text.write(f"# {attribute} {name}: {describe_side(name)}\n")
    if len(regions.names) > 1:
        text.write("\n# Attributes of elements:\n")
        for region in regions.present:
            text.write(f"# {region.number} {region.name}\n")
    text.write(f"\ndimension\n{mesh.dim}\n\nelements\n{mesh.n_cells}\n")
    head = np.stack([regions.material + 1, np.full(mesh.n_cells, geometry)], axis=1)
    np.savetxt(text, np.hstack([head, mesh.cells]), fmt="%d")
    text.write(f"\nboundary\n{len(boundary.corners)}\n")
    head = np.stack([boundary.attribute, np.full(len(boundary.corners), facet)], axis=1)
    np.savetxt(text, np.hstack([head, boundary.corners]), fmt="%d")
    text.write(f"\nvertices\n{len(mesh.points)}\n{mesh.dim}\n")
    np.savetxt(text, mesh.points, fmt="%.17g")
    write_text(path, text.getvalue())


def _write_gmsh(path: Path, mesh: VolumeMesh, regions: Regions, boundary: Boundary) -> None:
    import meshio

    # Here the numbers of regions, which start at 1 in other formats, must differ from the sides'.
    groups = [boundary.attribute, len(SIDES) + 1 + regions.material]
    present = np.unique(boundary.attribute)
    names = {SIDES[k - 1]: np.array([k, mesh.dim - 1]) for k in present}
    names |= {r.name: np.array([len(SIDES) + r.number, mesh.dim]) for r in regions.present}
    out = _to_meshio(
        mesh,
        [("line" if mesh.dim == 2 else "quad", boundary.corners)],
        cell_data={"gmsh:physical": groups, "gmsh:geometrical": groups},
        field_data=names,
    )
    with replacing(path) as temporary:
        # OpenFOAM, getfem, NGSolve and deal.II do not read the binary form.
        meshio.gmsh.write(temporary, out, fmt_version="2.2", binary=False)


def _write_exodus(path: Path, mesh: VolumeMesh, regions: Regions, boundary: Boundary) -> None:
    import meshio

    netCDF4 = require("netCDF4", extra="formats")

    faces = _numbers(mesh.dim, boundary.local, _EXODUS_FACES)
    present = np.unique(boundary.attribute)
    # Elements are numbered block by block.
    number = np.empty(mesh.n_cells, dtype=np.int64)
    number[np.concatenate([r.elements for r in regions.present])] = np.arange(mesh.n_cells)
    with replacing(path) as temporary:
        kind = "quad" if mesh.dim == 2 else "hexahedron"
        blocks = [(kind, mesh.cells[region.elements]) for region in regions.present]
        meshio.exodus.write(temporary, meshio.Mesh(mesh.points_in_space(), blocks))
        with netCDF4.Dataset(temporary, "a") as file:
            file.title = mesh.name  # Replace meshio's title, which contains the time.
            # meshio numbers blocks from 0, other programs from 1.
            file["eb_prop1"][:] = [region.number for region in regions.present]
            width = file.dimensions["len_string"].size
            named = file.createVariable("eb_names", "S1", ("num_el_blk", "len_string"))
            for k, region in enumerate(regions.present):
                named[k] = _to_characters(region.name, width)
            file.createDimension("num_side_sets", len(present))
            file.createVariable("ss_status", "i4", ("num_side_sets",))[:] = 1
            ids = file.createVariable("ss_prop1", "i4", ("num_side_sets",))
            ids.setncattr("name", "ID")
            ids[:] = present
            names = file.createVariable("ss_names", "S1", ("num_side_sets", "len_string"))
            for k, attribute in enumerate(present, start=1):
                members = boundary.attribute == attribute
                file.createDimension(f"num_side_ss{k}", int(members.sum()))
                elements = file.createVariable(f"elem_ss{k}", "i4", (f"num_side_ss{k}",))
                elements[:] = number[boundary.element[members]] + 1
                sides = file.createVariable(f"side_ss{k}", "i4", (f"num_side_ss{k}",))
                sides[:] = faces[members]
                names[k - 1] = _to_characters(SIDES[attribute - 1], width)


def _to_characters(label: str, width: int) -> Any:
    """Return a name as Exodus stores it: single characters, padded with zeros."""
    return np.frombuffer(label.ljust(width, "\0").encode(), dtype="S1")


def _write_abaqus(path: Path, mesh: VolumeMesh, regions: Regions, boundary: Boundary) -> None:
    faces = _numbers(mesh.dim, boundary.local, _ABAQUS_FACES)
    text = io.StringIO()
    text.write(f"*HEADING\n{mesh.name}\n*NODE\n")
    number = np.arange(1, len(mesh.points) + 1)
    points = _without_dust(mesh.points_in_space())
    form = ["%d"] + 3 * [_ABAQUS_NUMBER]
    np.savetxt(text, np.column_stack([number, points]), fmt=form, delimiter=", ")
    kind = "CPS4" if mesh.dim == 2 else "C3D8"
    for region in regions.present:
        text.write(f"*ELEMENT, TYPE={kind}, ELSET={region.name}\n")
        rows = np.column_stack([region.elements + 1, mesh.cells[region.elements] + 1])
        np.savetxt(text, rows, fmt="%d", delimiter=", ")
    for attribute in np.unique(boundary.attribute):
        members = boundary.attribute == attribute
        name = SIDES[attribute - 1]
        text.write(f"** {name}: {describe_side(name)}\n")
        text.write(f"*SURFACE, TYPE=ELEMENT, NAME={name}\n")
        rows = np.column_stack([boundary.element[members] + 1, faces[members]])
        np.savetxt(text, rows, fmt="%d, S%d")
    write_text(path, text.getvalue())


def _without_dust(points: FloatArray) -> FloatArray:
    """Return coordinates with exact zeros in place of rounding errors."""
    extent = float(np.ptp(points, axis=0).max(initial=0.0))
    return np.where(np.abs(points) < _DUST * extent, 0.0, points)


def _numbers(dim: int, local: IntArray, of_hex: IntArray) -> IntArray:
    """Return the numbers that a format gives to local facets."""
    return np.asarray(local + 1 if dim == 2 else of_hex[local], dtype=np.int64)


def _to_meshio(mesh: VolumeMesh, facets: list[tuple[str, IntArray]], **data: Any) -> Any:
    import meshio

    cells = [*facets, ("quad" if mesh.dim == 2 else "hexahedron", mesh.cells)]
    return meshio.Mesh(mesh.points_in_space(), cells, **data)


_WRITERS: dict[str, Callable[[Path, VolumeMesh, Regions, Boundary], None]] = {
    ".mesh": _write_mfem,
    ".msh": _write_gmsh,
    ".exo": _write_exodus,
    ".inp": _write_abaqus,
}
