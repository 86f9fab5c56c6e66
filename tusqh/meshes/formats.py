"""Write meshes for MFEM, Gmsh, Exodus and Abaqus, with the sides of their boundary."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.atomic import replacing, write_text
from tusqh.errors import MeshError
from tusqh.extras import require
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.boundary import SIDES
from tusqh.meshes.export import write_vtu
from tusqh.meshes.regions import Regions
from tusqh.meshes.sets import FacetSet, facet_sets, point_sets
from tusqh.meshes.volume_mesh import VolumeMesh

#: Number of each local facet of a hex in a format, in the order of `HEX_FACETS`; all formats number
#: the sides of quads alike.
_EXODUS_FACES = np.array([4, 2, 1, 3, 5, 6])
_ABAQUS_FACES = np.array([6, 4, 3, 5, 1, 2])

#: Largest number of characters in a name of Exodus.
_EXODUS_NAME = 32

#: CalculiX reads the first 20 characters of a number and cuts off the rest, even the exponent.
#: A sign, 14 digits, a point and an exponent of three digits need up to 21; "%.13g" needs 20.
_ABAQUS_NUMBER = "%.13g"

#: Coordinates smaller than this fraction of the largest extent are written as zeros.
_DUST = 1e-12


def write_mesh(path: Path, mesh: VolumeMesh, regions: Regions | None = None) -> None:
    """Write a mesh in the format of a file's suffix; the file appears complete or not at all.

    The suffixes are ``.vtu`` (VTK), ``.mesh`` (MFEM, boundary attributes), ``.msh`` (Gmsh 2.2 in
    ASCII, physical groups), ``.exo`` (Exodus, side sets) and ``.inp`` (Abaqus, surfaces).  The
    sets of facets and points are those of `tusqh.meshes.sets`.  VTU has none.  In MFEM and Gmsh,
    where a facet belongs to one set, it belongs to the side of the boundary or to the earlier
    material; these formats have no sets of points.

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
        write_vtu(path, mesh, regions=regions)
    else:
        _WRITERS[path.suffix](path, mesh, regions or Regions.single(mesh.n_cells))


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


def _write_mfem(path: Path, mesh: VolumeMesh, regions: Regions) -> None:
    text = io.StringIO()
    geometry, facet = (3, 1) if mesh.dim == 2 else (5, 3)
    sets = [found for found in facet_sets(mesh, regions) if not found.is_repeated]
    text.write("MFEM mesh v1.0\n\n# Boundary attributes:\n")
    for found in sets:
        text.write(f"# {found.number} {found.name}: {found.meaning}\n")
    if regions.are_several:
        text.write("\n# Attributes of elements:\n")
        for region in regions.present:
            text.write(f"# {region.number} {region.name}\n")
    text.write(f"\ndimension\n{mesh.dim}\n\nelements\n{mesh.n_cells}\n")
    head = np.stack([regions.material + 1, np.full(mesh.n_cells, geometry)], axis=1)
    np.savetxt(text, np.hstack([head, mesh.cells]), fmt="%d")
    corners, number = _join_sets(sets)
    text.write(f"\nboundary\n{len(corners)}\n")
    head = np.stack([number, np.full(len(corners), facet)], axis=1)
    np.savetxt(text, np.hstack([head, corners]), fmt="%d")
    text.write(f"\nvertices\n{len(mesh.points)}\n{mesh.dim}\n")
    np.savetxt(text, mesh.points, fmt="%.17g")
    write_text(path, text.getvalue())


def _write_gmsh(path: Path, mesh: VolumeMesh, regions: Regions) -> None:
    import meshio

    # Here the numbers of regions, which start at 1 in other formats, must differ from the sets'.
    sets = [found for found in facet_sets(mesh, regions) if not found.is_repeated]
    corners, number = _join_sets(sets)
    first = max(len(SIDES), int(number.max()))
    groups = [number, first + 1 + regions.material]
    names = {found.name: np.array([found.number, mesh.dim - 1]) for found in sets}
    names |= {r.name: np.array([first + r.number, mesh.dim]) for r in regions.present}
    out = _to_meshio(
        mesh,
        [("line" if mesh.dim == 2 else "quad", corners)],
        cell_data={"gmsh:physical": groups, "gmsh:geometrical": groups},
        field_data=names,
    )
    with replacing(path) as temporary:
        # OpenFOAM, getfem, NGSolve and deal.II do not read the binary form.
        meshio.gmsh.write(temporary, out, fmt_version="2.2", binary=False)


def _write_exodus(path: Path, mesh: VolumeMesh, regions: Regions) -> None:
    import meshio

    netCDF4 = require("netCDF4", extra="formats")

    # Elements are numbered block by block.
    number = np.empty(mesh.n_cells, dtype=np.int64)
    number[np.concatenate([r.elements for r in regions.present])] = np.arange(mesh.n_cells)
    with replacing(path) as temporary:
        kind = "quad" if mesh.dim == 2 else "hexahedron"
        blocks = [(kind, mesh.cells[region.elements]) for region in regions.present]
        junctions = point_sets(mesh, regions)
        named = {_fitting(f.name, f"points_{f.number}"): f.points for f in junctions}
        out = meshio.Mesh(mesh.points_in_space(), blocks, point_sets=named)
        meshio.exodus.write(temporary, out)
        with netCDF4.Dataset(temporary, "a") as file:
            file.title = mesh.name  # Replace meshio's title, which contains the time.
            # meshio numbers blocks and sets from 0, other programs from 1.
            file["eb_prop1"][:] = [region.number for region in regions.present]
            blocks_named = [_fitting(r.name, f"block_{r.number}") for r in regions.present]
            _write_names(file, "eb_names", "num_el_blk", blocks_named)
            if junctions:
                file["ns_prop1"][:] = [f.number for f in junctions]
            sets = facet_sets(mesh, regions)
            file.createDimension("num_side_sets", len(sets))
            file.createVariable("ss_status", "i4", ("num_side_sets",))[:] = 1
            ids = file.createVariable("ss_prop1", "i4", ("num_side_sets",))
            ids.setncattr("name", "ID")
            ids[:] = [found.number for found in sets]
            sides_named = [_fitting(found.name, f"sides_{found.number}") for found in sets]
            _write_names(file, "ss_names", "num_side_sets", sides_named)
            for k, found in enumerate(sets, start=1):
                file.createDimension(f"num_side_ss{k}", len(found.element))
                elements = file.createVariable(f"elem_ss{k}", "i4", (f"num_side_ss{k}",))
                elements[:] = number[found.element] + 1
                sides = file.createVariable(f"side_ss{k}", "i4", (f"num_side_ss{k}",))
                sides[:] = _numbers(mesh.dim, found.local, _EXODUS_FACES)


def _write_names(file: Any, variable: str, dimension: str, names: Sequence[str]) -> None:
    """Write names to an Exodus file."""
    width = file.dimensions["len_string"].size
    named = file.createVariable(variable, "S1", (dimension, "len_string"))
    for k, name in enumerate(names):
        named[k] = _to_characters(name, width)


def _fitting(name: str, otherwise: str) -> str:
    """Return a name if Exodus has room for it."""
    return name if len(name.encode()) <= _EXODUS_NAME else otherwise


def _to_characters(label: str, width: int) -> Any:
    """Return a name as Exodus stores it: single characters, padded with zeros."""
    return np.frombuffer(label.ljust(width, "\0").encode(), dtype="S1")


def _write_abaqus(path: Path, mesh: VolumeMesh, regions: Regions) -> None:
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
    for found in facet_sets(mesh, regions):
        name = found.name.replace("|", "_to_")
        text.write(f"** {name}: {found.meaning}\n")
        text.write(f"*SURFACE, TYPE=ELEMENT, NAME={name}\n")
        rows = np.column_stack([found.element + 1, _numbers(mesh.dim, found.local, _ABAQUS_FACES)])
        np.savetxt(text, rows, fmt="%d, S%d")
    for junction in point_sets(mesh, regions):
        text.write(f"*NSET, NSET={junction.name.replace('|', '_and_')}\n")
        np.savetxt(text, junction.points + 1, fmt="%d")
    write_text(path, text.getvalue())


def _join_sets(sets: Sequence[FacetSet]) -> tuple[IntArray, IntArray]:
    """Return the corners of the facets of all sets, and the number of each one's set."""
    number = np.repeat([found.number for found in sets], [len(found.element) for found in sets])
    return np.concatenate([found.corners for found in sets]), number.astype(np.int64)


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


_WRITERS: dict[str, Callable[[Path, VolumeMesh, Regions], None]] = {
    ".mesh": _write_mfem,
    ".msh": _write_gmsh,
    ".exo": _write_exodus,
    ".inp": _write_abaqus,
}
