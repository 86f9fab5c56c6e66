"""Read an image of ITK's MetaImage (.mha, .mhd), with its directions and its position."""

from __future__ import annotations

import math
import zlib
from pathlib import Path

import numpy as np

from tusqh.errors import GeometryError
from tusqh.readers.frames import Place, place_of_centres
from tusqh.readers.gate import check_part, require_memory
from tusqh.readers.polygon_faces import damaged
from tusqh.readers.reading import Reading
from tusqh.readers.voxels import image_in_file
from tusqh.settings.voxels import Voxels

_TYPES = {"MET_CHAR": "i1", "MET_UCHAR": "u1", "MET_SHORT": "i2", "MET_USHORT": "u2"}
_TYPES |= {"MET_INT": "i4", "MET_UINT": "u4", "MET_LONG": "i4", "MET_ULONG": "u4"}
_TYPES |= {"MET_LONG_LONG": "i8", "MET_ULONG_LONG": "u8", "MET_FLOAT": "f4", "MET_DOUBLE": "f8"}
_EXPECTED = "a complete MetaImage file"
#: Largest number of bytes of a header.
_LONGEST = 1 << 16


def read(path: Path, *, meaning: Voxels) -> Reading:
    """Read the voxels, their size, their directions and their position.

    MetaImage does not state the unit of length; scanners use millimetres.

    Parameters
    ----------
    path
        The file; the data may be in another file of its folder.
    meaning
        The meaning of the voxels.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    GeometryError
        The file is damaged or cut off, or its data is elsewhere.
    """
    header, rest = _split(path)
    shape = [int(n) for n in _numbers(path, header, "DimSize")]
    n_axes = int(header.get("NDims", len(shape)))
    name = header.get("ElementType", "")
    n_channels = int(header.get("ElementNumberOfChannels", 1))
    if len(shape) != n_axes or not shape or min(shape) < 1 or name not in _TYPES or n_channels < 1:
        raise damaged(path, f"it has {shape} elements of type {name[:20]!r}", expected=_EXPECTED)
    is_big = header.get("BinaryDataByteOrderMSB", header.get("ElementByteOrderMSB", "False"))
    kind = np.dtype(_TYPES[name]).newbyteorder(">" if is_big.lower() == "true" else "<")
    needed = math.prod(shape) * n_channels * kind.itemsize
    require_memory(path, 3 * needed, what=f"an image of {' x '.join(map(str, shape))} voxels")
    content = _data(path, header, rest, needed)
    if len(content) < needed:
        raise damaged(
            path, f"it promises {needed:,} bytes and holds {len(content):,}", expected=_EXPECTED
        )
    voxels = np.frombuffer(content[:needed], dtype=kind).astype(kind.newbyteorder("="))
    channels = [n_channels] if n_channels > 1 else []
    voxels = voxels.reshape([*channels, *shape], order="F")
    place = Place()
    if n_axes == 3:
        sides = _numbers(path, header, "ElementSpacing", "ElementSize") or [1.0] * 3
        turn = _numbers(path, header, "TransformMatrix", "Rotation", "Orientation")
        first = _numbers(path, header, "Offset", "Position", "Origin") or [0.0] * 3
        if (len(sides), len(turn) or 9, len(first)) != (3, 9, 3):
            raise damaged(path, "its directions are not those of three axes", expected=_EXPECTED)
        matrix = np.array(turn or np.eye(3).ravel()).reshape(3, 3)
        steps = matrix * np.array(sides)[:, None]
        place = place_of_centres(steps, np.array(first), shape)
    axes = ["channels"] * len(channels) + [""] * n_axes
    return image_in_file(path, voxels, meaning=meaning, axes=axes, place=place, is_named=True)


def _split(path: Path) -> tuple[dict[str, str], int]:
    """Return the header, and the place at which the data begins in the file."""
    with path.open("rb") as file:
        head = file.read(_LONGEST)
    header: dict[str, str] = {}
    place = 0
    while place < len(head):
        end = head.find(b"\n", place)
        line = head[place : end if end >= 0 else len(head)]
        key, sign, value = line.decode("utf-8", errors="replace").partition("=")
        if not sign:
            break
        header[key.strip()] = value.strip()
        place = end + 1 if end >= 0 else len(head)
        if key.strip() == "ElementDataFile":
            return header, place
    raise damaged(path, "its header has no `ElementDataFile`", expected=_EXPECTED)


def _numbers(path: Path, header: dict[str, str], *keys: str) -> list[float]:
    """Return the numbers under the first key that is there."""
    for key in keys:
        if key in header:
            numbers = [float(word) for word in header[key].split()]
            if not np.isfinite(numbers).all():
                raise damaged(path, f"`{key}` is {header[key][:40]!r}", expected=_EXPECTED)
            return numbers
    return []


def _data(path: Path, header: dict[str, str], start: int, needed: int) -> bytes:
    """Return the bytes of the voxels."""
    name = header["ElementDataFile"]
    if name.upper() == "LIST" or "%" in name:
        raise GeometryError(
            "its data is in a list of files",
            where=str(path),
            expected="one file of data",
            remedy="save it as one .mha file",
        )
    part = path if name.upper() == "LOCAL" else check_part(path, name)
    with part.open("rb") as file:
        file.seek(start if part == path else max(int(header.get("HeaderSize", 0)), 0))
        if header.get("CompressedData", "False").lower() != "true":
            return file.read(needed)
        packed = file.read()
    try:
        return zlib.decompressobj(wbits=47).decompress(packed, needed)
    except zlib.error as error:
        raise damaged(path, f"its data cannot be unpacked: {error}", expected=_EXPECTED) from error
