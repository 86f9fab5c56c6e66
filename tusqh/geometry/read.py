"""Read an outline from a file, exactly as the file gives it.

Nothing is repaired, snapped, closed or merged: an unclosed ring stays open, a doubled border
stays doubled.  Every ring, polyline or continuous subpath of the file becomes one chain.  Only
holes of GeoJSON polygons are turned where they have to be, because their place says what they are.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import ParseError

import numpy as np
from ezdxf.lldxf.const import DXFError

from tusqh.errors import GeometryError
from tusqh.geometry.outline import Outline
from tusqh.geometry.read_dxf import read_dxf_chains
from tusqh.geometry.read_shp import read_shp_chains
from tusqh.geometry.read_svg import read_svg_chains
from tusqh.grid import FloatArray

#: The header of a file of loose segments.
CSV_COLUMNS = ("x0", "y0", "x1", "y1")

#: What the parsers raise over a file that is not what its suffix says.
_PARSER_ERRORS = (
    OSError,
    ValueError,
    TypeError,
    AttributeError,
    LookupError,
    ArithmeticError,
    AssertionError,
    RecursionError,
    ParseError,
    csv.Error,
    DXFError,
)


def read_outline(path: Path) -> Outline:
    """Return the outline in a GeoJSON, shapefile, SVG, DXF or CSV file, named after the file.

    ``.geojson``, ``.json``
        Polygons, lines, collections and features; every ring or line is one chain, and holes
        turn against the outer ring of their polygon.  Points and missing geometries have no lines
        and are passed over; a third coordinate is dropped.
    ``.shp``
        Rings and lines of a shapefile, see `tusqh.geometry.read_shp`.
    ``.svg``
        Paths and basic shapes, see `tusqh.geometry.read_svg`.
    ``.dxf``
        Lines, polylines and curves of the model space, see `tusqh.geometry.read_dxf`.
    ``.csv``
        Loose segments: a header ``x0,y0,x1,y1``, then one segment, and one chain, a row.

    Parameters
    ----------
    path
        The file; its suffix, in upper or lower case, names the format.

    Raises
    ------
    GeometryError
        The file is missing, of no supported format, unreadable, empty, without extent, or has
        coordinates that are not finite.
    """
    where = str(path)
    if not path.is_file():
        raise GeometryError(
            "there is no such file",
            where=where,
            expected="a geometry file",
            remedy="check the path",
        )
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise GeometryError(
            f"files of type {path.suffix or '(no suffix)'!r} are not supported",
            where=where,
            expected=f"one of {', '.join(_READERS)}",
            remedy="export the geometry in one of these formats",
        )
    try:
        chains = reader(path)
    except _PARSER_ERRORS as error:
        raise GeometryError(
            f"the file cannot be read: {error or type(error).__name__}",
            where=where,
            expected=f"a well-formed {path.suffix.lower()} file",
            remedy="open it in the program that wrote it and export it again",
        ) from error
    return Outline.from_chains(chains, name=path.name)


def _read_geojson_chains(path: Path) -> list[FloatArray]:
    """Return every ring and line of a GeoJSON file, in file order."""
    document = json.loads(path.read_text(encoding="utf-8-sig"))
    return list(_lines_of(document))


def _lines_of(item: dict[str, Any] | None) -> Iterator[FloatArray]:
    """Yield the rings and lines of a GeoJSON object."""
    kind = item.get("type") if isinstance(item, dict) else item
    if item is None or kind in ("Point", "MultiPoint"):
        return
    if kind == "FeatureCollection":
        for feature in item["features"]:
            yield from _lines_of(feature)
    elif kind == "Feature":
        yield from _lines_of(item["geometry"])
    elif kind == "GeometryCollection":
        for geometry in item["geometries"]:
            yield from _lines_of(geometry)
    elif kind == "LineString":
        yield _as_points(item["coordinates"])
    elif kind == "MultiLineString":
        yield from map(_as_points, item["coordinates"])
    elif kind == "Polygon":
        yield from _rings_of(item["coordinates"])
    elif kind == "MultiPolygon":
        for polygon in item["coordinates"]:
            yield from _rings_of(polygon)
    else:
        raise ValueError(f"{kind!r} is not a GeoJSON type")


def _rings_of(polygon: list[Any]) -> Iterator[FloatArray]:
    """Yield the rings of a GeoJSON polygon, each hole turned against the outer ring.

    Every ring but the first is a hole, whichever way it turns (RFC 7946, 3.1.6).
    """
    rings = [_as_points(ring) for ring in polygon]
    areas = [_signed_area(ring) for ring in rings]
    for k, ring in enumerate(rings):
        yield ring[::-1] if k and areas[k] * areas[0] > 0 else ring


def _signed_area(ring: FloatArray) -> float:
    """Return the area inside a ring, negative where it is walked clockwise."""
    x, y = (ring - ring.mean(axis=0)).T if len(ring) else np.zeros((2, 0))
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def _as_points(positions: list[Any]) -> FloatArray:
    """Return a GeoJSON list of positions as points, shape (n, 2)."""
    if any(isinstance(number, str) for position in positions for number in position):
        raise ValueError("a coordinate is text, not a number")
    return np.array([position[:2] for position in positions], dtype=np.float64).reshape(-1, 2)


def _read_csv_chains(path: Path) -> list[FloatArray]:
    """Return every row of a file of loose segments as a chain of two points."""
    with path.open(newline="", encoding="utf-8-sig") as file:
        rows = csv.reader(file, skipinitialspace=True)
        header = tuple(name.strip() for name in next(rows, []))
        if header != CSV_COLUMNS:
            raise GeometryError(
                f"the columns are {','.join(header) or '(none)'}",
                where=f"{path}, line 1",
                expected=f"the header {','.join(CSV_COLUMNS)}",
                remedy="give one segment a row: start x and y, end x and y",
            )
        return [_as_segment(row, where=f"{path}, line {rows.line_num}") for row in rows if row]


def _as_segment(row: list[str], *, where: str) -> FloatArray:
    """Return a row of four numbers as two points."""
    try:
        return np.array([float(entry) for entry in row]).reshape(2, 2)
    except ValueError as error:
        raise GeometryError(
            f"the row {','.join(row)!r} is not four numbers",
            where=where,
            expected="x0,y0,x1,y1",
            remedy="correct or remove that row",
        ) from error


_READERS: dict[str, Callable[[Path], list[FloatArray]]] = {
    ".geojson": _read_geojson_chains,
    ".json": _read_geojson_chains,
    ".svg": read_svg_chains,
    ".shp": read_shp_chains,
    ".dxf": read_dxf_chains,
    ".csv": _read_csv_chains,
}

#: Suffixes of files of outlines.
SUFFIXES = tuple(_READERS)
