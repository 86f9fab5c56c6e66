"""The rings and lines of a shapefile."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.grid import FloatArray


def read_shp_chains(path: Path) -> list[FloatArray]:
    """Return every ring and line of a shapefile, in file order, as an array of shape (k, 2).

    Only the ``.shp`` itself is read, neither its table nor its coordinate system; points and
    empty shapes have no lines and are passed over; z and m are dropped.

    Raises
    ------
    ValueError
        The file is damaged, or holds patches in space.
    """
    import shapefile

    try:
        with path.open("rb") as stream, shapefile.Reader(shp=stream) as reader:
            shapes = list(reader.iterShapes())
    except (struct.error, shapefile.ShapefileException) as reason:
        raise ValueError(f"it is no whole shapefile ({reason})") from reason
    return [chain for shape in shapes for chain in _chains_of(shape)]


def _chains_of(shape: Any) -> list[FloatArray]:
    kind = shape.shapeTypeName
    if kind == "NULL" or "POINT" in kind:
        return []
    if not kind.startswith(("POLYGON", "POLYLINE")):
        raise ValueError(f"shapes of type {kind} are no outlines")
    points = np.array(shape.points, dtype=np.float64).reshape(-1, 2)
    return np.split(points, list(shape.parts)[1:])
