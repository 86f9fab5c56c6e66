"""Read an image from a NumPy file with an array indexed ``[x, y, z]``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tusqh.errors import GeometryError
from tusqh.readers.reading import Reading
from tusqh.readers.voxels import image_in_file
from tusqh.settings.voxels import Voxels


def read(path: Path, *, meaning: Voxels) -> Reading:
    """Read the voxels; the file does not state their size.

    Parameters
    ----------
    path
        The file.
    meaning
        The meaning of the voxels.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    GeometryError
        The file has more or fewer bytes than its header states, or the array is not an image, see
        `tusqh.geometry.image.Image`.
    """
    with path.open("rb") as file:
        voxels = np.load(file, allow_pickle=False)
        n_left = path.stat().st_size - file.tell()
    if n_left:
        raise GeometryError(
            f"{n_left:,} bytes follow the array of shape {voxels.shape}",
            where=str(path),
            expected="one array, as long as its header says",
            remedy="write it again with `numpy.save`, one array in each file",
        )
    return image_in_file(path, voxels, meaning=meaning)
