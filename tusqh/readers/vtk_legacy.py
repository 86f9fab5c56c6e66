"""Check that a legacy VTK file is complete before VTK reads it.

VTK uses uninitialized memory when it reads a truncated file, and may crash the process.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from tusqh.errors import GeometryError
from tusqh.readers.ply_rows import count_lists
from tusqh.readers.polygon_faces import damaged, numbers_of

_TYPES = {
    **{"bit": "u1", "char": "i1", "signed_char": "i1", "unsigned_char": "u1", "short": "i2"},
    **{"unsigned_short": "u2", "int": "i4", "unsigned_int": "u4", "long": "i8", "float": "f4"},
    **{"unsigned_long": "u8", "double": "f8", "vtkidtype": "i4", "vtktypeint8": "i1"},
    **{"vtktypeuint8": "u1", "vtktypeint16": "i2", "vtktypeuint16": "u2", "vtktypeint32": "i4"},
    **{"vtktypeuint32": "u4", "vtktypeint64": "i8", "vtktypeuint64": "u8"},
}
_CELLS = {"vertices", "lines", "polygons", "triangle_strips", "cells"}
_PER_ROW = {"vectors": 3, "normals": 3, "tensors": 9, "tensors6": 6, "global_ids": 1}
_PER_ROW |= {"pedigree_ids": 1, "edge_flags": 1}
_NUMBERS_ON_THE_LINE = {"dataset", "dimensions", "spacing", "aspect_ratio", "origin"}


def check_legacy(path: Path) -> None:
    """Walk all sections of a legacy VTK file.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    GeometryError
        The file ends within a section, or a section is damaged or unknown.
    """
    _Walk(path).run()


class _Walk:
    """The unread bytes of a file."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.rest = path.read_bytes()
        self.n_rows = 0
        self.n_points = self.n_cells = 0
        self.highest_corner = -1
        head = [self.line() for _ in range(3)]
        self.is_binary = head[2].strip().upper() == "BINARY"
        is_known = self.is_binary or head[2].strip().upper() == "ASCII"
        version = re.fullmatch(r"# vtk DataFile Version +(\d)\.(\d{1,2})\s*", head[0])
        if version is None or not is_known:
            raise self.fault(f"the file begins with {head[0][:40]!r}")
        self.has_offsets = int(version[1]) >= 5

    def run(self) -> None:
        """Walk all sections."""
        while self.rest.strip():
            line = self.line()
            words = line.lower().split()
            if not words:
                continue
            try:
                self.section(words)
            except (IndexError, ValueError, KeyError) as error:
                raise self.fault(f"a section begins with {line[:60]!r}") from error
        if self.highest_corner >= self.n_points:
            raise self.fault(
                f"a cell has the corner {self.highest_corner}, and there are {self.n_points} points"
            )

    def section(self, words: list[str]) -> None:
        """Walk the section with the given first line."""
        keyword = words[0]
        if keyword in _NUMBERS_ON_THE_LINE:
            return
        if keyword in ("points", "x_coordinates", "y_coordinates", "z_coordinates"):
            width = 3 if keyword == "points" else 1
            self.n_points = int(words[1])
            self.take(width * int(words[1]), words[2], keyword)
        elif keyword in _CELLS:
            self.cells(keyword, int(words[1]), int(words[2]))
        elif keyword == "cell_types":
            if int(words[1]) != self.n_cells:
                raise self.fault(f"{words[1]} types belong to {self.n_cells} cells")
            self.take(int(words[1]), "int", keyword)
        elif keyword in ("point_data", "cell_data"):
            self.n_rows = int(words[1])
        elif keyword == "scalars":
            if self.rest.lstrip()[:12].lower() == b"lookup_table":
                self.rest = self.rest.lstrip()
                self.line()
            self.take(self.n_rows * int(words[3] if len(words) > 3 else 1), words[2], keyword)
        elif keyword in ("color_scalars", "lookup_table"):
            n = self.n_rows * int(words[2]) if keyword[0] == "c" else 4 * int(words[2])
            self.take(n, "unsigned_char", keyword)
        elif keyword == "texture_coordinates":
            self.take(self.n_rows * int(words[2]), words[3], keyword)
        elif keyword in _PER_ROW:
            self.take(self.n_rows * _PER_ROW[keyword], words[2], keyword)
        elif keyword == "field":
            self.fields(int(words[2]))
        elif keyword == "metadata":
            self.metadata()
        else:
            raise ValueError(keyword)

    def fields(self, n_arrays: int) -> None:
        """Walk the arrays of a field."""
        for _ in range(n_arrays):
            self.rest = self.rest.lstrip()
            words = self.line().lower().split()
            if words[:1] == ["metadata"]:
                self.metadata()
                self.rest = self.rest.lstrip()
                words = self.line().lower().split()
            self.take(int(words[1]) * int(words[2]), words[3], words[0])

    def metadata(self) -> None:
        """Walk a section that ends with an empty line."""
        while self.rest:
            if not self.line().strip():
                return
        raise self.fault("the file ends within `metadata`")

    def cells(self, keyword: str, n: int, size: int) -> None:
        """Walk cells, in the form of version 5 (offsets) or earlier (a count before each cell)."""
        if (self.rest.lstrip()[:7].lower() == b"offsets") != self.has_offsets:
            raise self.fault(f"`{keyword}` is not written as the version of the file says")
        if self.has_offsets:
            arrays = []
            for count in (n, size):
                self.rest = self.rest.lstrip()
                arrays.append(self.take(count, self.line().lower().split()[1], keyword))
            starts, corners = arrays
            ends = starts[:1].tolist() + starts[-1:].tolist()
            if ends not in ([], [0, size]) or (np.diff(starts) < 0).any():
                raise self.fault(f"the offsets of `{keyword}` do not rise from 0 to {size}")
            self.n_cells = max(n - 1, 0)
        else:
            values = self.take(size, "int", keyword)
            counts, end = count_lists(values, n)
            if (len(counts), end) != (n, size):
                raise self.fault(f"`{keyword}` promises {n} cells, the file holds {len(counts)}")
            is_corner = np.ones(size, dtype=np.bool_)
            is_corner[np.cumsum(counts + 1) - counts - 1] = False
            corners = values[is_corner]
            self.n_cells = n
        if len(corners) and corners.min() < 0:
            raise self.fault(f"`{keyword}` has the corner {corners.min():g}")
        self.highest_corner = max(self.highest_corner, int(corners.max(initial=-1)))

    def take(self, n: int, kind: str, what: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """Read and return some numbers."""
        if kind == "variant":
            raise self.fault(
                f"`{what}` is an array of variants", remedy="leave it out, or save as .vtu"
            )
        if n < 0:
            raise ValueError(n)
        if kind == "string":
            self.strings(n, what)
            return np.empty(0)
        if not self.is_binary:
            words = self.rest.split(None, n) if n else [self.rest]
            self.require(what, n, min(len(words), n))
            self.rest = words[n] if len(words) > n else b""
            return numbers_of(words[:n], self.path, what=what)
        dtype = np.dtype(">" + _TYPES[kind])
        size = (n + 7) // 8 if kind == "bit" else n * dtype.itemsize
        self.require(what, size, min(size, len(self.rest)), "bytes")
        chosen, self.rest = self.rest[:size], self.rest[size:]
        return np.frombuffer(chosen, dtype=dtype).astype(np.float64)

    def strings(self, n: int, what: str) -> None:
        """Walk some texts, which are lines, or in binary files follow their lengths."""
        for k in range(n):
            if not self.rest:
                raise self.fault(f"`{what}` promises {n} texts, the file holds {k}")
            if not self.is_binary:
                self.line()
                continue
            n_bytes = (8, 4, 2, 1)[self.rest[0] >> 6]  # The first two bits encode this number.
            length = int.from_bytes(self.rest[:n_bytes], "big") & ((1 << (8 * n_bytes - 2)) - 1)
            self.require(what, n_bytes + length, len(self.rest), "bytes")
            self.rest = self.rest[n_bytes + length :]

    def require(self, what: str, wanted: int, found: int, unit: str = "numbers") -> None:
        """Raise an error if the file is cut off."""
        if found < wanted:
            raise self.fault(f"`{what}` promises {wanted} {unit}, the file holds {found}")

    def line(self) -> str:
        """Read and return a line."""
        found, _, self.rest = self.rest.partition(b"\n")
        return found.decode(errors="replace")

    def fault(self, found: str, *, remedy: str = "") -> GeometryError:
        """Return the error for a fault of the file."""
        expected = "a complete VTK file"
        if remedy:
            return damaged(self.path, found, expected=expected, remedy=remedy)
        return damaged(self.path, found, expected=expected)
