"""Read a triangle soup from a surface file, exactly as the file gives it.

Nothing is merged, closed, oriented or dropped; polygons are cut into triangles.  STL has no
connectivity, so there every triangle has corners of its own; only equal coordinates tell which
of them meet, see `tusqh.geometry.soup.Soup.matched`.
"""

from __future__ import annotations

import struct
from pathlib import Path

from tusqh.errors import GeometryError
from tusqh.geometry.soup import Soup
from tusqh.geometry.surfaces import Surface, soup_of, surfaces_of_dataset, surfaces_of_scene

#: Suffixes read by trimesh, and those read by VTK.
TRIMESH_SUFFIXES = (".stl", ".obj", ".ply", ".off", ".glb", ".gltf")
VTK_SUFFIXES = (".vtk", ".vtu", ".vtp")
SUFFIXES = TRIMESH_SUFFIXES + VTK_SUFFIXES


def read_soup(path: Path) -> Soup:
    """Return the triangles in an STL, OBJ, PLY, OFF, GLB, VTK, VTU or VTP file.

    Raises
    ------
    GeometryError
        The file is missing, damaged, empty, flat in all directions or not finite.
    """
    if not path.is_file():
        raise GeometryError(
            "there is no such file",
            where=str(path),
            expected="a geometry file",
            remedy="check the path",
        )
    suffix = path.suffix.lower()
    try:
        if suffix == ".stl":
            _check_stl_size(path)
        parts = _read_by_trimesh(path) if suffix in TRIMESH_SUFFIXES else _read_by_vtk(path)
    except GeometryError:
        raise
    except Exception as error:  # The readers raise whatever their parsers trip over.
        raise GeometryError(
            f"the file cannot be read: {error or type(error).__name__}",
            where=str(path),
            expected=f"a well-formed {suffix} file",
            remedy="open it in the program that wrote it and export it again",
        ) from error
    return soup_of(parts, name=path.name)


def _read_by_trimesh(path: Path) -> list[Surface]:
    import trimesh

    return surfaces_of_scene(trimesh.load_scene(path, process=False))


def _read_by_vtk(path: Path) -> list[Surface]:
    import pyvista

    return surfaces_of_dataset(pyvista.read(path))


def _check_stl_size(path: Path) -> None:
    """Raise when a binary STL is shorter or longer than its own count says."""
    size = path.stat().st_size
    with path.open("rb") as stream:
        head = stream.read(84)
    if head.lstrip()[:5].lower() == b"solid" and b"\0" not in head:
        tail = path.read_bytes()[-200:].lower()
        if b"endsolid" not in tail:
            raise _damaged(path, "the text ends before `endsolid`")
        return
    if len(head) < 84:
        raise _damaged(path, f"the file has {size} bytes, too few for an STL header")
    (n_triangles,) = struct.unpack("<I", head[80:84])
    if size < 84 + 50 * n_triangles:
        raise _damaged(
            path,
            f"the header promises {n_triangles} triangles, the file holds {(size - 84) // 50}",
        )


def _damaged(path: Path, found: str) -> GeometryError:
    return GeometryError(
        found,
        where=str(path),
        expected="a whole STL file",
        remedy="copy or export the file again; it is cut off or damaged",
    )
