"""Read the polygons and lines of a TopoJSON file, whose features share arcs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.errors import GeometryError
from tusqh.grid import FloatArray
from tusqh.readers.places import crs_in_json
from tusqh.readers.polygons_of_maps import Map, reading_of_map
from tusqh.readers.project import to_plane
from tusqh.readers.reading import Reading

#: Deepest nesting of collections.
_DEEPEST = 50


def read(path: Path, *, crs: str | None = None) -> Reading:
    """Read every geometry of every object as a feature.

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
        The file is not TopoJSON, or an arc is missing.
    """
    document = json.loads(path.read_text(encoding="utf-8-sig"))
    if not isinstance(document, dict) or document.get("type") != "Topology":
        raise ValueError("it is not a topology")
    found = Map()
    try:
        arcs = _arcs(document)
        for name, item in document["objects"].items():
            _collect(item, arcs, found, f"object {name!r}", 0)
    except (KeyError, TypeError, IndexError, AttributeError) as error:
        raise GeometryError(
            f"the topology cannot be read: {type(error).__name__} {error}",
            where=str(path),
            expected="objects with arcs that the file has",
            remedy="export it again, or as GeoJSON",
        ) from error
    projected = to_plane(found, crs_in_json(document), crs, where=str(path))
    return reading_of_map(
        projected.map, name=path.name, unit=projected.unit, remarks=projected.remarks
    )


def _arcs(document: dict[str, Any]) -> list[FloatArray]:
    """Return the arcs, shape (n, 2) each."""
    arcs = [
        np.array([p[:2] for p in arc], dtype=np.float64).reshape(-1, 2) for arc in document["arcs"]
    ]
    transform = document.get("transform")
    if transform is None:
        return arcs
    scale, move = np.array(transform["scale"][:2]), np.array(transform["translate"][:2])
    return [np.cumsum(arc, axis=0) * scale + move for arc in arcs]


def _collect(
    item: dict[str, Any], arcs: list[FloatArray], found: Map, place: str, depth: int
) -> None:
    """Add a geometry to those found."""
    kind = item.get("type")
    if kind == "GeometryCollection":
        if depth > _DEEPEST:
            raise ValueError("its collections are nested too deeply")
        for number, inner in enumerate(item["geometries"]):
            _collect(inner, arcs, found, f"{place}, geometry {number}", depth + 1)
        return
    properties = item.get("properties")
    found.begin_feature(str(properties.get("name", "")) if isinstance(properties, dict) else "")
    if kind == "Polygon":
        found.add_polygon([_join(arcs, ring) for ring in item["arcs"]], place)
    elif kind == "MultiPolygon":
        for polygon in item["arcs"]:
            found.add_polygon([_join(arcs, ring) for ring in polygon], place)
    elif kind == "LineString":
        found.lines.append(_join(arcs, item["arcs"]))
    elif kind == "MultiLineString":
        found.lines += [_join(arcs, line) for line in item["arcs"]]
    elif kind in ("Point", "MultiPoint"):
        found.n_points += 1 if kind == "Point" else len(item["coordinates"])


def _join(arcs: list[FloatArray], numbers: list[int]) -> FloatArray:
    """Return arcs one after the other; -1 is arc 0 backwards, and so on."""
    pieces = [arcs[k] if k >= 0 else arcs[~k][::-1] for k in numbers]
    joined = [piece if k == 0 else piece[1:] for k, piece in enumerate(pieces)]
    return np.concatenate([np.empty((0, 2)), *joined])
