"""The sampling of volume fractions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Literal

from tusqh.settings.field import setting
from tusqh.settings.length_text import FORM, is_length
from tusqh.settings.section import Section
from tusqh.settings.validate import Path

Domain = Literal["inside", "outside"]
Rule = Literal["average", "clamped"]
Orientation = Literal["auto", "as-is", "flip"]
Sampler = Literal["crossings", "libigl"]
Inside = Literal["winding", "envelope", "shell", "union"]


@dataclass(frozen=True)
class Sampling(Section):
    """The settings with which the volume fractions of a geometry are sampled on a grid."""

    title: ClassVar[str] = "Sampling"

    samples: int = setting(
        "Samples along each side of a cell, an even number: 4 gives 16 per cell in 2D and 64 in "
        "3D.",
        default=4,
        at_least=2,
        multiple_of=2,
        metavar="N",
        kinds=("outline", "surface"),
    )
    domain: Domain = setting(
        "Mesh what the geometry encloses (`inside`), or what it leaves out of the window "
        "(`outside`).",
        default="inside",
    )
    inside: Inside = setting(
        "What is inside: where the surface winds (`winding`); what a ball cannot reach from "
        "outside (`envelope`), for doubled sheets, gaps and inner clutter; what is near the "
        "surface (`shell`), for open sheets; or the shell with the solids, where the winding "
        "number is at least 1/2 (`union`).",
        default="winding",
        kinds=("outline", "surface"),
    )
    seal: float | str | None = setting(
        f"With `inside: envelope`, the diameter of the ball, {FORM}. Gaps narrower than it are "
        "closed.",
        default=None,
        otherwise="half a cell",
        above=0,
        metavar="LENGTH",
        kinds=("outline", "surface"),
    )
    thickness: float | str | None = setting(
        f"With `inside: shell` or `union`, the thickness of the shell, {FORM}; the surface is in "
        "its middle.",
        default=None,
        otherwise="one cell",
        above=0,
        metavar="LENGTH",
        kinds=("outline", "surface"),
    )
    rule: Rule = setting(
        "Average the raw winding numbers of a cell (`average`), or clip each sample to [0, 1] "
        "first (`clamped`), which suits parts that overlap.",
        default="average",
        kinds=("outline", "surface"),
    )
    orientation: Orientation = setting(
        "Turn parts that point inwards, and triangles that disagree with their part, then flip the "
        "sign of the winding number if its mean is negative (`auto`); leave everything (`as-is`); "
        "or flip the sign only (`flip`).",
        default="auto",
        kinds=("outline", "surface"),
    )
    sampler: Sampler = setting(
        "Count crossings on the lattice of samples (`crossings`, exact and fast), or evaluate "
        "libigl at every sample (`libigl`, for comparison).",
        default="crossings",
        kinds=("outline", "surface"),
    )
    tolerance: float = setting(
        "Largest error of a fraction before it is rounded to 2^-20, where the geometry is open; "
        "for the sampler `crossings`.",
        default=1e-6,
        at_least=1e-12,
        at_most=0.01,
        metavar="X",
        kinds=("outline", "surface"),
        needs={"sampler": "crossings"},
    )

    def find_contradictions(self) -> Iterator[tuple[Path, str, str]]:
        """Yield lengths that are none, and those that `inside` does not use."""
        uses = {"seal": ("envelope",), "thickness": ("shell", "union")}
        for name, kinds in uses.items():
            value = getattr(self, name)
            if value is None:
                continue
            if isinstance(value, str) and not is_length(value):
                yield (name,), f"found {value!r}", f"a positive length, {FORM}"
            elif self.inside not in kinds:
                needed = " or ".join(f"`inside: {kind}`" for kind in kinds)
                yield (
                    (name,),
                    f"found {value!r} with `inside: {self.inside}`",
                    f"{needed} beside it",
                )
