"""What a reader returns."""

from __future__ import annotations

from dataclasses import dataclass

from tusqh.geometry.kinds import Geometry


@dataclass(frozen=True)
class Reading:
    """The result of reading a file; an account of its content belongs here, beside the geometry.

    Parameters
    ----------
    geometry
        The geometry, exactly as the file gives it.
    """

    geometry: Geometry
