"""Read a series of DICOM slices: all files of a folder that belong to the same series as one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tusqh.errors import GeometryError
from tusqh.extras import require
from tusqh.geometry.remark import Remark
from tusqh.grid import FloatArray
from tusqh.readers.beside import files_beside
from tusqh.readers.frames import place_of_centres
from tusqh.readers.gate import require_memory
from tusqh.readers.polygon_faces import damaged
from tusqh.readers.reading import Reading
from tusqh.readers.voxels import image_in_file
from tusqh.settings.voxels import Voxels

_EXPECTED = "a complete series of DICOM slices"
#: Largest difference of the distances between slices, relative to the usual one.
_UNEVEN = 0.02


def read(path: Path, *, meaning: Voxels) -> Reading:
    """Read the slices of a series, or the frames of one file, with rescaled values, in millimetres.

    Parameters
    ----------
    path
        Any file of the series; the others are beside it, with the same suffix.
    meaning
        The meaning of the voxels.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    GeometryError
        A file is damaged or compressed, slices are missing, or they differ in size or direction.
    """
    pydicom = require("pydicom", extra="formats")
    chosen = _open(pydicom, path)
    series = str(chosen.get("SeriesInstanceUID", ""))
    slices, n_others = [(path, chosen)], 0
    for other in files_beside(path):
        found = _open(pydicom, other)
        if series and str(found.get("SeriesInstanceUID", "")) == series:
            slices.append((other, found))
        else:
            n_others += 1
    remarks = (
        [Remark("left out", "files of other series in the folder", n_others)] if n_others else []
    )
    count = sum(int(f.get("NumberOfFrames", 1) or 1) for _, f in slices)
    needed = 8 * count * int(chosen.get("Rows", 0)) * int(chosen.get("Columns", 0))
    require_memory(path, 2 * needed, what=f"an image of {count} slices")
    if len(slices) == 1 and count > 1:
        voxels, steps, first = _frames(path, chosen)
    else:
        voxels, steps, first = _stack(path, slices)
    return image_in_file(
        path,
        voxels,
        meaning=meaning,
        place=place_of_centres(steps, first, voxels.shape, unit="mm"),
        is_named=True,
        remarks=remarks,
    )


def _open(pydicom: Any, path: Path) -> Any:
    """Return the data set of a file."""
    try:
        return pydicom.dcmread(path)
    except Exception as error:  # pydicom raises many types of error for a damaged file.
        raise damaged(path, f"it cannot be read: {str(error)[:120]}", expected=_EXPECTED) from error


def _frames(path: Path, found: Any) -> tuple[Any, FloatArray, FloatArray | None]:
    """Return the voxels [x, y, z], steps and first centre of a file of several frames."""
    voxels = _pixels(path, found)
    across = _numbers(path, found, "PixelSpacing", 2)
    deep = found.get("SpacingBetweenSlices", found.get("SliceThickness"))
    if across is None or deep is None:
        raise damaged(
            path, "its frames have no `PixelSpacing` and `SpacingBetweenSlices`", expected=_EXPECTED
        )
    return voxels.transpose(2, 1, 0), np.diag([across[1], across[0], abs(float(deep))]), None


def _stack(path: Path, slices: list[tuple[Path, Any]]) -> tuple[Any, FloatArray, FloatArray]:
    """Return the voxels [x, y, z], steps and first centre of slices in order."""
    head = slices[0][1]
    turn = _numbers(path, head, "ImageOrientationPatient", 6)
    across = _numbers(path, head, "PixelSpacing", 2)
    if turn is None or across is None:
        raise damaged(
            path, "it has no `ImageOrientationPatient` and `PixelSpacing`", expected=_EXPECTED
        )
    rows, columns = turn[:3], turn[3:]
    normal = np.cross(rows, columns)
    places: list[FloatArray] = []
    layers: list[Any] = []
    for name, found in slices:
        place = _numbers(name, found, "ImagePositionPatient", 3)
        other = _numbers(name, found, "ImageOrientationPatient", 6)
        spacing = _numbers(name, found, "PixelSpacing", 2)
        if place is None or other is None or spacing is None:
            raise damaged(name, "it has no place and direction", expected=_EXPECTED)
        layer = _pixels(name, found)
        is_same = np.allclose(other, turn, atol=1e-4) and np.allclose(spacing, across, rtol=1e-4)
        if layer.ndim != 2 or (layers and layer.shape != layers[0].shape) or not is_same:
            raise damaged(
                name,
                f"a slice of {' x '.join(map(str, layer.shape))} pixels, with another size or "
                "direction than the others",
                expected=_EXPECTED,
                remedy="export the series alone, without overviews",
            )
        places.append(place)
        layers.append(layer)
    order = np.argsort([place @ normal for place in places], kind="stable")
    ordered = np.array(places)[order]
    step = _step(path, ordered, normal)
    voxels = np.stack([layers[k] for k in order], axis=-1).transpose(1, 0, 2)
    return voxels, np.array([rows * across[1], columns * across[0], step]), ordered[0]


def _step(path: Path, places: FloatArray, normal: FloatArray) -> FloatArray:
    """Return the step from a slice to the next, after checking that none is missing."""
    if len(places) < 2:
        raise GeometryError(
            "the series has one slice",
            where=str(path),
            expected="at least two slices in one folder",
            remedy="copy all files of the series into one folder, with the same suffix",
        )
    gaps = np.diff(places @ normal)
    usual = float(np.median(gaps))
    if gaps.min() <= 1e-3 * max(usual, 1e-9):
        raise GeometryError(
            f"{int((gaps <= 1e-3 * usual).sum()) + 1} slices lie at the same place",
            where=str(path),
            expected="one slice at each place",
            remedy="export one time or one reconstruction of the series",
        )
    wide = np.flatnonzero(np.abs(gaps - usual) > _UNEVEN * usual)
    if len(wide):
        k = int(wide[0])
        number = max(round(gaps[k] / usual) - 1, 0)
        low, high = places[k] @ normal, places[k + 1] @ normal
        what = f"about {number} slices are missing" if number else "slices are unevenly spaced"
        raise GeometryError(
            f"{what} between {low:g} and {high:g} mm: the others are {usual:g} mm apart",
            where=str(path),
            expected="slices at equal distances",
            remedy="copy the whole series, or resample it",
        )
    step: FloatArray = (places[-1] - places[0]) / (len(places) - 1)
    return step


def _pixels(path: Path, found: Any) -> Any:
    """Return the rescaled pixels of a data set."""
    if int(found.get("SamplesPerPixel", 1)) != 1:
        raise damaged(
            path, "its pixels are colours", expected=_EXPECTED, remedy="export grey values"
        )
    try:
        pixels = found.pixel_array
    except Exception as error:  # pydicom raises many types of error.
        raise damaged(
            path,
            f"its pixels cannot be read: {str(error)[:120]}",
            expected=_EXPECTED,
            remedy="export it again without compression, for instance with gdcmconv --raw",
        ) from error
    slope, shift = float(found.get("RescaleSlope", 1)), float(found.get("RescaleIntercept", 0))
    return pixels if (slope, shift) == (1.0, 0.0) else pixels * slope + shift


def _numbers(path: Path, found: Any, key: str, n: int) -> FloatArray | None:
    """Return the numbers of an element, None if it is missing."""
    value = found.get(key)
    if value is None or len(value) != n:
        return None
    numbers = np.array([float(v) for v in value])
    if not np.isfinite(numbers).all():
        raise damaged(path, f"`{key}` is {value}", expected=_EXPECTED)
    return numbers
