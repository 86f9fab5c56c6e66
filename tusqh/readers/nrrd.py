"""Read an image from an NRRD file: its first axis is x, and its header gives the voxel size."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nrrd
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
    """Read the voxels and their size.

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
        The axes are not parallel to those of space.
    GeometryError
        The voxels are not cubes, or the array is not an image.
    """
    voxels, header = nrrd.read(str(path), index_order="F")
    return image_of(
        path,
        voxels,
        size_in_file=_voxel_sides(header, voxels.ndim),
        voxel_size=voxel_size,
        empty=empty,
        full=full,
    )


def _voxel_sides(header: dict[str, Any], n_axes: int) -> list[float]:
    """Return the side lengths of a voxel that a header gives, 1 where it gives none."""
    if "space directions" in header:
        directions = np.asarray(header["space directions"], dtype=float)
        if np.count_nonzero(directions) != len(directions):
            raise ValueError("its axes are not parallel to those of space")
        sides: list[float] = np.abs(directions).sum(axis=1).tolist()
        return sides
    spacings = np.asarray(header.get("spacings", [1.0] * n_axes), dtype=float)
    return [float(x) if np.isfinite(x) else 1.0 for x in spacings]
