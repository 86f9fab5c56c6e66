"""Read the surfaces of an OBJ, PLY, OFF or glTF file; polygons are cut into triangles."""

from __future__ import annotations

from pathlib import Path

import trimesh

from tusqh.geometry.soup import Soup
from tusqh.readers.reading import Reading
from tusqh.readers.surfaces import surfaces_of_scene


def read(path: Path) -> Reading:
    """Read every object of the file as a part of the soup.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    GeometryError
        The soup is empty, without extent or not finite.
    """
    scene = trimesh.load_scene(path, process=False)
    return Reading(Soup.from_parts(surfaces_of_scene(scene), name=path.name))
