"""Read the rings and lines of a GeoJSON file.

Every ring or line is one chain.  The role of a ring follows from its place in the polygon,
regardless of its direction (RFC 7946, 3.1.6): the first ring is the outer ring, the others are
holes.  Points and missing geometries have no lines; a third coordinate is dropped.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from tusqh.errors import GeometryError
from tusqh.grid import FloatArray
from tusqh.readers.places import crs_in_json
from tusqh.readers.polygons_of_maps import Map, reading_of_map
from tusqh.readers.project import to_plane
from tusqh.readers.reading import Reading

#: Nesting depth of the coordinate lists of each type.
_DEPTHS = {
    "Point": 1,
    "MultiPoint": 2,
    "LineString": 2,
    "MultiLineString": 3,
    "Polygon": 3,
    "MultiPolygon": 4,
}

#: Meaning of a list of coordinates, by depth.
_LISTS = {1: "a position", 2: "a line or ring", 3: "a polygon"}


def read(path: Path, *, crs: str | None = None) -> Reading:
    """Read every ring, or every line if there are no rings, in file order.

    Parameters
    ----------
    path
        The file.
    crs
        Coordinate system into which it is projected, see `tusqh.readers.project.to_plane`.

    Returns
    -------
    Reading
        The geometry, with remarks on lines beside polygons, points, and rings that had to be
        turned.

    Raises
    ------
    ValueError
        The file is not JSON.
    GeometryError
        The file is not GeoJSON, or the outline is empty, without extent or not finite.
    """
    document = json.loads(path.read_text(encoding="utf-8-sig"))
    found = Map()
    _collect(document, found, path, "the file")
    projected = to_plane(found, crs_in_json(document), crs, where=str(path))
    return reading_of_map(
        projected.map, name=path.name, unit=projected.unit, remarks=projected.remarks
    )


def _collect(item: Any, found: Map, path: Path, place: str) -> None:
    """Add the rings and lines of a GeoJSON object to those found."""
    if item is None:
        return
    if not isinstance(item, dict):
        _refuse(f"{place} is {_described(item)}", path, place, "a GeoJSON object with a `type`")
    kind = item.get("type")
    if kind == "FeatureCollection":
        for number, feature in enumerate(_list_in(item, "features", path, place)):
            _collect(feature, found, path, f"feature {number}")
    elif kind == "Feature":
        found.begin_feature(_name_of(item))
        _collect(item.get("geometry"), found, path, place)
    elif kind == "GeometryCollection":
        for number, geometry in enumerate(_list_in(item, "geometries", path, place)):
            inner = f"geometry {number}"
            _collect(geometry, found, path, inner if place == "the file" else f"{place}, {inner}")
    elif kind in _DEPTHS:
        _add(kind, _list_in(item, "coordinates", path, place), found, path, place)
    else:
        what = f"{_short(kind)} is not a GeoJSON type"
        _refuse(what, path, place, "Feature, FeatureCollection, or a type of geometry")


def _name_of(feature: dict[str, Any]) -> str:
    """Return the name of a feature: its property of that name, in any case of letters."""
    properties = feature.get("properties")
    if isinstance(properties, dict):
        for key, value in properties.items():
            if str(key).lower() == "name" and isinstance(value, (str, int, float)):
                return str(value)
    return ""


def _add(kind: str, coordinates: list[Any], found: Map, path: Path, place: str) -> None:
    """Add the content of a geometry of a given type."""
    where = f"{place} ({kind})"
    if kind == "LineString":
        found.lines.append(_points_of(coordinates, 2, path, where))
    elif kind == "MultiLineString":
        found.lines += [_points_of(line, 2, path, where) for line in coordinates]
    elif kind in ("Polygon", "MultiPolygon"):
        for number, polygon in enumerate([coordinates] if kind == "Polygon" else coordinates):
            _check_list(polygon, 3, path, where)
            name = place if kind == "Polygon" else f"{place}, polygon {number}"
            found.add_polygon([_points_of(ring, 2, path, where) for ring in polygon], name)
    else:
        found.n_points += 1 if kind == "Point" else len(coordinates)


def _points_of(positions: Any, depth: int, path: Path, where: str) -> FloatArray:
    """Return a list of positions as points, shape (n, 2)."""
    _check_list(positions, depth, path, where)
    for position in positions:
        _check_list(position, depth - 1, path, where)
        if len(position) < 2:
            _refuse(f"the position {_short(position)} has fewer than two numbers", path, where)
        for number in position[:2]:
            if isinstance(number, str):
                _refuse(f"the coordinate {_short(number)} is text, not a number", path, where)
            if isinstance(number, (list, dict, bool)):
                _refuse(f"a coordinate is {_described(number)}", path, where)
    return np.array([position[:2] for position in positions], dtype=np.float64).reshape(-1, 2)


def _check_list(item: Any, depth: int, path: Path, where: str) -> None:
    """Raise an error if the coordinates are not nested as their type requires."""
    if not isinstance(item, list):
        found = f"the coordinates have {_described(item)} where {_LISTS[depth]} belongs"
        _refuse(found, path, where, "coordinates nested as the type of the geometry asks for")


def _list_in(item: dict[str, Any], key: str, path: Path, place: str) -> list[Any]:
    """Return the list that a GeoJSON object must have under a key."""
    value = item.get(key)
    if not isinstance(value, list):
        found = f"has no `{key}`" if key not in item else f"has {_described(value)} as `{key}`"
        _refuse(f"a {item['type']} {found}", path, place, f"a list under `{key}`")
    return value


def _described(item: Any) -> str:
    """Describe an item of JSON in a few words."""
    if isinstance(item, list):
        kinds = {i.get("type") for i in item if isinstance(i, dict)}
        of = "features" if kinds == {"Feature"} else "entries"
        return f"a list of {len(item):,} {of}"
    return "an object" if isinstance(item, dict) else _short(item)


def _short(item: Any) -> str:
    """Return an item in at most 40 characters."""
    text = repr(item)
    return text if len(text) <= 40 else f"{text[:37]}..."


def _refuse(found: str, path: Path, place: str, expected: str = "") -> NoReturn:
    """Raise the error for a file that is not GeoJSON."""
    raise GeometryError(
        f"the file cannot be read: {found}",
        where=str(path) if place == "the file" else f"{path}, {place}",
        expected=expected or "positions of two or three numbers",
        remedy='put a list of features into {"type": "FeatureCollection", "features": [...]}'
        if "features" in found
        else "correct it there, or export the file again",
    )
