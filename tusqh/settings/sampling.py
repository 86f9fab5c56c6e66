"""The sampling of volume fractions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from tusqh.settings.field import setting
from tusqh.settings.section import Section

Domain = Literal["inside", "outside"]
Rule = Literal["average", "clamped"]
Orientation = Literal["auto", "as-is", "flip"]
Sampler = Literal["crossings", "libigl"]


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
