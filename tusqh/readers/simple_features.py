"""Add geometries of shapely, as WKT and WKB describe them, to a map."""

from __future__ import annotations

from typing import Any

import shapely

from tusqh.readers.polygons_of_maps import Map

#: Deepest nesting of collections.
_DEEPEST = 50


def add_geometry(found: Map, geometry: Any, place: str, depth: int = 0) -> None:
    """Add the rings, lines and points of a geometry to a map.

    Parameters
    ----------
    found
        The map.
    geometry
        A geometry of shapely; a third coordinate is dropped.
    place
        Where it is in the file.
    depth
        How many collections it is in.

    Raises
    ------
    ValueError
        Collections are nested too deeply, or the type is unknown.
    """
    kind = geometry.geom_type
    if geometry.is_empty:
        return
    if kind == "Polygon":
        rings = [geometry.exterior, *geometry.interiors]
        found.add_polygon([shapely.get_coordinates(ring) for ring in rings], place)
    elif kind in ("LineString", "LinearRing"):
        found.lines.append(shapely.get_coordinates(geometry))
    elif kind == "Point":
        found.n_points += 1
    elif kind.startswith("Multi") or kind == "GeometryCollection":
        if depth > _DEEPEST:
            raise ValueError("its collections are nested too deeply")
        for number, part in enumerate(geometry.geoms):
            add_geometry(found, part, f"{place}, part {number}", depth + 1)
    else:
        raise ValueError(f"geometries of type {kind} are not outlines")
