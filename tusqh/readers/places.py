"""Coordinate systems of maps: what a file states, and how degrees are recognised."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from tusqh.geometry.units import unit_name
from tusqh.grid import FloatArray

#: Codes of EPSG for longitude and latitude in degrees.
_DEGREES = {4258, 4267, 4269, 4277, 4283, 4312, 4314, 4326, 4490, 4612, 4617, 4674, 4979, 6318}
_DEGREES |= {7844}
#: A box this large, in degrees, whose points have many decimals is not a drawing.
_LARGE = 20.0


@dataclass(frozen=True)
class CoordinateSystem:
    """A coordinate system, as a file states it.

    Parameters
    ----------
    text
        Its code or its definition, as pyproj understands it; empty if the file states none.
    name
        Its name, for messages.
    is_in_degrees
        Whether coordinates are longitude and latitude; None if that is not known.
    unit
        Unit of length of its coordinates; empty if it is not known.
    """

    text: str = ""
    name: str = ""
    is_in_degrees: bool | None = None
    unit: str = ""


#: The coordinate system of a file that states none.
NOT_STATED = CoordinateSystem()
#: Longitude and latitude, the only coordinates of KML, and the default of TopoJSON and GeoJSON.
WGS84 = CoordinateSystem("OGC:CRS84", "longitude and latitude, WGS 84", is_in_degrees=True)


def system_of_code(code: str) -> CoordinateSystem:
    """Return the coordinate system that a code or a URN names.

    Parameters
    ----------
    code
        Such as ``EPSG:26918`` or ``urn:ogc:def:crs:OGC:1.3:CRS84``.

    Examples
    --------
    >>> system_of_code("urn:ogc:def:crs:EPSG::4326").is_in_degrees
    True
    >>> system_of_code("http://www.opengis.net/gml/srs/epsg.xml#32618").unit
    'm'
    """
    if re.search(r"CRS84\b", code, re.IGNORECASE):
        return WGS84
    match = re.search(r"epsg[^\d]*(?:[\d.]+[:/])?(\d{4,6})\s*$", code, re.IGNORECASE)
    if match is None:
        return CoordinateSystem(code.strip(), code.strip()[:60])
    number, name = int(match[1]), f"EPSG:{match[1]}"
    if number in _DEGREES:
        return CoordinateSystem(name, name, is_in_degrees=True)
    is_utm = number // 100 in (269, 258, 326, 327)
    return CoordinateSystem(name, name, False if is_utm else None, "m" if is_utm else "")


def system_of_wkt(text: str) -> CoordinateSystem:
    """Return the coordinate system that well-known text defines, as in a ``.prj`` file.

    Parameters
    ----------
    text
        The text; blank if there is none.

    Examples
    --------
    >>> text = 'PROJCS["Lambert",GEOGCS["NAD83",UNIT["Degree",0.017]],UNIT["Foot_US",0.3048006]]'
    >>> found = system_of_wkt(text)
    >>> found.name, found.is_in_degrees, found.unit
    ('Lambert', False, 'us-ft')
    """
    match = re.match(r'\s*(\w+)\s*\[\s*"([^"]*)"', text)
    if match is None:
        return NOT_STATED
    kind, name = match[1].upper(), match[2]
    if kind in ("GEOGCS", "GEOGCRS", "GEODCRS", "GEODETICCRS", "GEOGRAPHICCRS"):
        return CoordinateSystem(text.strip(), name, is_in_degrees=True)
    found = re.findall(r'(?:LENGTH)?UNIT\s*\[\s*"([^"]*)"', text, re.IGNORECASE)
    return CoordinateSystem(text.strip(), name, False, unit_name(found[-1]) if found else "")


def are_in_range(points: FloatArray) -> bool:
    """Return whether points can be longitudes and latitudes in degrees.

    Parameters
    ----------
    points
        Shape (n, 2).
    """
    return bool((np.abs(points) <= (360.0, 90.0)).all())


def look_like_degrees(points: FloatArray) -> bool:
    """Return whether points of an unknown coordinate system are longitudes and latitudes.

    They are if all could be, and their box is farther from (0, 0) than it is wide, or it is wider
    than 20 and most points have four decimals or more.  Drawings in other units begin near (0, 0)
    or have their middle there.

    Parameters
    ----------
    points
        Finite, shape (n, 2).

    Examples
    --------
    >>> bay = np.array([[-76.12345, 38.1], [-75.2, 38.2], [-75.3, 37.5]])
    >>> look_like_degrees(bay), look_like_degrees(np.array([[0.0, 0], [4, 0], [4, 3]]))
    (True, False)
    """
    if not len(points) or not are_in_range(points) or np.abs(points[:, 0]).max() > 180:
        return False
    low, high = points.min(axis=0), points.max(axis=0)
    diagonal = float(np.linalg.norm(high - low))
    from_origin = float(np.linalg.norm(np.clip(0.0, low, high)))
    if from_origin > diagonal > 0:
        return True
    if from_origin < 0.01 * diagonal or np.linalg.norm(low + high) < 0.1 * diagonal:
        return False
    fine = 1e3 * points
    is_fine = (np.abs(fine - np.rint(fine)) > 1e-6).any(axis=1)
    return diagonal > _LARGE and len(points) > _LARGE and bool(is_fine.mean() > 0.5)


def crs_in_json(document: Any) -> CoordinateSystem:
    """Return the coordinate system in the member ``crs`` of a GeoJSON document.

    Parameters
    ----------
    document
        The document.
    """
    member = document.get("crs") if isinstance(document, dict) else None
    properties = member.get("properties") if isinstance(member, dict) else None
    name = properties.get("name", properties.get("href")) if isinstance(properties, dict) else None
    return system_of_code(name) if isinstance(name, str) else NOT_STATED
