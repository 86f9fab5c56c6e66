"""The contents of a voxel image, as rows of the table of defects."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from tusqh.geometry.defect import AREA, VOLUME, Defect, defect
from tusqh.geometry.image import Image
from tusqh.grid import FloatArray

Found = tuple[int, float]


class VoxelFacts:
    """Fractions and volume of the voxels of an image.

    Parameters
    ----------
    image
        The image.
    """

    def __init__(self, image: Image) -> None:
        self.image = image
        #: Volume of a voxel, or area of a pixel, in powers of the model unit.
        self.volume = image.voxel_size**image.dim

    @cached_property
    def fractions(self) -> FloatArray:
        """Volume fractions of the voxels, shape of the image."""
        return self.image.fractions()


@defect(VOLUME, "all voxels; their volume")
def _voxels(facts: VoxelFacts) -> Found:
    """Count all voxels."""
    return facts.fractions.size, facts.fractions.size * facts.volume


@defect(VOLUME, "voxels at least half full; the sum of all fractions, as a volume")
def _material_voxels(facts: VoxelFacts) -> Found:
    """Count voxels of material."""
    return int((facts.fractions >= 0.5).sum()), float(facts.fractions.sum()) * facts.volume


@defect(VOLUME, "voxels neither empty nor full; the sum of their fractions, as a volume")
def _partial_voxels(facts: VoxelFacts) -> Found:
    """Count voxels between empty and full."""
    is_partial = (facts.fractions > 0) & (facts.fractions < 1)
    return int(is_partial.sum()), float(facts.fractions[is_partial].sum()) * facts.volume


@defect("grey values", "voxels beyond `empty` and `full`; by how much at most")
def _clipped_voxels(facts: VoxelFacts) -> Found:
    """Count voxels whose grey value is clipped."""
    low, high = sorted((facts.image.empty, facts.image.full))
    grey = facts.image.voxels.astype(np.float64)
    excess = np.maximum(low - grey, grey - high)
    return int((excess > 0).sum()), max(float(excess.max()), 0.0)


#: All rows of an image, in the order of the table.
VOXEL_COUNTS = (_voxels, _material_voxels, _partial_voxels, _clipped_voxels)


def _of_picture(row: Defect[VoxelFacts]) -> Defect[VoxelFacts]:
    """Return a row with the words and the unit for pixels."""
    words = row.explanation.replace("voxels", "pixels").replace("volume", "area")
    return replace(row, unit=AREA if row.unit == VOLUME else row.unit, explanation=words)


#: All rows of a picture.
PIXEL_COUNTS = tuple(_of_picture(row) for row in VOXEL_COUNTS)
