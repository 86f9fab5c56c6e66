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
        "Number of slabs in which a large mesh of a surface is made, with less memory and the same "
        "result; `auto` takes the smallest number that fits. The threshold must be given or is "
        "1/2. In the workflow, each slab is a job of its own.",
        default=None,
        otherwise="in one piece",
        at_least=1,
        metavar="N",
    )
