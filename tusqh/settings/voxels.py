"""The meaning of an image's voxels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from tusqh.settings.field import setting
from tusqh.settings.section import Section
from tusqh.settings.validate import Path


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

    def find_contradictions(self) -> Iterator[tuple[Path, str, str]]:
        """Yield labels together with grey values, see `Section.find_contradictions`."""
        if self.labels is not None and (self.empty is not None or self.full is not None):
            yield (
                ("labels",),
                "`labels` with `empty` or `full`",
                "either labels or grey values",
            )
