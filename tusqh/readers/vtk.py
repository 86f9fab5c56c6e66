"""Read a surface, or the boundary of a volume mesh, from a VTK, VTU or VTP file."""

from __future__ import annotations

from pathlib import Path

from tusqh.geometry.soup import Soup
from tusqh.readers.reading import Reading
from tusqh.readers.surfaces import surfaces_of_dataset
from tusqh.readers.vtk_file import load_dataset


def read(path: Path) -> Reading:
    """Read the surface as a soup of one part.

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
        The file is cut off or damaged, holds an image, or the soup is empty, without extent or
        not finite.
    """
    parts, remarks = surfaces_of_dataset(load_dataset(path), name=str(path))
    return Reading(Soup.from_parts(parts, name=path.name), tuple(remarks))
