"""Read an image from a NumPy file: an array indexed ``[x, y, z]``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tusqh.readers.reading import Reading
from tusqh.readers.voxels import image_of


def read(
    path: Path,
    *,
    voxel_size: float | None = None,
    empty: float | None = None,
    full: float | None = None,
) -> Reading:
    """Read the voxels; the file does not give their size.

    Parameters
    ----------
    path
        The file.
    voxel_size, empty, full
        See `tusqh.readers.voxels.image_of`.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    GeometryError
        The array is not an image, see `tusqh.geometry.image.Image`.
    """
    voxels = np.load(path, allow_pickle=False)
    return image_of(path, voxels, voxel_size=voxel_size, empty=empty, full=full)
