"""What the voxels of an image mean."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from tusqh.settings.field import setting
from tusqh.settings.section import Section


@dataclass(frozen=True)
class Voxels(Section):
    """The size and the grey values of an image's voxels, which are cubes."""

    title: ClassVar[str] = "Images"

    voxel_size: float | None = setting(
        "Edge length of a voxel.",
        default=None,
        otherwise="what the file says, or 1",
        unit="units of the model",
        above=0,
        metavar="H",
    )
    empty: float | None = setting(
        "Grey value of a voxel without material. Where it is above `full`, dark voxels are the "
        "material.",
        default=None,
        otherwise="0",
        metavar="GREY",
    )
    full: float | None = setting(
        "Grey value of a voxel full of material. Between `empty` and `full` the fraction is "
        "linear; beyond them it is clipped to [0, 1].",
        default=None,
        otherwise="1; for integers, the largest value of their type",
        metavar="GREY",
    )
