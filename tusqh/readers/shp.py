"""Read the rings and lines of a shapefile."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import shapefile

from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray
from tusqh.readers.reading import Reading


def read(path: Path) -> Reading:
    """Read every ring and line as a chain, in file order.

    Only the ``.shp`` itself is read, neither its table nor its coordinate system; points and
    empty shapes have no lines and are skipped; z and m are dropped.

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
    ValueError
        The file is damaged, or holds patches in space.
    GeometryError
        The outline is empty, without extent or not finite.
    """
    try:
        with path.open("rb") as stream, shapefile.Reader(shp=stream) as reader:
            shapes = list(reader.iterShapes())
    except (struct.error, shapefile.ShapefileException) as reason:
        raise ValueError(f"the shapefile is damaged ({reason})") from reason
    chains = [chain for shape in shapes for chain in _chains_of(shape)]
    return Reading(Outline.from_chains(chains, name=path.name))


def _chains_of(shape: Any) -> list[FloatArray]:
    """Return the parts of a shape, each of shape (k, 2)."""
    kind = shape.shapeTypeName
    if kind == "NULL" or "POINT" in kind:
        return []
    if not kind.startswith(("POLYGON", "POLYLINE")):
        raise ValueError(f"shapes of type {kind} are not outlines")
    points = np.array(shape.points, dtype=np.float64).reshape(-1, 2)
    return np.split(points, list(shape.parts)[1:])
