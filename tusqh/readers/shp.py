"""Read the rings and lines of a shapefile."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import shapefile

from tusqh.grid import FloatArray
from tusqh.readers.beside import files_beside
from tusqh.readers.places import NOT_STATED, CoordinateSystem, system_of_wkt
from tusqh.readers.polygons_of_maps import Map, reading_of_map
from tusqh.readers.project import to_plane
from tusqh.readers.reading import Reading
from tusqh.readers.rings import even_odd_sides, regions_of


def read(path: Path, *, crs: str | None = None) -> Reading:
    """Read every ring and line as a chain, in file order.

    The ``.prj`` file beside the ``.shp`` file states the coordinate system; the table of the
    shapes is not read.  Points and empty
    shapes have no lines and are skipped; z and m are dropped.  A ring is a hole if it lies inside
    an odd number of other rings of its shape, regardless of its direction.

    Parameters
    ----------
    path
        The file.
    crs
        Coordinate system into which it is projected, see `tusqh.readers.project.to_plane`.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    ValueError
        The file is damaged, or holds patches in 3D.
    GeometryError
        The outline is empty, without extent or not finite.
    """
    try:
        with path.open("rb") as stream, shapefile.Reader(shp=stream) as reader:
            shapes = list(reader.iterShapes())
    except (struct.error, shapefile.ShapefileException) as reason:
        raise ValueError(f"the shapefile is damaged ({reason})") from reason
    found = Map()
    for number, shape in enumerate(shapes):
        found.begin_feature("")
        _add(shape, found, f"shape {number}")
    projected = to_plane(found, _system_of(path), crs, where=str(path))
    return reading_of_map(
        projected.map, name=path.name, unit=projected.unit, remarks=projected.remarks
    )


def _system_of(path: Path) -> CoordinateSystem:
    """Return the coordinate system in the file beside a shapefile."""
    beside = files_beside(path)
    return system_of_wkt(beside[-1].read_text("utf-8", errors="replace")) if beside else NOT_STATED


def _add(shape: Any, found: Map, place: str) -> None:
    """Add the parts of a shape to those found."""
    kind = shape.shapeTypeName
    if kind == "NULL":
        return
    if "POINT" in kind:
        found.n_points += len(shape.points)
        return
    if not kind.startswith(("POLYGON", "POLYLINE")):
        raise ValueError(f"shapes of type {kind} are not outlines")
    points = np.array(shape.points, dtype=np.float64).reshape(-1, 2)
    parts = np.split(points, list(shape.parts)[1:])
    if kind.startswith("POLYLINE"):
        found.lines += parts
        return
    for ring, side in zip(parts, _sides_of(parts), strict=True):
        if side > 0:
            found.add_polygon([ring], place)
        else:
            found.add_hole(ring, place)


def _sides_of(rings: list[FloatArray]) -> list[int]:
    """Return for every ring of a shape whether it is outer (1) or a hole (-1)."""
    if any(len(ring) < 3 or not np.isfinite(ring).all() for ring in rings):
        return [1] * len(rings)
    return [int(side) for side in even_odd_sides(regions_of(rings))]
