"""The fitting of the boundary."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from tusqh.settings.field import setting
from tusqh.settings.section import Section


@dataclass(frozen=True)
class Fitting(Section):
    """Whether and how the boundary of the mesh is moved onto the geometry."""

    title: ClassVar[str] = "Boundary"

    fit: bool = setting(
        "Move the boundary of the mesh onto the geometry, with its corners in 2D; topology stays, "
        "and no element becomes invalid. Without it the boundary is a staircase of cells.",
        default=False,
    )
