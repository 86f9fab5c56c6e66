"""Read the polygons of an OFF file (Geomview), in its variants."""

from __future__ import annotations

import re
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tusqh.geometry.remark import Remark
from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray, IntArray
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
_EXPECTED = "text that begins with OFF, then the numbers of points, faces and edges"


class _Header(NamedTuple):
    """What the keyword says: numbers of a point beside its coordinates, and homogeneous ones."""

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
        A binary file, a dimension other than 3, other counts than the header promises, or the soup
        is empty, without extent or not finite.
    """
    content = without_byte_order_mark(path.read_bytes(), path)
    header, lines = _header(re.sub(rb"#[^\r\n]*", b"", content), path)
    n_points, n_faces, rows = _counts(lines, path)
    n_lines = len(rows)
    width = (4 if header.is_homogeneous else 3) + header.n_extra
    if n_lines != n_points + n_faces:
        rows = _rows_of_words(rows, n_points, n_faces, width) or rows
    if len(rows) < n_points + n_faces:
        raise damaged(
            path,
            f"the header promises {n_points} points and {n_faces} faces, the file holds "
            f"{min(len(rows), n_points)} and {max(len(rows) - n_points, 0)}",
            expected="as many points and faces as the header promises",
        )
    points = _points(rows[:n_points], header, path)
    corners, counts = _faces(rows[n_points : n_points + n_faces], path)
    triangles, polygon = cut_polygons(corners, counts)
    soup = Soup(points, triangles, np.zeros(len(polygon), dtype=np.int64), name=path.name)
    n_surplus = len(rows) - n_points - n_faces
    remarks = remarks_of(
        Remark("changed", "points divided by their fourth coordinate", n_points)
        if header.is_homogeneous
        else Remark("left out", "lines after the last face", n_surplus),
    )
    return Reading(soup, (*polygon_remarks(counts), *remarks))


def _header(text: bytes, path: Path) -> tuple[_Header, list[bytes]]:
    """Return what the keyword says, and the lines after it."""
    text = text.lstrip()
    keyword = _KEYWORD.match(text)
    if keyword is None:
        if not text[:1].isdigit():
            shown = text[:20].split(b"\n")[0].decode(errors="replace")
            raise damaged(path, f"the file begins with {shown!r}", expected=_EXPECTED)
        return _Header(False, 0, False), text.splitlines()
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
    return _Header(bool(four), n_extra, bool(colour)), rest.splitlines()


def _counts(lines: list[bytes], path: Path) -> tuple[int, int, list[list[bytes]]]:
    """Return the numbers of points and faces, and the words of every line after them."""
    rows = [row for row in map(bytes.split, lines) if row]
    words: list[bytes] = []
    while rows and len(words) < 3:
        words += rows.pop(0)
    if len(words) < 2 or not all(word.isdigit() for word in words[:3]):
        shown = b" ".join(words[:3]).decode(errors="replace")
        raise damaged(path, f"the counts are {shown!r}", expected=_EXPECTED)
    if len(words) > 3:
        rows.insert(0, words[3:])
    return int(words[0]), int(words[1]), rows


def _rows_of_words(
    rows: list[list[bytes]], n_points: int, n_faces: int, width: int
) -> list[list[bytes]] | None:
    """Return a row for each point and face where lines mean nothing; None if words do not fit."""
    words = list(chain.from_iterable(rows))
    if n_points * width + n_faces > len(words):
        return None
    result = [words[k * width : (k + 1) * width] for k in range(n_points)]
    place = n_points * width
    for _ in range(n_faces):
        if place >= len(words) or not words[place].isdigit():
            return None
        end = place + 1 + int(words[place])
        result.append(words[place:end])
        place = end
    return result if place == len(words) else None


def _points(rows: list[list[bytes]], header: _Header, path: Path) -> FloatArray:
    """Return the coordinates of all points."""
    width = 4 if header.is_homogeneous else 3
    least = width + header.n_extra - header.has_colours  # Colours have three or four numbers.
    short = [k for k, row in enumerate(rows) if len(row) < least]
    if short:
        raise damaged(
            path,
            f"point {short[0]} has {len(rows[short[0]])} numbers",
            expected=f"at least {least} numbers for every point",
        )
    words = [word for row in rows for word in row[:width]]
    values = numbers_of(words, path, what="coordinates").reshape(-1, width)
    if not header.is_homogeneous:
        return values
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(values[:, :3] / values[:, 3:])


def _faces(rows: list[list[bytes]], path: Path) -> tuple[IntArray, IntArray]:
    """Return the corners of all faces, one after the other, and the number of each face's."""
    counts = numbers_of([row[0] for row in rows], path, what="corner counts").astype(np.int64)
    short = [k for k, (row, n) in enumerate(zip(rows, counts, strict=True)) if len(row) <= n]
    if short or (counts < 0).any():
        k = short[0] if short else int(np.flatnonzero(counts < 0)[0])
        raise damaged(
            path,
            f"face {k} states {counts[k]} corners and has {len(rows[k]) - 1}",
            expected="as many corners as a face states",
        )
    words = [w for row, n in zip(rows, counts.tolist(), strict=True) for w in row[1 : n + 1]]
    values = numbers_of(words, path, what="corners of faces")
    corners = values.astype(np.int64)
    if (corners != values).any():
        raise damaged(path, "a corner is not a whole number", expected="numbers of points")
    return corners, counts
