"""Units of length: their names, their sizes, and geometry in another unit."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry

AnyGeometry = TypeVar("AnyGeometry", bound=Geometry)

#: Metres in one unit of length.
METRES = {
    "pm": 1e-12,
    "nm": 1e-9,
    "um": 1e-6,
    "µm": 1e-6,
    "mm": 1e-3,
    "cm": 1e-2,
    "dm": 1e-1,
    "m": 1.0,
    "dam": 1e1,
    "hm": 1e2,
    "km": 1e3,
    "mil": 2.54e-5,
    "in": 0.0254,
    "ft": 0.3048,
    "us-ft": 1200 / 3937,
    "yd": 0.9144,
    "mi": 1609.344,
}

#: The unit that figures and simulations take if neither the file nor the user states one.
ASSUMED = "m"

#: What tables say instead of the name of a unit that is not known.
MODEL_UNITS = "model units"

# fmt: off
_NAMES = {
    "um": ("micron", "microns", "micrometre", "micrometer", "μm", "microm"),
    "mm": ("millimetre", "millimeter", "millimetres", "millimeters", "milli metre"),
    "cm": ("centimetre", "centimeter", "centimetres", "centimeters"),
    "dm": ("decimetre", "decimeter"),
    "m": ("metre", "meter", "metres", "meters"),
    "km": ("kilometre", "kilometer", "kilometres", "kilometers"),
    "nm": ("nanometre", "nanometer", "nanometres", "nanometers"),
    "in": ("inch", "inches", '"'),
    "ft": ("foot", "feet", "international foot"),
    "us-ft": ("us survey foot", "foot_us", "us_survey_foot", "ftus"),
    "yd": ("yard", "yards"),
    "mi": ("mile", "miles"),
    "mil": ("mils", "thou"),
}
# fmt: on
_CANONICAL = {name: unit for unit, names in _NAMES.items() for name in names} | {"µm": "um"}


def unit_name(text: str) -> str:
    """Return the usual name of a unit of length; an unknown unit keeps its own name.

    Parameters
    ----------
    text
        Name of a unit; empty if there is none.

    Examples
    --------
    >>> unit_name("Millimeters"), unit_name("inch"), unit_name("px"), unit_name("")
    ('mm', 'in', 'px', '')
    """
    name = text.strip()
    lower = name.lower()
    return _CANONICAL.get(lower, lower if lower in METRES else name)


def metres_in(unit: str) -> float | None:
    """Return the size of a unit of length in metres, None if it is not known.

    Parameters
    ----------
    unit
        Name of the unit.

    Examples
    --------
    >>> metres_in("inch"), metres_in("px")
    (0.0254, None)
    """
    return METRES.get(unit_name(unit))


def in_unit(text: str, unit: str) -> str:
    """Return the unit of a measure in "model units" with the name of the model's unit instead.

    Parameters
    ----------
    text
        A unit as the tables have it, such as "model units^2".
    unit
        The model's unit of length; empty if it is not known.

    Examples
    --------
    >>> in_unit("model units^2", "mm"), in_unit("model units", ""), in_unit("-", "mm")
    ('mm^2', 'model units', '-')
    """
    return text.replace(MODEL_UNITS, unit) if unit else text


def scaled(geometry: AnyGeometry, factor: float, *, unit: str) -> AnyGeometry:
    """Return a geometry with all lengths multiplied by a factor, and with the name of its unit.

    Parameters
    ----------
    geometry
        The geometry.
    factor
        The factor.
    unit
        Unit of length of the result; empty if it is not known.

    Examples
    --------
    >>> import numpy as np
    >>> image = scaled(Image(np.ones((1, 1, 2)), 2.0), 0.001, unit="m")
    >>> image.bounding_box(), image.unit
    (((0.0, 0.0, 0.0), (0.002, 0.002, 0.004)), 'm')
    """
    if factor == 1.0:
        return replace(geometry, unit=unit)
    if isinstance(geometry, Image):
        origin = tuple(factor * o for o in geometry.origin)
        size = factor * geometry.voxel_size
        return replace(geometry, voxel_size=size, origin=origin, unit=unit)
    return replace(geometry, points=geometry.points * factor, unit=unit)
