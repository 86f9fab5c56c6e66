"""The meaning of an image's voxels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Literal

from tusqh.settings.field import setting
from tusqh.settings.section import Section
from tusqh.settings.validate import Path

VoxelOrder = Literal["xyz", "xzy", "yxz", "yzx", "zxy", "zyx"]


@dataclass(frozen=True)
class Voxels(Section):
    """The size and the values of an image's voxels, which are cubes."""

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
        otherwise="1; for integers, the largest value in the image",
        metavar="GREY",
    )
    labels: tuple[int, ...] | None = setting(
        "Labels of the material in an image of labels; all other voxels are empty.",
        default=None,
        otherwise="all but 0, where the values are labels",
        metavar="N,...",
    )
    channel: int | None = setting(
        "Number, from 0, of the channel, colour or time to read, in an image that has several.",
        default=None,
        otherwise="none: an image that has several is rejected",
        at_least=0,
        metavar="N",
    )
    voxels: tuple[int, int, int] | None = setting(
        "Number of voxels along x, y and z, for a file that does not state it (SPN).",
        default=None,
        otherwise="what the file says",
        at_least=1,
        n_items=(3, 3),
        metavar="N,N,N",
    )
    voxel_order: VoxelOrder | None = setting(
        "Order of the voxels in such a file: the index along the first axis changes slowest. The "
        "option `spn_xyz_order` of Sculpt numbers these orders from 0 to 5.",
        default=None,
        otherwise="xyz",
    )

    def find_contradictions(self) -> Iterator[tuple[Path, str, str]]:
        """Yield labels together with grey values, see `Section.find_contradictions`."""
        if self.labels is not None and (self.empty is not None or self.full is not None):
            yield (
                ("labels",),
                "`labels` with `empty` or `full`",
                "either labels or grey values",
            )
