"""Read the rings and lines of a GeoJSON file.

Every ring or line is one chain.  Holes are turned against the outer ring of their polygon where
the file does not do so, because their place in the polygon says what they are (RFC 7946, 3.1.6).
Points and missing geometries have no lines and are skipped; a third coordinate is dropped.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray
from tusqh.readers.reading import Reading


def read(path: Path) -> Reading:
    """Read every ring and line, in file order.

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
        The file is not GeoJSON.
    GeometryError
        The outline is empty, without extent or not finite.
    """
    document = json.loads(path.read_text(encoding="utf-8-sig"))
    return Reading(Outline.from_chains(list(_lines_of(document)), name=path.name))


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
    """Yield the rings of a polygon, each hole turned against the outer ring, the first one."""
    rings = [_as_points(ring) for ring in polygon]
    areas = [_signed_area(ring) for ring in rings]
    for k, ring in enumerate(rings):
        yield ring[::-1] if k and areas[k] * areas[0] > 0 else ring


def _signed_area(ring: FloatArray) -> float:
    """Return the area inside a ring, negative if it is clockwise."""
    x, y = (ring - ring.mean(axis=0)).T if len(ring) else np.zeros((2, 0))
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def _as_points(positions: list[Any]) -> FloatArray:
    """Return a GeoJSON list of positions as points, shape (n, 2)."""
    if any(isinstance(number, str) for position in positions for number in position):
        raise ValueError("a coordinate is text, not a number")
    return np.array([position[:2] for position in positions], dtype=np.float64).reshape(-1, 2)
