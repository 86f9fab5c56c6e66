"""Geometry files of both dimensions: where they are, what they hold, and their canonical form."""

from __future__ import annotations

import json
from importlib import metadata
from pathlib import Path

import numpy as np

from tusqh.atomic import replacing
from tusqh.errors import GeometryError
from tusqh.geometry import io
from tusqh.geometry.outline import Outline
from tusqh.geometry.read import read_outline
from tusqh.geometry.read_surface import SUFFIXES, read_soup
from tusqh.geometry.soup import Soup

#: A geometry that begins so names a file inside an installed package: ``package:NAME/FILE``.
PACKAGE = "package:"


def dimension_of(geometry: str) -> int:
    """Return 3 for surface files and 2 for outlines, by the suffix of a configuration entry.

    >>> dimension_of("part.STL"), dimension_of("bay.geojson")
    (3, 2)
    """
    return 3 if Path(geometry).suffix.lower() in SUFFIXES else 2


def locate(geometry: str) -> Path:
    """Return the path of a configuration entry, inside an installed package or not.

    Raises
    ------
    GeometryError
        The package is not installed or has no such file.
    """
    if not geometry.startswith(PACKAGE):
        return Path(geometry)
    name, _, inner = geometry.removeprefix(PACKAGE).partition("/")
    try:
        files = metadata.files(name) or []
    except metadata.PackageNotFoundError:
        files = []
    for file in files:
        if file.as_posix().endswith(inner):
            return Path(str(file.locate()))
    raise GeometryError(
        f"the package {name!r} has no file {inner!r}",
        where=geometry,
        expected="a file of an installed package, as package:NAME/FILE",
        remedy=f"pip install {name}, or give the path of a file instead",
    )


def read_geometry(path: Path) -> Outline | Soup:
    """Return what a geometry file holds, an outline or a soup, exactly as it is."""
    return read_soup(path) if dimension_of(path.name) == 3 else read_outline(path)


def write_geometry(path: Path, geometry: Outline | Soup) -> None:
    """Write a geometry as binary VTP, whole or not at all: lines, or triangles with their part."""
    import pyvista

    if isinstance(geometry, Outline):
        io.write_outline(path, geometry)
        return
    n = len(geometry.triangles)
    mesh = pyvista.PolyData(
        geometry.points, faces=np.column_stack([np.full(n, 3), geometry.triangles]).ravel()
    )
    mesh.cell_data["part"] = geometry.parts
    mesh.field_data["name"] = [json.dumps(geometry.name)]
    with replacing(path) as temporary:
        mesh.save(temporary, binary=True)


def load_geometry(path: Path) -> Outline | Soup:
    """Return the geometry that `write_geometry` wrote, equal in every bit.

    Raises
    ------
    GeometryError
        The file is missing or is not such a file.
    """
    import pyvista

    if not path.is_file():
        return io.load_outline(path)  # Says what is missing.
    mesh = pyvista.read(path)
    if not isinstance(mesh, pyvista.PolyData) or mesh.n_lines or "part" not in mesh.cell_data:
        return io.load_outline(path)
    return Soup(
        points=np.array(mesh.points, dtype=np.float64),
        triangles=mesh.faces.reshape(-1, 4)[:, 1:].astype(np.int64),
        parts=np.array(mesh.cell_data["part"], dtype=np.int64),
        name=str(json.loads(str(mesh.field_data["name"][0]))),
    )
