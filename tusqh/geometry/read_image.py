"""Read an image of voxels from a NumPy, TIFF or NRRD file.

``.npy``
    An array indexed ``[x, y, z]``.
``.tif``, ``.tiff``
    A stack: its pages are z, the rows of a page y, the columns x; nothing is turned over.
``.nrrd``
    The first axis of the file is x; the header gives the size of a voxel.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tusqh.errors import GeometryError
from tusqh.geometry.image import Image

SUFFIXES = (".npy", ".tif", ".tiff", ".nrrd")

#: Voxels whose sides differ by no more than this, relatively, are cubes.
_CUBIC = 1e-6


def read_image(
    path: Path,
    *,
    voxel_size: float | None = None,
    empty: float | None = None,
    full: float | None = None,
) -> Image:
    """Return the image in a file, named after it.

    Parameters
    ----------
    path
        The file; its suffix names the format.
    voxel_size
        Edge length of a voxel; without it what the file says, or 1.
    empty, full
        Grey values of fraction 0 and 1, see `Image.from_voxels`.

    Raises
    ------
    GeometryError
        The file is missing, damaged, no stack of grey values, or its voxels are no cubes.
    """
    if not path.is_file():
        raise GeometryError(
            "there is no such file",
            where=str(path),
            expected="an image file",
            remedy="check the path",
        )
    reader = {".npy": _read_npy, ".nrrd": _read_nrrd}.get(path.suffix.lower(), _read_tiff)
    try:
        voxels, size = reader(path)
    except Exception as error:  # The readers raise whatever their parsers trip over.
        raise GeometryError(
            f"the file cannot be read: {error or type(error).__name__}",
            where=str(path),
            expected=f"a {path.suffix.lower()} file of grey values along three axes",
            remedy="open it in the program that wrote it and export it again",
        ) from error
    if voxel_size is None and not np.ptp(size) <= _CUBIC * max(size):
        raise GeometryError(
            f"a voxel measures {' x '.join(f'{s:g}' for s in size)}",
            where=str(path),
            expected="cubic voxels",
            remedy="resample the image to cubes, or give `voxel_size` if the header is wrong",
        )
    return Image.from_voxels(
        voxels, voxel_size=voxel_size or float(size[0]), empty=empty, full=full, name=path.name
    )


def _read_npy(path: Path) -> tuple[NDArray[Any], list[float]]:
    return np.load(path, allow_pickle=False), [1.0] * 3


def _read_tiff(path: Path) -> tuple[NDArray[Any], list[float]]:
    import tifffile

    with tifffile.TiffFile(path) as file:
        series = file.series[0]
        if "S" in series.axes:
            raise ValueError(f"its pages have colours (axes {series.axes})")
        if len(file.series) > 1:
            raise ValueError(f"it holds {len(file.series)} images of different shapes")
        return series.asarray().transpose(), [1.0] * 3


def _read_nrrd(path: Path) -> tuple[NDArray[Any], list[float]]:
    import nrrd

    voxels, header = nrrd.read(str(path), index_order="F")
    if "space directions" in header:
        directions = np.asarray(header["space directions"], dtype=float)
        if np.count_nonzero(directions) != len(directions):
            raise ValueError("its axes are not those of space")
        return voxels, np.abs(directions).sum(axis=1).tolist()
    spacings = np.asarray(header.get("spacings", [1.0] * voxels.ndim), dtype=float)
    return voxels, np.where(np.isfinite(spacings), spacings, 1.0).tolist()
