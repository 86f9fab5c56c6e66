"""Read an image from the only scalar array of a VTI file, on cells or on points."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyvista

from tusqh.errors import GeometryError
from tusqh.readers.frames import place_of_centres
from tusqh.readers.reading import Reading
from tusqh.readers.voxels import image_in_file
from tusqh.readers.vtk_file import load_dataset
from tusqh.settings.voxels import Voxels

#: VTK's own array, which marks the cells that other parts of a dataset also have.
_GHOSTS = "vtkGhostType"


def read(path: Path, *, meaning: Voxels) -> Reading:
    """Read the voxels, their size and their position.

    Values of cells are voxels; each value of a point is a voxel around that point.

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
        The file is cut off or damaged; it has no scalar array, or several.
    """
    image = load_dataset(path)
    if not isinstance(image, pyvista.ImageData):
        raise _wrong(path, "it holds no image", "export it as a surface, or as an image")
    found = [
        (name, np.asarray(data[name]), is_of_cells)
        for data, is_of_cells in ((image.cell_data, True), (image.point_data, False))
        for name in data
        if name != _GHOSTS and data[name].ndim == 1
    ]
    if len(found) != 1:
        names = ", ".join(repr(name) for name, _, _ in found) or "none"
        remedy = "leave one of them in the file, or write it as NPY, NRRD or TIFF"
        raise _wrong(path, f"it has {len(found)} arrays of single numbers: {names}", remedy)
    (_, values, is_of_cells) = found[0]
    steps = np.asarray(image.direction_matrix).T * np.asarray(image.spacing)[:, None]
    shape = np.maximum(np.array(image.dimensions) - is_of_cells, 1)
    first = np.array(image.GetOrigin()) + np.array(image.GetExtent()[::2]) @ steps
    return image_in_file(
        path,
        values.reshape(shape, order="F"),
        meaning=meaning,
        place=place_of_centres(steps, first + is_of_cells * steps.sum(axis=0) / 2, shape.tolist()),
        is_named=True,
    )


def _wrong(path: Path, found: str, remedy: str) -> GeometryError:
    """Return the error for a file that is not one image."""
    return GeometryError(
        found,
        where=str(path),
        expected="an image with one array",
        remedy=remedy,
    )
