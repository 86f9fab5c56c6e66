"""Geometry files of both dimensions: where they are, what they hold, and their canonical form."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from tusqh.atomic import replacing
from tusqh.errors import GeometryError
from tusqh.geometry import io, io_image
from tusqh.geometry.image import Image
from tusqh.geometry.outline import Outline
from tusqh.geometry.packaged import PACKAGE as PACKAGE
from tusqh.geometry.packaged import locate as locate
from tusqh.geometry.read import SUFFIXES as OUTLINE_SUFFIXES
from tusqh.geometry.read import read_outline
from tusqh.geometry.read_image import SUFFIXES as IMAGE_SUFFIXES
from tusqh.geometry.read_image import read_image
from tusqh.geometry.read_surface import SUFFIXES as SURFACE_SUFFIXES
from tusqh.geometry.read_surface import read_soup
from tusqh.geometry.soup import Soup

#: What a geometry file may hold.
Geometry = Outline | Soup | Image


def dimension_of(geometry: str) -> int:
    """Return 3 for surfaces and images and 2 for outlines, by the suffix of a file.

    >>> dimension_of("part.STL"), dimension_of("foam.tif"), dimension_of("bay.geojson")
    (3, 3, 2)
    """
    return 3 if Path(geometry).suffix.lower() in SURFACE_SUFFIXES + IMAGE_SUFFIXES else 2


def read_geometry(path: Path, *, image: Mapping[str, float] | None = None) -> Geometry:
    """Return what a geometry file holds, an outline, a soup or an image, exactly as it is.

    Parameters
    ----------
    path
        The file; its suffix names the format.
    image
        `voxel_size`, `empty` and `full` of an image, see `tusqh.geometry.read_image`.

    Raises
    ------
    GeometryError
        The file is missing, unreadable or empty, or `image` is given for one that is none.
    """
    suffix = path.suffix.lower()
    if suffix in IMAGE_SUFFIXES:
        return read_image(path, **(image or {}))
    if image:
        raise GeometryError(
            f"`image` is given for a file of type {suffix or '(no suffix)'!r}",
            where=str(path),
            expected=f"an image: {', '.join(IMAGE_SUFFIXES)}",
            remedy="remove `image`",
        )
    if suffix in SURFACE_SUFFIXES:
        return read_soup(path)
    if suffix in OUTLINE_SUFFIXES:
        return read_outline(path)
    raise GeometryError(
        f"files of type {suffix or '(no suffix)'!r} are not supported",
        where=str(path),
        expected="one of " + ", ".join(OUTLINE_SUFFIXES + SURFACE_SUFFIXES + IMAGE_SUFFIXES),
        remedy="export the geometry in one of these formats",
    )


def write_geometry(path: Path, geometry: Geometry) -> None:
    """Write a geometry as binary VTP, whole or not at all.

    Lines, or triangles with their part, or the box of an image with its voxels as field data.
    """
    import pyvista

    if isinstance(geometry, Outline):
        io.write_outline(path, geometry)
        return
    if isinstance(geometry, Image):
        io_image.write_image(path, geometry)
        return
    n = len(geometry.triangles)
    mesh = pyvista.PolyData(
        geometry.points, faces=np.column_stack([np.full(n, 3), geometry.triangles]).ravel()
    )
    mesh.cell_data["part"] = geometry.parts
    mesh.field_data["name"] = [json.dumps(geometry.name)]
    with replacing(path) as temporary:
        mesh.save(temporary, binary=True)


def load_geometry(path: Path) -> Geometry:
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
    if io_image.VOXELS in mesh.field_data:
        return io_image.load_image(mesh)
    if not isinstance(mesh, pyvista.PolyData) or mesh.n_lines or "part" not in mesh.cell_data:
        return io.load_outline(path)
    return Soup(
        points=np.array(mesh.points, dtype=np.float64),
        triangles=mesh.faces.reshape(-1, 4)[:, 1:].astype(np.int64),
        parts=np.array(mesh.cell_data["part"], dtype=np.int64),
        name=str(json.loads(str(mesh.field_data["name"][0]))),
    )
