"""Read the surface of a VTK, VTU or VTP file; of a volume mesh its boundary."""

from __future__ import annotations

from pathlib import Path

import pyvista

from tusqh.geometry.soup import Soup
from tusqh.readers.reading import Reading
from tusqh.readers.surfaces import surfaces_of_dataset


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
        The soup is empty, without extent or not finite.
    """
    return Reading(
        Soup.from_parts(surfaces_of_dataset(pyvista.read(path), name=str(path)), name=path.name)
    )
