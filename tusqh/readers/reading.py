"""The result of a reader: the geometry, and remarks on how the file was read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from tusqh.geometry.kinds import Geometry
from tusqh.geometry.remark import Remark

#: Where the unit of length of a reading comes from.
UnitSource = Literal["file", "format", "settings", "none"]


@dataclass(frozen=True)
class Reading:
    """The result of reading a file.

    Parameters
    ----------
    geometry
        The geometry, without any repair.
    remarks
        Remarks on what was left out, changed or noted, in the order of the file.
    unit
        Unit of length of the geometry; empty if it is not known.
    unit_source
        Source of the unit: "file", "format", "settings" or, if there is no unit, "none".
    format
        Name of the format, see `tusqh.readers.formats.FORMATS`.
    """

    geometry: Geometry
    remarks: tuple[Remark, ...] = ()
    unit: str = ""
    unit_source: UnitSource = "none"
    format: str = "memory"
