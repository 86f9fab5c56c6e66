"""The image of voxels that a file holds, and the options that say what they mean."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tusqh.errors import GeometryError
from tusqh.geometry.image import Image
from tusqh.readers.reading import Reading

#: Voxels whose side lengths differ by at most this, relatively, count as cubes.
_CUBIC = 1e-6


def image_of(
    path: Path,
    voxels: NDArray[Any],
    *,
    size_in_file: Sequence[float] = (1.0, 1.0, 1.0),
    voxel_size: float | None = None,
    empty: float | None = None,
    full: float | None = None,
) -> Reading:
    """Return voxels as an image named after their file.

    Parameters
    ----------
    path
        The file, for messages.
    voxels
        Grey values, shape (nx, ny, nz).
    size_in_file
        Side lengths of a voxel as the file gives them, 1 where it gives none.
    voxel_size
        Edge length of a voxel, in the model's unit, instead of the file's.
    empty, full
        Grey values of fraction 0 and 1, see `tusqh.geometry.image.Image.from_voxels`.

    Raises
    ------
    GeometryError
        The voxels are not cubes, or the array is not an image.
    """
    sides = list(size_in_file)
    if voxel_size is None and not np.ptp(sides) <= _CUBIC * max(sides):
        raise GeometryError(
            f"a voxel measures {' x '.join(f'{s:g}' for s in sides)}",
            where=str(path),
            expected="cubic voxels",
            remedy="resample the image to cubes, or give `voxel_size` if the header is wrong",
        )
    return Reading(
        Image.from_voxels(
            voxels, voxel_size=voxel_size or sides[0], empty=empty, full=full, name=path.name
        )
    )
