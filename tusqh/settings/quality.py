"""The conditions under which a mesh is suitable without a warning."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from tusqh.settings.field import setting
from tusqh.settings.section import Section


@dataclass(frozen=True)
class Quality(Section):
    """How much a mesh may differ from its geometry."""

    title: ClassVar[str] = "Quality"

    volume_tolerance: float = setting(
        "Largest relative difference between the volume of the mesh and that of the geometry "
        "without a warning; with `volume: match`, without an error.",
        default=0.05,
        above=0,
        at_most=1,
        metavar="X",
    )
