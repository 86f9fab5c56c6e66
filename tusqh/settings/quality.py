"""The conditions under which a mesh is suitable without a warning."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from tusqh.settings.field import setting
from tusqh.settings.section import Section

#: Elements of the largest mesh that other programs check unless they are asked to.
MOST_ELEMENTS = 50_000


@dataclass(frozen=True)
class Quality(Section):
    """How much a mesh may differ from its geometry, and what is checked."""

    title: ClassVar[str] = "Quality"

    volume_tolerance: float = setting(
        "Largest relative difference between the volume of the mesh and that of the geometry "
        "without a warning; with `volume: match`, without an error.",
        default=0.05,
        above=0,
        at_most=1,
        metavar="X",
    )
    checks: Literal["all"] | None = setting(
        "`all` lets VTK, MFEM and pymeshlab check meshes of any size; without it they check "
        f"meshes of up to {MOST_ELEMENTS:,} elements. Tusqh's own checks always run.",
        default=None,
    )
