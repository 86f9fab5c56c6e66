"""Read well-known text: one geometry in a line, or one geometry over several lines."""

from __future__ import annotations

import re
from pathlib import Path

import shapely

from tusqh.errors import GeometryError
from tusqh.readers.places import NOT_STATED, system_of_code
from tusqh.readers.polygons_of_maps import Map, reading_of_map
from tusqh.readers.project import to_plane
from tusqh.readers.reading import Reading
from tusqh.readers.simple_features import add_geometry

_START = re.compile(
    r"(?:SRID\s*=\s*(\d+)\s*;\s*)?((?:MULTI)?(?:POINT|LINESTRING|POLYGON)|GEOMETRYCOLLECTION)\b",
    re.IGNORECASE,
)


def read(path: Path, *, crs: str | None = None) -> Reading:
    """Read every geometry as a feature.

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
    GeometryError
        A geometry cannot be read, or the outline is empty, without extent or not finite.
    """
    text = path.read_text(encoding="utf-8-sig").strip()
    found, system = Map(), NOT_STATED
    for number, piece in enumerate(_pieces(text)):
        match = _START.match(piece)
        if match is None:
            raise _damaged(path, number, f"it begins with {piece[:40]!r}")
        if match[1]:
            system = system_of_code(f"EPSG:{match[1]}")
        try:
            geometry = shapely.from_wkt(piece[match.start(2) :])
        except (shapely.errors.GEOSException, ValueError) as error:
            raise _damaged(path, number, str(error).splitlines()[0][:120]) from error
        found.begin_feature("")
        add_geometry(found, geometry, f"geometry {number}")
    projected = to_plane(found, system, crs, where=str(path))
    return reading_of_map(
        projected.map, name=path.name, unit=projected.unit, remarks=projected.remarks
    )


def _pieces(text: str) -> list[str]:
    """Return the texts of the geometries, each from its keyword to its last bracket."""
    pieces, depth, start = [], 0, 0
    for match in re.finditer(r"[()]|\bEMPTY\b", text, re.IGNORECASE):
        depth += {"(": 1, ")": -1}.get(match[0], 0)
        if depth <= 0:
            pieces.append(text[start : match.end()].strip(" \t\r\n;,"))
            start, depth = match.end(), 0
    rest = text[start:].strip(" \t\r\n;,")
    return [*pieces, rest] if rest else pieces


def _damaged(path: Path, number: int, found: str) -> GeometryError:
    """Return the error for a text that is not a geometry."""
    return GeometryError(
        f"geometry {number} cannot be read: {found}",
        where=str(path),
        expected="well-known text, such as POLYGON ((0 0, 4 0, 4 3, 0 0))",
        remedy="correct it there, or export the file again",
    )
