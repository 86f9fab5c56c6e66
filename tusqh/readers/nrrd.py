"""Read an image from an NRRD file, with the directions and the position in its header."""

from __future__ import annotations

import bz2
import gzip
import math
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nrrd
import numpy as np
from numpy.typing import NDArray

from tusqh.errors import GeometryError
from tusqh.geometry.remark import Remark
from tusqh.grid import FloatArray
from tusqh.machine import available_memory
from tusqh.readers.gate import check_part, require_memory
from tusqh.readers.reading import Reading
from tusqh.readers.voxels import Place, image_in_file
from tusqh.settings.voxels import Voxels

#: Components of a direction up to this, relative to its length, count as zero.
_PARALLEL = 1e-6
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

    Axes are flipped and exchanged according to the directions in the header.  The origin in the
    header is the centre of the first voxel; without it the lowest corner of the image is at 0.

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
        Axes are oblique or are not directions of space, the voxels are not cubes, or the array is
        not an image.
    """
    with path.open("rb") as file:  # pynrrd would treat a name with a newline as a header.
        _check_data(path, nrrd.read_header(file))
    voxels, header = nrrd.read(str(path), index_order="F")
    others = _find_others(header, voxels.ndim)
    in_space = [i for i, name in enumerate(others) if not name]
    frame = _find_frame(str(path), header, in_space)
    order = np.argsort(frame.towards)
    return image_in_file(
        path,
        voxels,
        meaning=meaning,
        axes=others,
        arrange=frame.arrange,
        place=Place(
            sides=np.abs(frame.steps)[order].tolist(),
            origin=_lowest_corner(frame, [voxels.shape[i] for i in in_space]),
            unit=_unit_in(header),
        ),
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


@dataclass(frozen=True)
class _Frame:
    """The frame of an image's three axes: axis a has steps `steps[a]` along axis `towards[a]`."""

    steps: FloatArray
    towards: NDArray[np.int64]
    #: Centre of the first voxel, None if the file does not state it.
    first: FloatArray | None = None

    def arrange(self, voxels: NDArray[Any]) -> NDArray[Any]:
        """Return an array with its axes in the order and the directions of space."""
        if voxels.ndim != 3:  # An image with fewer axes is rejected later.
            return voxels
        flipped = np.flip(voxels, axis=tuple(i for i in range(3) if self.steps[i] < 0))
        return flipped.transpose(np.argsort(self.towards))


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


def _find_frame(where: str, header: dict[str, Any], in_space: list[int]) -> _Frame:
    """Return the frame of the axes in space."""
    n_axes = len(in_space)
    if header.get("space directions") is None:
        spacings = np.asarray(header.get("spacings", np.ones(header["dimension"])), dtype=float)
        steps = np.array([spacings[i] if np.isfinite(spacings[i]) else 1.0 for i in in_space])
        if "spacings" not in header:
            steps = _steps_between_ends(header, in_space, steps)
        return _Frame(_of_three(steps, 1.0), np.arange(3))
    rows = [np.asarray(header["space directions"][i], dtype=float) for i in in_space]
    matrix = np.array(rows)
    if matrix.shape != (3, 3):
        if n_axes != 3:  # A later check explains this with the shape of the array.
            return _Frame(np.ones(3), np.arange(3))
        raise _oblique(where, f"its directions have {matrix.shape[-1]} components")
    lengths = np.linalg.norm(matrix, axis=1)
    is_along = np.abs(matrix) > _PARALLEL * lengths[:, None]
    if not (is_along.sum(axis=0) == 1).all() or not (is_along.sum(axis=1) == 1).all():
        shown = " ".join(f"({', '.join(f'{x:g}' for x in row)})" for row in matrix)
        raise _oblique(where, f"its axes {shown} are not parallel to those of space")
    towards = np.argmax(is_along, axis=1)
    origin = header.get("space origin")
    first = None if origin is None else np.asarray(origin, dtype=float)
    if first is not None and not np.isfinite(first).all():
        first = None
    return _Frame(matrix[np.arange(3), towards], towards, first)


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


def _lowest_corner(frame: _Frame, shape: list[int]) -> list[float]:
    """Return the lowest corner of an image, given the lengths of its axes in the file."""
    if frame.first is None or len(shape) != 3:
        return [0.0, 0.0, 0.0]
    order = np.argsort(frame.towards)
    steps = frame.steps[order]
    far = frame.first + np.where(steps < 0, steps * (np.array(shape)[order] - 1), 0.0)
    corner: list[float] = (far - np.abs(steps) / 2).tolist()
    return corner


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


def _oblique(where: str, found: str) -> GeometryError:
    """Return the error for axes that are not parallel to those of space."""
    return GeometryError(
        found,
        where=where,
        expected="an image whose axes are parallel to x, y and z",
        remedy="resample the image along the axes of space",
    )
