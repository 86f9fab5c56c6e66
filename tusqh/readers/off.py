"""Read the polygons of an OFF file (Geomview) in its variants."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tusqh.errors import GeometryError
from tusqh.geometry.remark import Remark
from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray, IntArray
from tusqh.readers.ply_rows import count_lists, spread
from tusqh.readers.polygon_faces import (
    cut_polygons,
    damaged,
    numbers_of,
    polygon_remarks,
    remarks_of,
    without_byte_order_mark,
)
from tusqh.readers.reading import Reading

_KEYWORD = re.compile(rb"(ST)?(C)?(N)?(4)?(n)?OFF\b[ \t]*(BINARY)?")
#: Longer words are truncated, since no number has that many digits.
_LONGEST_WORD = 60
_EXPECTED = "text that begins with OFF, then the numbers of points, faces and edges"

Words = NDArray[np.bytes_]


class _Rows(NamedTuple):
    """The words of a text, and the number of words in each row."""

    words: Words
    lengths: IntArray

    @property
    def starts(self) -> IntArray:
        """The first word of every row."""
        return np.cumsum(self.lengths) - self.lengths


class _Header(NamedTuple):
    """The header: whether points are homogeneous, and which further numbers they have."""

    is_homogeneous: bool
    n_extra: int
    has_colours: bool


def read(path: Path) -> Reading:
    """Read all faces as a soup of one part.

    Points of ``4OFF`` are divided by their fourth coordinate; normals, colours and texture
    coordinates (``NOFF``, ``COFF``, ``STOFF``) are left out, and so are colours of faces.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Reading
        The geometry, with remarks on polygons and homogeneous coordinates.

    Raises
    ------
    GeometryError
        The file is binary, its dimension is not 3, its counts contradict its header, or the soup is
        empty, without extent or not finite.
    """
    content = without_byte_order_mark(path.read_bytes(), path)
    header, text = _header(re.sub(rb"#[^\r\n]*", b"", content), path)
    n_points, n_faces, rows = _counts(text, path)
    width = (4 if header.is_homogeneous else 3) + header.n_extra
    if len(rows.lengths) != n_points + n_faces:
        rows = _rows_of_words(rows.words, n_points, n_faces, width, path) or rows
    n_rows = len(rows.lengths)
    if n_rows < n_points + n_faces:
        raise damaged(
            path,
            f"the header promises {n_points} points and {n_faces} faces, the file holds "
            f"{min(n_rows, n_points)} and {max(n_rows - n_points, 0)}",
            expected="as many points and faces as the header promises",
        )
    points = _points(rows, n_points, header, path)
    corners, counts = _faces(rows, n_points, n_faces, path)
    triangles, polygon = cut_polygons(corners, counts)
    soup = Soup(points, triangles, np.zeros(len(polygon), dtype=np.int64), name=path.name)
    n_surplus = n_rows - n_points - n_faces
    remarks = remarks_of(
        Remark("changed", "points divided by their fourth coordinate", n_points)
        if header.is_homogeneous
        else Remark("left out", "lines after the last face", n_surplus),
    )
    return Reading(soup, (*polygon_remarks(counts), *remarks))


def _header(text: bytes, path: Path) -> tuple[_Header, bytes]:
    """Return the meaning of the keyword, and the text after it."""
    text = text.lstrip()
    keyword = _KEYWORD.match(text)
    if keyword is None:
        if not text[:1].isdigit():
            shown = text[:20].split(b"\n")[0].decode(errors="replace")
            raise damaged(path, f"the file begins with {shown!r}", expected=_EXPECTED)
        return _Header(False, 0, False), text
    texture, colour, normal, four, n, binary = keyword.groups()
    if binary:
        raise damaged(
            path, "binary OFF is not supported", expected=_EXPECTED, remedy="export it as text"
        )
    rest = text[keyword.end() :]
    if n:
        dimension, _, rest = rest.lstrip().partition(b"\n")
        words = dimension.split()
        if words[:1] != [b"3"] or four:
            raise damaged(
                path,
                f"points of dimension {words[0].decode() if words else '?'}{' + 1' if four else ''}"
                " (nOFF)",
                expected="points with three coordinates",
                remedy="export the surface in three dimensions",
            )
        rest = b" ".join(words[1:]) + b"\n" + rest
    n_extra = 3 * bool(normal) + 4 * bool(colour) + 2 * bool(texture)
    return _Header(bool(four), n_extra, bool(colour)), rest


def _counts(text: bytes, path: Path) -> tuple[int, int, _Rows]:
    """Return the numbers of points and faces, and the rows after them."""
    words = text.split()
    if len(words) < 2 or not all(word.isdigit() for word in words[:3]):
        shown = b" ".join(words[:3]).decode(errors="replace")
        raise damaged(path, f"the counts are {shown!r}", expected=_EXPECTED)
    ends = np.cumsum([0, *(len(line.split()) for line in text.splitlines())])
    lengths = np.diff(np.maximum(ends - 3, 0))
    clipped = np.array([word[:_LONGEST_WORD] for word in words[3:]], dtype=np.bytes_)
    return int(words[0]), int(words[1]), _Rows(clipped, lengths[lengths > 0])


def _rows_of_words(
    words: Words, n_points: int, n_faces: int, width: int, path: Path
) -> _Rows | None:
    """Return a row for each point and face regardless of lines; None if the words do not fit."""
    if n_points * width + n_faces > len(words):
        return None
    try:
        values = numbers_of(words[n_points * width :], path, what="faces")
    except GeometryError:
        return None
    counts, end = count_lists(values, n_faces)
    if len(counts) != n_faces or end != len(values):
        return None
    return _Rows(words, np.concatenate([np.full(n_points, width), counts + 1]))


def _points(rows: _Rows, n_points: int, header: _Header, path: Path) -> FloatArray:
    """Return the coordinates of all points."""
    width = 4 if header.is_homogeneous else 3
    least = width + header.n_extra - header.has_colours  # Colours have three or four numbers.
    short = np.flatnonzero(rows.lengths[:n_points] < least)
    if len(short):
        raise damaged(
            path,
            f"point {short[0]} has {rows.lengths[short[0]]} numbers",
            expected=f"at least {least} numbers for every point",
        )
    words = rows.words[rows.starts[:n_points, None] + np.arange(width)]
    values = numbers_of(words.ravel(), path, what="coordinates").reshape(-1, width)
    if not header.is_homogeneous:
        return values
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(values[:, :3] / values[:, 3:])


def _faces(rows: _Rows, n_points: int, n_faces: int, path: Path) -> tuple[IntArray, IntArray]:
    """Return the corners of all faces, one after the other, and each face's number of corners."""
    chosen = slice(n_points, n_points + n_faces)
    starts, lengths = rows.starts[chosen], rows.lengths[chosen]
    stated = numbers_of(rows.words[starts], path, what="corner counts")
    bad = np.flatnonzero(~((stated >= 0) & (stated < lengths)))
    if len(bad):
        raise damaged(
            path,
            f"face {bad[0]} states {stated[bad[0]]:g} corners and has {lengths[bad[0]] - 1}",
            expected="as many corners as a face states",
        )
    counts = stated.astype(np.int64)
    words = rows.words[spread(starts + 1, counts, 1)]
    values = numbers_of(words, path, what="corners of faces")
    if not (np.abs(values) < 2**62).all() or (values != np.trunc(values)).any():
        raise damaged(path, "a corner is not a whole number", expected="numbers of points")
    return values.astype(np.int64), counts
