"""Read an image from a NIfTI file (.nii, .nii.gz), with the affine map in its header."""

from __future__ import annotations

import gzip
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.errors import GeometryError
from tusqh.grid import FloatArray
from tusqh.readers.frames import place_of_centres
from tusqh.readers.gate import require_memory
from tusqh.readers.polygon_faces import damaged
from tusqh.readers.reading import Reading
from tusqh.readers.voxels import image_in_file
from tusqh.settings.voxels import Voxels

#: Types of voxels by their code.
_TYPES = {2: "u1", 4: "i2", 8: "i4", 16: "f4", 64: "f8", 256: "i1", 512: "u2", 768: "u4"}
_TYPES |= {1024: "i8", 1280: "u8"}
#: Units of length by their code, which is in the lowest three bits.
_UNITS = {1: "m", 2: "mm", 3: "um"}
_EXPECTED = "a complete NIfTI file"
#: Plural nouns for the fourth and later axes.
_AXES = ("times", "components", "components", "components")


def read(path: Path, *, meaning: Voxels) -> Reading:
    """Read the voxels, their unit and their place: sform if there is one, otherwise qform.

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
        The file is damaged or cut off, has voxels of several numbers, or is not an image in space.
    """
    with path.open("rb") as file:
        is_packed = file.read(2) == b"\x1f\x8b"
    with gzip.open(path) if is_packed else path.open("rb") as file:
        header = file.read(540)
        about = _Header(path, header)
        needed = math.prod(about.shape) * about.kind.itemsize
        shown = " x ".join(map(str, about.shape))
        require_memory(path, 3 * needed, what=f"an image of {shown} voxels")
        content = (header + file.read(max(about.start - len(header), 0)))[about.start :]
        content += file.read(needed - len(content)) if needed > len(content) else b""
    if len(content) < needed:
        raise damaged(
            path, f"it promises {needed:,} bytes and holds {len(content):,}", expected=_EXPECTED
        )
    voxels: Any = np.frombuffer(content[:needed], dtype=about.kind).reshape(about.shape, order="F")
    if about.scale not in ((0.0, 0.0), (1.0, 0.0)) and about.scale[0] != 0:
        voxels = voxels * about.scale[0] + about.scale[1]
    if voxels.dtype.kind == "f" and not np.isfinite(voxels).all():
        voxels = np.nan_to_num(voxels, nan=0.0)
    elif voxels.dtype.byteorder == ">":
        voxels = voxels.astype(voxels.dtype.newbyteorder("="))
    steps, first = about.affine[:3, :3].T, about.affine[:3, 3]
    return image_in_file(
        path,
        voxels,
        meaning=meaning,
        axes=["", "", "", *_AXES][: voxels.ndim],
        place=place_of_centres(steps, first, about.shape[:3], unit=about.unit),
        is_named=True,
    )


class _Header:
    """The header of NIfTI, version 1 or 2."""

    def __init__(self, path: Path, header: bytes) -> None:
        self.path = path
        order = next(
            (
                o
                for o in "<>"
                if header[:4] in (struct.pack(f"{o}i", 348), struct.pack(f"{o}i", 540))
            ),
            None,
        )
        if order is None or len(header) < 352:
            raise damaged(path, f"it begins with {header[:8]!r}", expected=_EXPECTED)
        is_second = struct.unpack(f"{order}i", header[:4])[0] == 540
        if is_second and len(header) < 540:
            raise damaged(path, "it ends in its header", expected=_EXPECTED)

        def take(form: str, first: int, second: int) -> tuple[Any, ...]:
            place = second if is_second else first
            return struct.unpack_from(order + form, header, place)

        sizes = take("8q", 0, 16) if is_second else take("8h", 40, 0)
        n_axes = int(sizes[0])
        if not 1 <= n_axes <= 7 or min(sizes[1 : n_axes + 1]) < 1:
            raise damaged(path, f"its axes have the lengths {sizes[1:]}", expected=_EXPECTED)
        shape = [int(n) for n in sizes[1 : n_axes + 1]]
        while len(shape) > 3 and shape[-1] == 1:
            shape.pop()
        self.shape = shape
        code = int(take("h", 70, 12)[0])
        if code not in _TYPES:
            raise GeometryError(
                f"its voxels are of type {code}",
                where=str(path),
                expected="one number for each voxel",
                remedy="export grey values or labels, not colours or complex numbers",
            )
        self.kind = np.dtype(_TYPES[code]).newbyteorder("<" if order == "<" else ">")
        real = "d" if is_second else "f"
        sides = np.array(take(f"8{real}", 76, 104), dtype=np.float64)
        self.start = int(take("q" if is_second else "f", 108, 168)[0])
        slope, inter = take(f"2{real}", 112, 176)
        self.scale = float(slope), float(inter)
        units = take("i" if is_second else "B", 123, 500)[0]
        self.unit = _UNITS.get(int(units) & 7, "")
        qform, sform = take("2i" if is_second else "2h", 252, 344)
        quaternion = np.array(take(f"6{real}", 256, 352), dtype=np.float64)
        rows = np.array(take(f"12{real}", 280, 400), dtype=np.float64).reshape(3, 4)
        if not 0 <= self.start <= 1 << 30:
            raise damaged(path, f"its voxels begin at byte {self.start}", expected=_EXPECTED)
        self.affine = np.eye(4)
        if sform > 0:
            self.affine[:3] = rows
        elif qform > 0:
            self.affine[:3] = _from_quaternion(quaternion, sides)
        else:
            self.affine[:3, :3] = np.diag(np.where(sides[1:4] > 0, sides[1:4], 1.0))


def _from_quaternion(numbers: FloatArray, sides: FloatArray) -> FloatArray:
    """Return the affine map of a quaternion (b, c, d), an offset, and side lengths."""
    b, c, d = numbers[:3]
    a = math.sqrt(max(0.0, 1.0 - b * b - c * c - d * d))
    turn = np.array(
        [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c],
        ]
    )
    factor = np.array([1.0, 1.0, -1.0 if sides[0] < 0 else 1.0]) * sides[1:4]
    return np.column_stack([turn * factor, numbers[3:6]])
