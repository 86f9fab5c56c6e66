"""The result of a reader: the geometry, and remarks about how the file was read."""

from __future__ import annotations

from dataclasses import dataclass

from tusqh.geometry.kinds import Geometry
from tusqh.geometry.remark import Remark


@dataclass(frozen=True)
class Reading:
    """The result of reading a file.

    Parameters
    ----------
    geometry
        The geometry, without any repair.
    remarks
        What was left out, changed or noted, in the order of the file.
    """

    geometry: Geometry
    remarks: tuple[Remark, ...] = ()
