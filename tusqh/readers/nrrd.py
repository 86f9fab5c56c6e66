"""Read an image from an NRRD file, with the directions and the position in its header."""

from __future__ import annotations

import bz2
import gzip
import math
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import nrrd
import numpy as np

from tusqh.errors import GeometryError
from tusqh.geometry.remark import Remark
from tusqh.grid import FloatArray
from tusqh.machine import available_memory
from tusqh.readers.frames import Place, place_of_centres
from tusqh.readers.gate import check_part, require_memory
from tusqh.readers.reading import Reading
from tusqh.readers.voxels import image_in_file
from tusqh.settings.voxels import Voxels

_OPENERS: dict[str, Callable[..., Any]] = {
    **dict.fromkeys(("gz", "gzip"), gzip.open),
    **dict.fromkeys(("bz2", "bzip2"), bz2.open),
}
#: Largest expansion of a compressed byte, and number of bytes decompressed at a time.
_MOST_COMPRESSED, _BLOCK = 1032, 1 << 20
#: Kinds of axes that are directions of space; "" stands for axes without a kind.
_IN_SPACE = ("domain", "space", "", "???", "none")


def read(path: Path, *, meaning: Voxels) -> Reading:
    """Read the voxels, their size and their position.

    Axes are flipped, exchanged and turned according to the directions in the header.  The origin
    in the header is the centre of the first voxel; without it the lowest corner of the image is
    at 0.

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
        Axes are not directions of space or do not span it, or the array is not an image.
    """
    with path.open("rb") as file:  # pynrrd would treat a name with a newline as a header.
        _check_data(path, nrrd.read_header(file))
    voxels, header = nrrd.read(str(path), index_order="F")
    others = _find_others(header, voxels.ndim)
    in_space = [i for i, name in enumerate(others) if not name]
    steps, first = _find_frame(str(path), header, in_space)
    shape = [voxels.shape[i] for i in in_space]
    is_solid = len(shape) == 3
    return image_in_file(
        path,
        voxels,
        meaning=meaning,
        axes=others,
        place=place_of_centres(steps, first, shape, unit=_unit_in(header)) if is_solid else Place(),
        is_named="kinds" in header,
        remarks=_remark_on_last_number(path, header),
    )


def _check_data(path: Path, header: dict[str, Any]) -> None:
    """Raise an error if the data is in another folder or does not fit in memory.

    If compressed data could exceed the memory, its length is counted before it is stored.
    """
    name = header.get("data file", header.get("datafile"))
    part = path if name is None else check_part(path, str(name))
    kind = np.dtype(nrrd.reader._determine_datatype(header))
    needed = math.prod(int(n) for n in header["sizes"]) * kind.itemsize
    shape = " x ".join(str(n) for n in header["sizes"])
    require_memory(path, 3 * needed, what=f"an image of {shape} voxels")
    encoding = str(header["encoding"]).lower()
    if encoding not in _OPENERS or part.stat().st_size * _MOST_COMPRESSED < available_memory() / 3:
        return
    with part.open("rb") as raw:
        if part == path:
            nrrd.read_header(raw)
        n_read = 0
        try:
            with _OPENERS[encoding](raw) as data:
                while n_read <= 2 * needed + _BLOCK and (block := data.read(_BLOCK)):
                    n_read += len(block)
        except (OSError, EOFError, zlib.error):
            return  # pynrrd will report the damage.
    if n_read > 2 * needed + _BLOCK:
        raise GeometryError(
            "its compressed data is more than twice as long as the image",
            where=str(path),
            expected=f"{needed:,} bytes, as its header says",
            remedy="export the image again; it is damaged",
        )


def _find_others(header: dict[str, Any], n_axes: int) -> list[str]:
    """Return a noun for each axis, empty for directions of space."""
    kinds = list(header.get("kinds", [])) or [""] * n_axes
    kinds = ["" if kind is None else str(kind) for kind in kinds]
    directions = header.get("space directions")
    for i in range(n_axes):
        is_outside = directions is not None and (
            directions[i] is None or not np.isfinite(np.asarray(directions[i], dtype=float)).all()
        )
        kinds[i] = "" if kinds[i].lower() in _IN_SPACE else f"entries along the axis {kinds[i]!r}"
        if is_outside and not kinds[i]:
            kinds[i] = "entries along an axis outside space"
    return kinds


def _find_frame(
    where: str, header: dict[str, Any], in_space: list[int]
) -> tuple[FloatArray, FloatArray | None]:
    """Return the steps along the axes in space, and the centre of the first voxel if stated."""
    n_axes = len(in_space)
    if header.get("space directions") is None:
        spacings = np.asarray(header.get("spacings", np.ones(header["dimension"])), dtype=float)
        steps = np.array([spacings[i] if np.isfinite(spacings[i]) else 1.0 for i in in_space])
        if "spacings" not in header:
            steps = _steps_between_ends(header, in_space, steps)
        return np.diag(_of_three(steps, 1.0)), None
    rows = [np.asarray(header["space directions"][i], dtype=float) for i in in_space]
    matrix = np.array(rows)
    if matrix.shape != (3, 3):
        if n_axes != 3:  # A later check explains this with the shape of the array.
            return np.eye(3), None
        raise GeometryError(
            f"its directions have {matrix.shape[-1]} components",
            where=where,
            expected="directions in space, with three components",
            remedy="correct the header, or export the image again",
        )
    origin = header.get("space origin")
    first = None if origin is None else np.asarray(origin, dtype=float)
    is_stated = first is not None and first.shape == (3,) and bool(np.isfinite(first).all())
    return matrix, first if is_stated else None


def _steps_between_ends(
    header: dict[str, Any], in_space: list[int], steps: FloatArray
) -> FloatArray:
    """Return the steps from "axis mins" and "axis maxs", for a header without spacings."""
    if "axis mins" not in header or "axis maxs" not in header:
        return steps
    ends = [np.asarray(header[key], dtype=float)[in_space] for key in ("axis mins", "axis maxs")]
    is_node = [str(header.get("centers", [""] * 9)[i]) == "node" for i in in_space]
    numbers = np.asarray(header["sizes"], dtype=float)[in_space] - is_node
    with np.errstate(divide="ignore", invalid="ignore"):
        between = np.abs(ends[1] - ends[0]) / numbers
    return np.where(np.isfinite(between) & (between > 0), between, steps)


def _of_three(numbers: FloatArray, other: float) -> FloatArray:
    """Return three numbers; an image with fewer axes is rejected later."""
    return np.append(numbers, [other] * 3)[:3]


def _unit_in(header: dict[str, Any]) -> str:
    """Return the unit of length in the header; several units are joined by commas."""
    units = header.get("space units", header.get("units", []))
    named = sorted({str(unit).strip(' "') for unit in units if unit is not None})
    return ", ".join(name for name in named if name not in ("", "nan"))


def _remark_on_last_number(path: Path, header: dict[str, Any]) -> list[Remark]:
    """Return a remark if the last number of a text may have lost digits."""
    if str(header["encoding"]).lower() not in ("ascii", "text", "txt") or "data file" in header:
        return []
    with path.open("rb") as file:
        file.seek(-1, 2)
        if file.read(1).isspace():
            return []
    what = "last number without an end of line: the file may be cut off"
    return [Remark("noted", what, 1)]
