"""A remark on what was left out, changed or noted when a geometry was read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from tusqh.errors import one_line


@dataclass(frozen=True)
class Remark:
    """Something a user must know about how a file was read.

    Parameters
    ----------
    effect
        "left out" if the geometry lacks something in the file, "changed" if the geometry has it in
        another form, "noted" if it is read unchanged but looks wrong.
    what
        The kind of thing, as a plural noun with its place where it has one: "text entities",
        "triangles without area", "rings of feature 7".
    count
        How many there are.
    remedy
        What the user can do about it; empty if nothing needs to be done.
    """

    effect: Literal["left out", "changed", "noted"]
    what: str
    count: int
    remedy: str = ""

    def __str__(self) -> str:
        """Return the remark as one line."""
        line = f"{self.effect}: {self.count:,} {one_line(self.what)}"
        return f"{line} ({self.remedy})" if self.remedy else line
