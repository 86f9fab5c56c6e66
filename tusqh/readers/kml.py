"""Read the polygons and lines of a KML file, in longitude and latitude."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from tusqh.errors import GeometryError
from tusqh.grid import FloatArray
from tusqh.readers.places import WGS84
from tusqh.readers.polygons_of_maps import Map, reading_of_map
from tusqh.readers.project import to_plane
from tusqh.readers.reading import Reading
from tusqh.readers.xml_names import tag_of


def read(path: Path, *, crs: str | None = None) -> Reading:
    """Read every placemark as a feature.

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
        Coordinates cannot be read, or `crs` is missing.
    """
    root = ElementTree.parse(path).getroot()
    if tag_of(root) != "kml":
        raise ValueError(f"the root element is <{tag_of(root)}>, not <kml>")
    found = Map()
    for number, placemark in enumerate(e for e in root.iter() if tag_of(e) == "Placemark"):
        found.begin_feature(next((e.text or "" for e in placemark if tag_of(e) == "name"), ""))
        for element in placemark.iter():
            _add(element, found, path, f"placemark {number}")
    projected = to_plane(found, WGS84, crs, where=str(path))
    return reading_of_map(
        projected.map, name=path.name, unit=projected.unit, remarks=projected.remarks
    )


def _add(element: Element, found: Map, path: Path, place: str) -> None:
    """Add a polygon, line or point."""
    kind = tag_of(element)
    if kind == "Polygon":
        rings = []
        for side in ("outerBoundaryIs", "innerBoundaryIs"):
            for boundary in (e for e in element if tag_of(e) == side):
                rings += [
                    _points(e, path, place) for e in boundary.iter() if tag_of(e) == "LinearRing"
                ]
        if rings:
            found.add_polygon(rings, place)
    elif kind == "LineString":
        found.lines.append(_points(element, path, place))
    elif kind == "Point":
        found.n_points += 1


def _points(element: Element, path: Path, place: str) -> FloatArray:
    """Return the coordinates of a ring or line, shape (n, 2)."""
    texts = [e.text or "" for e in element.iter() if tag_of(e) == "coordinates"]
    try:
        rows = [list(map(float, word.split(",")[:2])) for text in texts for word in text.split()]
        return np.array(rows, dtype=np.float64).reshape(-1, 2)
    except ValueError as error:
        raise GeometryError(
            f"the coordinates of {place} cannot be read: {error}",
            where=str(path),
            expected="longitude,latitude and perhaps a height, with blanks between points",
            remedy="export the file again",
        ) from error
