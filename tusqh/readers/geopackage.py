"""Read the polygons and lines of a GeoPackage, with its coordinate system."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path
from urllib.parse import quote

import shapely

from tusqh.errors import GeometryError
from tusqh.readers.places import NOT_STATED, CoordinateSystem, system_of_code, system_of_wkt
from tusqh.readers.polygon_faces import damaged
from tusqh.readers.polygons_of_maps import Map, reading_of_map
from tusqh.readers.project import to_plane
from tusqh.readers.reading import Reading
from tusqh.readers.simple_features import add_geometry

_EXPECTED = "a complete GeoPackage"
#: Numbers in the box of a geometry's header, by its code.
_BOXES = {0: 0, 1: 4, 2: 6, 3: 6, 4: 8}


def read(path: Path, *, crs: str | None = None) -> Reading:
    """Read the features of the only layer that has geometries.

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
        The file is damaged, or has no layer or several.
    """
    address = f"file:{quote(str(path.resolve()))}?mode=ro&immutable=1"
    found, system = Map(), NOT_STATED
    try:
        with closing(sqlite3.connect(address, uri=True)) as base:
            layers = base.execute(
                "SELECT table_name, column_name, srs_id FROM gpkg_geometry_columns ORDER BY 1"
            ).fetchall()
            if len(layers) != 1:
                raise _layers(path, [str(name) for name, _, _ in layers])
            table, column, number = layers[0]
            system = _system(base, number)
            table, column = (str(name).replace('"', '""') for name in (table, column))
            rows = base.execute(f'SELECT "{column}" FROM "{table}" ORDER BY rowid')
            for k, (blob,) in enumerate(rows):
                found.begin_feature("")
                if blob is not None:
                    add_geometry(found, shapely.from_wkb(_wkb(path, k, blob)), f"feature {k}")
    except (sqlite3.Error, shapely.errors.GEOSException, MemoryError) as error:
        raise damaged(path, str(error)[:120], expected=_EXPECTED) from error
    projected = to_plane(found, system, crs, where=str(path))
    return reading_of_map(
        projected.map, name=path.name, unit=projected.unit, remarks=projected.remarks
    )


def _system(base: sqlite3.Connection, number: int) -> CoordinateSystem:
    """Return the coordinate system of a layer."""
    row = base.execute(
        "SELECT organization, organization_coordsys_id, definition FROM gpkg_spatial_ref_sys "
        "WHERE srs_id = ?",
        (number,),
    ).fetchone()
    if row is None or number in (-1, 0):
        return NOT_STATED
    organization, code, definition = map(str, row)
    stated = system_of_wkt(definition)
    return stated if stated.text else system_of_code(f"{organization}:{code}")


def _wkb(path: Path, number: int, blob: bytes) -> bytes:
    """Return the well-known binary in a geometry of a GeoPackage."""
    if not isinstance(blob, bytes) or len(blob) < 8 or blob[:2] != b"GP":
        raise damaged(path, f"feature {number} is not a geometry", expected=_EXPECTED)
    box = _BOXES.get(blob[3] >> 1 & 7)
    if box is None or len(blob) < 8 + 8 * box:
        raise damaged(path, f"feature {number} is cut off", expected=_EXPECTED)
    return blob[8 + 8 * box :]


def _layers(path: Path, names: list[str]) -> GeometryError:
    """Return the error for a file without a single layer."""
    shown = ", ".join(names[:10]) or "none"
    return GeometryError(
        f"it has {len(names)} layers with geometries: {shown}",
        where=str(path),
        expected="one layer",
        remedy="export the layer alone, as GeoPackage or GeoJSON",
    )
