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

    coarsen: Literal["interior", "conforming"] | None = setting(
        "Also make a coarse mesh, with larger elements away from the boundary; boundary and "
        "topology stay. `interior`: blocks of 2, 4, 8, ... grid cells along each axis become one "
        "element, with hanging vertices between, which MFEM constrains. `conforming`: blocks of 3, "
        "9, 27, ... cells, without hanging vertices, for all formats.",
        default=None,
        otherwise="all grid cells are elements",
        option="coarsen",
    )
