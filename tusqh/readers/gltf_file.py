"""The JSON document, the buffers and the accessors of a glTF file."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from tusqh.errors import GeometryError
from tusqh.grid import FloatArray
from tusqh.readers.gate import check_part
from tusqh.readers.polygon_faces import damaged

_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_EXPECTED = "a complete glTF 2.0 file"
#: Relative difference from the stated extremes that rounding explains.
_ROUNDING = 1e-3


class GltfFile:
    """A glTF file, text or binary.

    Parameters
    ----------
    path
        The file.
    content
        Its bytes; None: they are read.

    Raises
    ------
    GeometryError
        The file is cut off, or not glTF 2.0.
    """

    def __init__(self, path: Path, content: bytes | None = None) -> None:
        self.path = path
        content = path.read_bytes() if content is None else content
        self._binary: bytes | None = None
        if content[:4] == b"glTF":
            content = self._split(content)
        try:
            self.document: dict[str, Any] = json.loads(content.removeprefix(b"\xef\xbb\xbf"))
            version = str(self.document["asset"]["version"])
        except (ValueError, KeyError, TypeError) as error:
            raise self.fault(f"the document cannot be read: {error}") from error
        if not version.startswith("2"):
            raise self.fault(f"the version is {version}")

    def fault(self, found: str, *, remedy: str = "") -> GeometryError:
        """Return the error for a fault of the file.

        Parameters
        ----------
        found
            The fault.
        remedy
            The remedy; by default, to export the file again.
        """
        if remedy:
            return damaged(self.path, found, expected=_EXPECTED, remedy=remedy)
        return damaged(self.path, found, expected=_EXPECTED)

    def accessor(self, number: int) -> FloatArray:
        """Return the numbers of an accessor, compared with the extremes that the file states.

        Parameters
        ----------
        number
            Number of the accessor.

        Returns
        -------
        numpy.ndarray
            Shape (count, width); normalized integers are between -1 and 1.

        Raises
        ------
        GeometryError
            Bytes are missing, or the numbers contradict the file's statements.
        """
        found = self.item("accessors", number)
        count, width = int(found["count"]), _WIDTHS[found["type"]]
        kind = np.dtype(_TYPES[found["componentType"]])
        values = (
            np.zeros((count, width), dtype=kind)
            if "bufferView" not in found
            else self._view(
                found["bufferView"], int(found.get("byteOffset", 0)), count, width, kind
            )
        )
        if "sparse" in found:
            values = values.copy()
            sparse = found["sparse"]
            n, places, changed = int(sparse["count"]), sparse["indices"], sparse["values"]
            index_kind = np.dtype(_TYPES[places["componentType"]])
            start = int(places.get("byteOffset", 0))
            rows = self._view(places["bufferView"], start, n, 1, index_kind)[:, 0]
            if (rows >= count).any():
                raise self.fault(f"accessor {number} replaces a row that it does not have")
            start = int(changed.get("byteOffset", 0))
            values[rows] = self._view(changed["bufferView"], start, n, width, kind)
        self._compare(number, found, values)
        numbers = values.astype(np.float64)
        if found.get("normalized") and kind.kind in "iu":
            numbers = np.maximum(numbers / np.iinfo(kind).max, -1.0)
        return numbers

    def item(self, kind: str, number: int) -> dict[str, Any]:
        """Return an entry of a list of the document.

        Parameters
        ----------
        kind
            Name of the list, such as "nodes".
        number
            Number of the entry.

        Raises
        ------
        GeometryError
            There is no such entry.
        """
        entries = self.document.get(kind, [])
        if not isinstance(number, int) or not 0 <= number < len(entries):
            raise self.fault(f"entry {number} of {len(entries)} {kind} is used")
        entry: dict[str, Any] = entries[number]
        return entry

    def bytes_of_view(self, number: int) -> bytes:
        """Return the bytes of a buffer view.

        Parameters
        ----------
        number
            Number of the view.

        Raises
        ------
        GeometryError
            Bytes are missing.
        """
        view = self.item("bufferViews", number)
        size = int(view["byteLength"])
        rows = self._view(number, 0, size, 1, np.dtype("u1"))
        return rows.tobytes()

    def _split(self, content: bytes) -> bytes:
        """Return the JSON chunk of a binary file, and store the other one."""
        if len(content) < 20:
            raise self.fault(f"the file has {len(content)} bytes, too few for a header")
        version, length = struct.unpack("<II", content[4:12])
        if version != 2:
            raise self.fault(f"the version is {version}")
        if length > len(content):
            raise self.fault(f"the header promises {length} bytes, the file holds {len(content)}")
        chunks: dict[bytes, bytes] = {}
        place = 12
        while place + 8 <= length:
            size, name = struct.unpack("<I4s", content[place : place + 8])
            if place + 8 + size > length:
                raise self.fault(f"a chunk of {size} bytes does not fit in {length} bytes")
            chunks.setdefault(name, content[place + 8 : place + 8 + size])
            place += 8 + size
        self._binary = chunks.get(b"BIN\0")
        return chunks.get(b"JSON", b"")

    def _buffer(self, number: int) -> bytes:
        """Return the bytes of a buffer."""
        buffer = self.item("buffers", number)
        uri: str | None = buffer.get("uri")
        content: bytes | None
        if uri is None:
            content = self._binary if number == 0 else None
        elif uri.startswith("data:"):
            content = base64.b64decode(uri.partition(",")[2])
        else:
            content = check_part(self.path, unquote(uri)).read_bytes()
        if content is None:
            raise self.fault(
                f"buffer {number} is missing in the file itself",
                remedy="copy the files that belong to it too, or export it as .glb",
            )
        if len(content) < buffer["byteLength"]:
            raise self.fault(
                f"buffer {number} promises {buffer['byteLength']} bytes and holds {len(content)}"
            )
        return content

    def _view(
        self, number: int, offset: int, count: int, width: int, kind: np.dtype[Any]
    ) -> np.ndarray[Any, Any]:
        """Return rows from a buffer view."""
        view = self.item("bufferViews", number)
        if "EXT_meshopt_compression" in view.get("extensions", {}):
            raise self.fault(
                "EXT_meshopt_compression is not supported", remedy="export without compression"
            )
        row = width * kind.itemsize
        stride = int(view.get("byteStride", row))
        size = int(view["byteLength"])
        needed = offset + stride * (count - 1) + row if count else 0
        buffer = self._buffer(view["buffer"])
        start = int(view.get("byteOffset", 0))
        if offset < 0 or start < 0 or stride < row or needed > size or start + size > len(buffer):
            raise self.fault(f"{count} rows need {needed} bytes, view {number} holds {size}")
        return np.ndarray((count, width), kind, buffer, start + offset, (stride, kind.itemsize))

    def _compare(self, number: int, found: dict[str, Any], values: np.ndarray[Any, Any]) -> None:
        """Compare numbers with the extremes stated in the file."""
        if not len(values) or "min" not in found or "max" not in found:
            return
        stated = np.array([found["min"], found["max"]], dtype=np.float64)
        read = np.array([values.min(axis=0), values.max(axis=0)], dtype=np.float64)
        scale = np.abs(stated).max() + np.ptp(stated)
        if stated.shape != read.shape or (np.abs(read - stated) > _ROUNDING * scale).any():
            raise self.fault(
                f"accessor {number} states extremes of {stated.tolist()} and has {read.tolist()}"
            )
