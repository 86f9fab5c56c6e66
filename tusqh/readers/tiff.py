"""Read an image from a TIFF stack: its pages are z, the rows of a page y, the columns x."""

from __future__ import annotations

from pathlib import Path

import tifffile

from tusqh.readers.reading import Reading
from tusqh.readers.voxels import image_of


def read(
    path: Path,
    *,
    voxel_size: float | None = None,
    empty: float | None = None,
    full: float | None = None,
) -> Reading:
    """Read the voxels, without turning any axis; the resolution in the file is not read.

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
    ValueError
        The pages have colours or different shapes.
    GeometryError
        The stack is not an image, see `tusqh.geometry.image.Image`.
    """
    with tifffile.TiffFile(path) as file:
        series = file.series[0]
        if "S" in series.axes:
            raise ValueError(f"its pages have colours (axes {series.axes})")
        if len(file.series) > 1:
            raise ValueError(f"it holds {len(file.series)} images of different shapes")
        voxels = series.asarray().transpose()
    return image_of(path, voxels, voxel_size=voxel_size, empty=empty, full=full)
