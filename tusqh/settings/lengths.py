"""The unit of length of a geometry, and what its numbers are multiplied by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from tusqh.settings.field import setting
from tusqh.settings.section import Section


@dataclass(frozen=True)
class Lengths(Section):
    """The unit of the numbers in a file, and the unit of everything that is made of it."""

    title: ClassVar[str] = "Units"

    unit: str | None = setting(
        "Unit of length of the numbers in the file (`nm`, `um`, `mm`, `cm`, `dm`, `m`, `km`, `in`, "
        "`ft`, or another name); a file that states another one is rejected.",
        default=None,
        otherwise="what the file or its format states; without any, figures and the simulation "
        "take `m`",
        metavar="NAME",
    )
    scale: float = setting(
        "Factor by which all lengths in the file are multiplied, for instance because they are "
        "not in the unit that it states.",
        default=1.0,
        above=0,
        metavar="X",
    )
    convert_to: str | None = setting(
        "Unit of length into which the geometry is converted, and in which the mesh and all "
        "other results are.",
        default=None,
        otherwise="the unit of the file",
        metavar="NAME",
    )
    crs: str | None = setting(
        "Coordinate system into which a map is projected: `utm` for the zone of UTM that it is "
        "in, or a code such as `EPSG:32618`; `none` if its coordinates are lengths.",
        default=None,
        otherwise="that of the file; longitudes and latitudes in degrees are rejected",
        kinds=("outline",),
        metavar="CODE",
    )
