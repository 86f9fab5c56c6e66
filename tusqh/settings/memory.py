"""How a mesh that does not fit into memory is made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from tusqh.settings.field import setting
from tusqh.settings.section import Section


@dataclass(frozen=True)
class Memory(Section):
    """Whether a large mesh is made in slabs."""

    title: ClassVar[str] = "Memory"

    slabs: int | Literal["auto"] | None = setting(
        "Make a large mesh of a surface in so many slabs, which need less memory and give the same "
        "mesh; `auto` takes as many as fit. The threshold must be given or is 1/2. The workflow "
        "has no slabs.",
        default=None,
        otherwise="in one piece",
        at_least=1,
        metavar="N",
    )
