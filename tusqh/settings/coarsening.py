"""The coarsening of the inside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from tusqh.settings.field import setting
from tusqh.settings.section import Section


@dataclass(frozen=True)
class Coarsening(Section):
    """Whether elements away from the boundary are coarser."""

    title: ClassVar[str] = "Inside"

    coarsen: Literal["interior"] | None = setting(
        "`interior` also makes a coarse mesh: blocks of 2, 4, 8, ... grid cells along each axis, "
        "away from the boundary, become one element. Boundary and topology stay; hanging vertices "
        "lie between elements of different size, which MFEM constrains.",
        default=None,
        otherwise="all grid cells are elements",
        option="coarsen",
    )
