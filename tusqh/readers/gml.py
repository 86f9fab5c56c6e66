"""Read the polygons and lines of a GML file: simple features of versions 2 and 3."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from tusqh.errors import GeometryError
from tusqh.grid import FloatArray
from tusqh.readers.places import NOT_STATED, CoordinateSystem, system_of_code
from tusqh.readers.polygons_of_maps import Map, reading_of_map
from tusqh.readers.project import to_plane
from tusqh.readers.reading import Reading
from tusqh.readers.xml_names import tag_of

_EXPECTED = "the simple features of GML: polygons and lines of straight segments"
#: Elements with polygons, lines and points, and what bounds a polygon in versions 2 and 3.
_POLYGONS, _LINES = ("Polygon", "PolygonPatch"), ("LineString", "LineStringSegment")
_OUTER, _INNER = ("exterior", "outerBoundaryIs"), ("interior", "innerBoundaryIs")
#: Elements that are curved, or boundaries of solids.
_OTHERS = ("Arc", "ArcString", "Circle", "CircleByCenterPoint", "CubicSpline", "BSpline", "Bezier")


def read(path: Path, *, crs: str | None = None) -> Reading:
    """Read every polygon as a feature.

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
        Coordinates cannot be read, edges are curved, or geometries have several systems.
    """
    root = ElementTree.parse(path).getroot()
    system, is_turned = _system(path, root)
    found = Map()
    for number, (element, dim) in enumerate(_geometries(root, 2)):
        kind, place = tag_of(element), f"geometry {number}"
        if kind in _OTHERS:
            raise _wrong(
                path, f"{place} has an element <{kind}>", "convert curves to straight lines"
            )
        if kind in _POLYGONS:
            found.begin_feature("")
            rings = [
                _turned(_points(path, ring, dim, place), is_turned)
                for sides in (_OUTER, _INNER)
                for ring in element
                if tag_of(ring) in sides
            ]
            if rings:
                found.add_polygon(rings, place)
        elif kind in _LINES:
            found.lines.append(_turned(_points(path, element, dim, place), is_turned))
        else:
            found.n_points += 1
    projected = to_plane(found, system, crs, where=str(path))
    return reading_of_map(
        projected.map, name=path.name, unit=projected.unit, remarks=projected.remarks
    )


def _geometries(element: Element, dim: int) -> Iterator[tuple[Element, int]]:
    """Yield polygons, lines, points and curves, each with the number of its coordinates."""
    pending = [(element, dim)]
    while pending:
        element, dim = pending.pop()
        stated = element.get("srsDimension", "")
        dim = int(stated) if stated in ("2", "3") else dim
        if tag_of(element) in (*_POLYGONS, *_LINES, *_OTHERS, "Point"):
            yield element, dim
        else:
            pending += [(child, dim) for child in reversed(element)]


def _system(path: Path, root: Element) -> tuple[CoordinateSystem, bool]:
    """Return the coordinate system, and whether coordinates are latitude before longitude."""
    names = list(dict.fromkeys(e.get("srsName", "") for e in root.iter() if e.get("srsName")))
    if not names:
        return NOT_STATED, False
    systems = [system_of_code(name) for name in names]
    if len({system.text for system in systems}) > 1:
        raise _wrong(path, f"it has the coordinate systems {', '.join(names[:4])}", "convert it")
    # A URN has the order of the authority, other names the traditional one.
    is_urn = names[0].lower().startswith(("urn:", "http://www.opengis.net/def/"))
    return systems[0], is_urn and bool(systems[0].is_in_degrees) and "CRS84" not in names[0]


def _points(path: Path, element: Element, dim: int, place: str) -> FloatArray:
    """Return the coordinates in an element, shape (n, 2)."""
    rows: list[list[float]] = []
    try:
        for part in element.iter():
            kind, text = tag_of(part), part.text or ""
            n = int(part.get("srsDimension", dim))
            if kind == "posList":
                numbers = [float(word) for word in text.split()]
                rows += [numbers[k : k + 2] for k in range(0, len(numbers), max(n, 2))]
            elif kind == "pos":
                rows.append([float(word) for word in text.split()][:2])
            elif kind == "coordinates":
                comma, blank = part.get("cs") or ",", part.get("ts") or " "
                tuples = text.split() if blank.isspace() else text.split(blank)
                rows += [[float(x) for x in t.split(comma)[:2]] for t in tuples if t.strip()]
        return np.array(rows, dtype=np.float64).reshape(-1, 2)
    except ValueError as error:
        raise _wrong(
            path, f"the coordinates of {place} cannot be read: {error}", "export it again"
        ) from error


def _turned(points: FloatArray, is_turned: bool) -> FloatArray:
    """Return points with x first."""
    return points[:, ::-1] if is_turned else points


def _wrong(path: Path, found: str, remedy: str) -> GeometryError:
    """Return the error for a file that is not read."""
    return GeometryError(found, where=str(path), expected=_EXPECTED, remedy=remedy)
