"""Read an image from a TIFF stack, whose pages are z, rows y and columns x."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import tifffile
from numpy.typing import NDArray

from tusqh.errors import GeometryError
from tusqh.extras import require
from tusqh.geometry.remark import Remark
from tusqh.readers.frames import Place
from tusqh.readers.gate import require_memory
from tusqh.readers.logs import collect_logs, remarks_on_logs
from tusqh.readers.reading import Reading
from tusqh.readers.tiff_pages import check_data, count_pages
from tusqh.readers.tiff_sizes import voxel_sides
from tusqh.readers.voxels import image_in_file
from tusqh.settings.voxels import Voxels

#: Axes of tifffile that are not directions of space.
_OTHERS = {"C": "channels (axis C)", "T": "times (axis T)", "S": "colours (axis S)"}
#: Axes that can be pages without a stated meaning.
_PAGES = "IQ"


def read(path: Path, *, meaning: Voxels) -> Reading:
    """Read the voxels, without turning any axis, and their size as stated by ImageJ or OME.

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
        The file is cut off, its pages have different shapes, an axis is not a direction of space,
        the voxels are not cubes, or the stack is not an image, see `tusqh.geometry.image.Image`.
    """
    n_pages = count_pages(path)
    with collect_logs("tifffile") as texts, tifffile.TiffFile(path) as file:
        try:
            voxels, axes, n_empty = _stack(path, file)
        except ValueError as error:  # tifffile needs imagecodecs only for some files.
            if "imagecodecs" in str(error):
                require("imagecodecs", extra="formats")
            raise
        sides, unit = [1.0, 1.0, 1.0], ""
        remarks: list[Remark] = []
        if meaning.voxel_size is None:
            sides, unit, remarks = voxel_sides(str(path), file)
        remarks += _remark_on_page(file.pages[0])
        orientation = _orientation_of(file.pages[0])
    if n_empty:
        remarks.append(Remark("noted", "parts of pages without data, read as 0", n_empty))
    remarks += remarks_on_logs("tifffile", texts)
    if orientation != 1:
        what = f"pages turned as the tag Orientation {orientation} says"
        remarks.append(Remark("changed", what, n_pages))
    if orientation > 4:
        sides = [sides[1], sides[0], sides[2]]
    others = [_OTHERS.get(axis, "" if axis in "XYZ" else f"entries along {axis}") for axis in axes]
    left = [axis for axis, other in zip(axes, others, strict=True) if not other]
    by_axis = [left.index(axis) for axis in "XYZ" if axis in left]
    is_named = set(_PAGES).isdisjoint(file.series[0].axes) and len(file.series) == 1
    return image_in_file(
        path,
        voxels,
        meaning=meaning,
        axes=others,
        arrange=lambda stored: _upright(stored.transpose(by_axis), orientation),
        place=Place(sides=sides, unit=unit),
        is_named=is_named,
        remarks=remarks,
    )


def _orientation_of(page: Any) -> int:
    """Return the tag Orientation of a page, which is 1 if its first row is the top one."""
    tag = page.tags.get("Orientation")
    orientation = 1 if tag is None else int(tag.value)
    if not 1 <= orientation <= 8:
        raise ValueError(f"its tag Orientation is {orientation}, not one of 1 to 8")
    return orientation


def _upright(voxels: NDArray[Any], orientation: int) -> NDArray[Any]:
    """Return pages, shape (nx, ny, ...), turned into the orientation in which they are shown."""
    if orientation in (2, 3, 7, 8):
        voxels = voxels[::-1]
    if orientation in (3, 4, 6, 7):
        voxels = voxels[:, ::-1]
    return voxels.swapaxes(0, 1) if orientation > 4 else voxels


def _stack(path: Path, file: Any) -> tuple[NDArray[Any], str, int]:
    """Return the only image of a file, or all its pages as one image, with a letter per axis."""
    shapes = [(series.shape, series.dtype, series.axes) for series in file.series]
    if not shapes:
        raise ValueError("it has no pages")
    if len(shapes) > 1 and (len(set(shapes)) > 1 or shapes[0][2] != "YX"):
        sizes = list(dict.fromkeys(" x ".join(map(str, shape)) for shape, _, _ in shapes))
        kinds = f"shapes {', '.join(sizes[:4])}" if len(sizes) > 1 else f"shape {sizes[0]}"
        raise GeometryError(
            f"the file holds {len(shapes)} images of {kinds} (last axis first)",
            where=str(path),
            expected="one stack of pages of one shape and type",
            remedy="export one of them as a separate file",
        )
    needed = sum(math.prod(shape) * np.dtype(kind).itemsize for shape, kind, _ in shapes)
    require_memory(path, 3 * needed, what=f"an image of {needed / 1e6:,.0f} MB")
    n_empty = sum(check_data(path, series) for series in file.series)
    _check_number(path, file)
    if len(shapes) > 1:
        return np.stack([series.asarray() for series in file.series]), "ZYX", n_empty
    axes = str(file.series[0].axes)
    pages = [axis for axis in axes if axis in _PAGES]
    if len(pages) == 1 and "Z" not in axes:
        axes = axes.replace(pages[0], "Z")
    return file.series[0].asarray(), axes, n_empty


def _check_number(path: Path, file: Any) -> None:
    """Raise an error if ImageJ's description states another number of images than the file has."""
    stated = (file.imagej_metadata or {}).get("images")
    n_found = sum(
        int(np.prod([n for n, axis in zip(s.shape, s.axes, strict=True) if axis not in "YXS"]))
        for s in file.series
    )
    if stated is not None and int(stated) != n_found:
        raise GeometryError(
            f"the file holds {n_found:,} images",
            where=str(path),
            expected=f"{int(stated):,} images, as its description says",
            remedy="copy or download it again, or export it again",
        )


def _remark_on_page(page: Any) -> list[Remark]:
    """Return remarks on tags that would change the meaning of numbers but are ignored."""
    remarks = []
    if int(page.photometric) == 0:
        remedy = "give `empty` above `full` where the bright voxels are the material"
        remarks.append(Remark("noted", "stack in which 0 is white", 1, remedy))
    if int(page.photometric) == 3:
        remarks.append(Remark("left out", "palette of colours; its numbers are read", 1))
    return remarks
