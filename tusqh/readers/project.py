"""Project the longitudes and latitudes of a map to lengths in the plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from tusqh.errors import GeometryError
from tusqh.extras import require
from tusqh.geometry.remark import Remark
from tusqh.geometry.units import unit_name
from tusqh.grid import FloatArray
from tusqh.readers.places import (
    WGS84,
    CoordinateSystem,
    are_in_range,
    look_like_degrees,
    system_of_code,
)
from tusqh.readers.polygons_of_maps import Map

#: Longitudes this close to the date line are on it, in degrees.
_CLOSE = 1e-9
#: Degrees of longitude beyond which a zone of UTM distorts lengths by more than 1 %.
_WIDE = 12.0


@dataclass(frozen=True)
class Projected:
    """A map in the plane.

    Parameters
    ----------
    map
        The map, with its coordinates in lengths.
    unit
        Their unit; empty if it is not known.
    remarks
        What was done.
    """

    map: Map
    unit: str = ""
    remarks: tuple[Remark, ...] = ()


def to_plane(found: Map, stated: CoordinateSystem, crs: str | None, *, where: str) -> Projected:
    """Return a map in the plane, projected if the settings say so.

    Parameters
    ----------
    found
        The map, as in the file.
    stated
        The coordinate system that the file states.
    crs
        The setting: ``utm``, a code of EPSG, ``none`` for coordinates that are lengths, or None.
    where
        The file, for messages.

    Raises
    ------
    GeometryError
        Coordinates are degrees and `crs` is not given, or a coordinate system does not fit them.
    MissingExtraError
        pyproj is needed and not installed.
    """
    chains = [*found.rings, *found.lines]
    points = np.concatenate(chains) if chains else np.empty((0, 2))
    if crs == "none" or not len(points) or not np.isfinite(points).all():
        return Projected(found, "" if stated.is_in_degrees else stated.unit)
    if stated.is_in_degrees is None and stated.text:
        stated = _looked_up(stated, where)
    is_degrees = stated.is_in_degrees
    if is_degrees and not are_in_range(points):
        raise _misfit(stated, points, where, "between -180 and 180, -90 and 90")
    if is_degrees is False and look_like_degrees(points):
        raise _misfit(stated, points, where, f"lengths in {stated.unit or 'some unit'}")
    if is_degrees is None:
        is_degrees = look_like_degrees(points) or (crs is not None and are_in_range(points))
    if crs is None:
        if is_degrees:
            raise _degrees(stated, points, where)
        return Projected(found, stated.unit)
    if not is_degrees and not stated.text:
        raise GeometryError(
            f"`crs` is {crs}, and the file states no coordinate system; {_extent(points)}",
            where=where,
            expected="longitudes and latitudes in degrees, or a file that states its system",
            remedy="add its .prj file or its member `crs`, or remove `crs` if these are lengths",
        )
    return _project(found, stated if stated.text else WGS84, crs, points, where=where)


def _project(
    found: Map, source: CoordinateSystem, crs: str, points: FloatArray, *, where: str
) -> Projected:
    """Return a map projected from one coordinate system to another."""
    pyproj = require("pyproj", extra="maps")
    to_degrees = _transformer(pyproj, source.text, "OGC:CRS84", where)
    lon, lat = to_degrees.transform(points[:, 0], points[:, 1])
    centre = _middle_of_longitudes(np.asarray(lon)), float(np.median(lat))
    target = _target(pyproj, crs, centre, where)
    change = _transformer(pyproj, source.text, target, where)
    n_cut = 0
    if source.is_in_degrees and _is_torn(change, centre[1]):
        found, n_cut = _cut_at_date_line(found, where)

    def moved(chain: FloatArray) -> FloatArray:
        x, y = change.transform(chain[:, 0], chain[:, 1])
        return np.column_stack([x, y])

    rings, lines = [moved(c) for c in found.rings], [moved(c) for c in found.lines]
    everything = np.concatenate([*rings, *lines])
    if not np.isfinite(everything).all():
        n_bad = int((~np.isfinite(everything)).any(axis=1).sum())
        raise GeometryError(
            f"{n_bad:,} points have no place in {target.name}",
            where=where,
            expected="a coordinate system that covers the geometry",
            remedy="give another `crs`, such as utm",
        )
    remarks = [Remark("changed", f"coordinates projected from {source.name} to {_code(target)}", 1)]
    if n_cut:
        remarks.append(Remark("changed", "rings and lines cut at the date line", n_cut))
    width = float(np.ptp(np.unwrap(np.sort(lon), period=360.0))) if len(lon) else 0.0
    if crs == "utm" and width > _WIDE:
        what = f"degrees of longitude in one zone of UTM ({width:.0f}), which distorts lengths"
        remedy = "give the code of a coordinate system for the whole region"
        remarks.append(Remark("noted", what, round(width), remedy))
    found.rings[:], found.lines[:] = rings, lines
    return Projected(found, unit_name(str(target.axis_info[0].unit_name)), tuple(remarks))


def _target(pyproj: Any, crs: str, centre: tuple[float, float], where: str) -> Any:
    """Return the coordinate system that the settings ask for, after checking that it fits."""
    lon, lat = centre
    if crs.lower() == "utm":
        if not -80 <= lat <= 84:
            raise GeometryError(
                f"the geometry is around latitude {lat:.1f}, where there is no zone of UTM",
                where=where,
                expected="latitudes from -80 to 84",
                remedy="give `crs: EPSG:3413` in the north or `crs: EPSG:3031` in the south",
            )
        return pyproj.CRS.from_epsg((32600 if lat >= 0 else 32700) + zone_of(lon))
    try:
        target = pyproj.CRS.from_user_input(crs)
    except pyproj.exceptions.CRSError:
        raise GeometryError(
            f"`crs` is {crs[:60]!r}",
            where=where,
            expected="utm, none, or a code such as EPSG:32618",
            remedy="correct it",
        ) from None
    if not target.is_projected:
        raise GeometryError(
            f"`crs` is {_code(target)}, whose coordinates are not lengths",
            where=where,
            expected="a projected coordinate system",
            remedy="give utm, or the code of a projected system, such as EPSG:32618",
        )
    area = target.area_of_use
    if area is not None and not _covers(area, lon, lat):
        raise GeometryError(
            f"`crs` is {_code(target)}, for longitudes from {area.west:g} to {area.east:g} and "
            f"latitudes from {area.south:g} to {area.north:g}, and the geometry is around "
            f"longitude {lon:.4g}, latitude {lat:.4g}",
            where=where,
            expected="a coordinate system for that place",
            remedy="give `crs: utm`, which finds the zone",
        )
    return target


def zone_of(longitude: float) -> int:
    """Return the number of the zone of UTM at a longitude.

    Parameters
    ----------
    longitude
        In degrees.

    Examples
    --------
    >>> zone_of(-76.0), zone_of(0.0), zone_of(180.0)
    (18, 31, 1)
    """
    return int((longitude + 180.0) // 6) % 60 + 1


def _covers(area: Any, lon: float, lat: float) -> bool:
    """Return whether an area of use holds a place, within a degree or a zone's width beside it."""
    east = area.east + (360.0 if area.east < area.west else 0.0)
    span = east - area.west + 12.0
    return bool(area.south - 1 <= lat <= area.north + 1 and (lon - area.west + 6.0) % 360.0 <= span)


def _is_torn(change: Any, lat: float) -> bool:
    """Return whether a projection maps the two sides of the date line to different places."""
    x, y = change.transform([-180.0 + _CLOSE, 180.0 - _CLOSE], [lat, lat])
    distance = float(np.hypot(x[1] - x[0], y[1] - y[0]))
    return not distance < 1.0


def _cut_at_date_line(found: Map, where: str) -> tuple[Map, int]:
    """Return a map whose rings and lines end at the date line, and how many were cut."""
    cut, n_cut = Map(n_points=found.n_points, features=list(found.features)), 0
    first_of: list[int] = []
    for k, ring in enumerate(found.rings):
        pieces = _pieces(ring, where, is_ring=True)
        n_cut += len(pieces) > 1
        first_of.append(len(cut.rings))
        for piece in pieces:
            is_outer = found.outer[k] == k
            cut.outer.append(len(cut.rings) if is_outer else _owner(cut, first_of, found, k, piece))
            cut.rings.append(piece)
            cut.sides.append(found.sides[k])
            cut.places.append(found.places[k])
            cut.feature_of.append(found.feature_of[k])
    for line in found.lines:
        pieces = _pieces(line, where, is_ring=False)
        n_cut += len(pieces) > 1
        cut.lines += pieces
    return cut, n_cut


def _owner(cut: Map, first_of: list[int], found: Map, k: int, piece: FloatArray) -> int:
    """Return the piece of a hole's outer ring that the piece of the hole lies in."""
    first = first_of[found.outer[k]]
    last = first_of[found.outer[k] + 1] if found.outer[k] + 1 < len(first_of) else len(cut.rings)
    hole = shapely.Polygon(piece)
    inside = [j for j in range(first, last) if shapely.Polygon(cut.rings[j]).intersects(hole)]
    return inside[0] if inside else first


def _pieces(chain: FloatArray, where: str, *, is_ring: bool) -> list[FloatArray]:
    """Return a chain of longitudes and latitudes, or its pieces if it crosses the date line."""
    if len(chain) < 2 or not (np.abs(np.diff(chain[:, 0])) > 180.0).any():
        return [chain]
    whole = np.column_stack([np.unwrap(chain[:, 0], period=360.0), chain[:, 1]])
    if is_ring and abs(whole[-1, 0] - whole[0, 0]) > 180.0:
        raise GeometryError(
            "a ring goes around a pole",
            where=where,
            expected="rings that a map can show whole",
            remedy="give a polar coordinate system: `crs: EPSG:3413` in the north, EPSG:3031 in "
            "the south",
        )
    shape = shapely.Polygon(whole) if is_ring else shapely.LineString(whole)
    shape = shape if not is_ring or shape.is_valid else shapely.make_valid(shape)
    pieces = []
    first = int(np.floor((whole[:, 0].min() + 180) / 360))
    for turn in range(first, first + 3):
        strip = shapely.box(360.0 * turn - 180.0, -91.0, 360.0 * turn + 180.0, 91.0)
        for part in shapely.get_parts(shapely.intersection(shape, strip)):
            if part.geom_type == ("Polygon" if is_ring else "LineString"):
                line = part.exterior if is_ring else part
                pieces.append(shapely.get_coordinates(line) - [360.0 * turn, 0.0])
    return pieces or [chain]


def _middle_of_longitudes(lon: FloatArray) -> float:
    """Return the middle of the shortest interval that holds all longitudes, from -180 to 180."""
    ordered = np.sort(lon % 360.0)
    gaps = np.diff(np.append(ordered, ordered[0] + 360.0))
    k = int(np.argmax(gaps))
    middle = ordered[k] + gaps[k] / 2 + 180.0
    return float((middle + 180.0) % 360.0 - 180.0)


def _looked_up(stated: CoordinateSystem, where: str) -> CoordinateSystem:
    """Return a coordinate system with what pyproj knows of it."""
    pyproj = require("pyproj", extra="maps")
    try:
        known = pyproj.CRS.from_user_input(stated.text)
    except pyproj.exceptions.CRSError:
        raise GeometryError(
            f"the file states the coordinate system {stated.name!r}, which is not known",
            where=where,
            expected="a code of EPSG",
            remedy="give `crs: none` if its coordinates are lengths, or project it before",
        ) from None
    is_degrees = bool(known.is_geographic)
    unit = "" if is_degrees else unit_name(str(known.axis_info[0].unit_name))
    return CoordinateSystem(stated.text, stated.name, is_degrees, unit)


def _transformer(pyproj: Any, source: Any, target: Any, where: str) -> Any:
    """Return the transformation between two coordinate systems."""
    try:
        return pyproj.Transformer.from_crs(source, target, always_xy=True)
    except (pyproj.exceptions.CRSError, pyproj.exceptions.ProjError) as error:
        raise GeometryError(
            f"its coordinate system cannot be used: {str(error).splitlines()[0][:120]}",
            where=where,
            expected="a coordinate system that PROJ knows",
            remedy="project it before, and give `crs: none`",
        ) from error


def _code(system: Any) -> str:
    """Return the code and the name of a coordinate system."""
    number = system.to_epsg()
    return f"EPSG:{number} ({system.name})" if number else str(system.name)


def _extent(points: FloatArray) -> str:
    """Return the box of points as text."""
    low, high = points.min(axis=0), points.max(axis=0)
    return f"its coordinates go from ({low[0]:g}, {low[1]:g}) to ({high[0]:g}, {high[1]:g})"


def _misfit(
    stated: CoordinateSystem, points: FloatArray, where: str, expected: str
) -> GeometryError:
    """Return the error for coordinates that do not fit the system that the file states."""
    return GeometryError(
        f"the file states the coordinate system {stated.name}, and {_extent(points)}",
        where=where,
        expected=f"coordinates {expected}",
        remedy="correct its .prj file or its member `crs`, or give `crs: none` if they are lengths",
    )


def _degrees(stated: CoordinateSystem, points: FloatArray, where: str) -> GeometryError:
    """Return the error for longitudes and latitudes without a projection."""
    lon, lat = _middle_of_longitudes(points[:, 0]), float(np.median(points[:, 1]))
    letter = "N" if lat >= 0 else "S"
    zone = zone_of(lon)
    code = system_of_code(f"EPSG:{(32600 if lat >= 0 else 32700) + zone}").name
    reason = f"the file states {stated.name}" if stated.text else "they look like degrees"
    return GeometryError(
        f"its coordinates are longitudes and latitudes: {reason}; {_extent(points)}",
        where=where,
        expected="lengths in the plane",
        remedy=f"give `crs: utm` (--crs utm), here zone {zone}{letter}, {code}, or the code of "
        "another projected system; or `crs: none` if they are lengths",
    )
