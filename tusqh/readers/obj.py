"""Read the polygons of an OBJ file (Wavefront)."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tusqh.geometry.connected_parts import are_apart
from tusqh.geometry.remark import Remark
from tusqh.geometry.soup import Soup
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.readers.polygon_faces import (
    cut_polygons,
    damaged,
    numbers_of,
    polygon_remarks,
    remarks_of,
    without_byte_order_mark,
)
from tusqh.readers.reading import Reading

_STATEMENT = re.compile(rb"^[ \t]*([a-z]+)[ \t]+([^\n]*)", re.MULTILINE)
#: Keyword and words of every line.
Statements = list[tuple[bytes, bytes]]
_COUNT = re.compile(rb"^#\s*(Vertices|Faces):\s*(\d+)\s*$", re.MULTILINE)
#: Statements that describe geometry which is not a polygon.
_OTHERS = {b"l": "lines", b"p": "points", b"curv": "curves", b"curv2": "curves in a surface"}
_OTHERS |= {b"surf": "free-form surfaces", b"call": "included files"}


def read(path: Path) -> Reading:
    """Read every object of the file as a part of the soup, or every group if there is one object.

    Groups are parts only if no edge lies between two of them, because many programs write the
    patches of one surface as groups.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Reading
        The geometry, with remarks on polygons, lines, points and free-form surfaces.

    Raises
    ------
    GeometryError
        The file is cut off, a number is damaged, a face refers to a vertex that does not exist,
        or the soup is empty, without extent or not finite.
    """
    content = without_byte_order_mark(path.read_bytes(), path)
    content = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    text = re.sub(rb"\\[ \t]*\n", b" ", re.sub(rb"#[^\n]*", b"", content))
    statements = _STATEMENT.findall(text)
    keywords = np.array([keyword for keyword, _ in statements], dtype="S8")
    is_vertex = keywords == b"v"
    is_face = (keywords == b"f") | (keywords == b"fo")
    points = _vertices([s for (k, s) in statements if k == b"v"], path)
    faces = [s for (k, s) in statements if k in (b"f", b"fo")]
    _check_counts(content, len(points), len(faces), path)
    corners, counts = _corners(faces, np.cumsum(is_vertex)[is_face], len(points), path)
    triangles, polygon = cut_polygons(corners, counts)
    parts, names = _parts(statements, keywords, is_face)
    if len(names) == 1:
        groups, of_groups = _groups(statements, keywords, is_face)
        if are_apart(points, triangles, groups[polygon]):
            parts, names = groups, of_groups if len(of_groups) > 1 or not names[0] else names
    others = [Remark("left out", w, int((keywords == k).sum())) for k, w in _OTHERS.items()]
    is_cut = not content.endswith(b"\n") and _ends_within_geometry(content)
    remarks = [
        *polygon_remarks(counts),
        *remarks_of(*others),
        *remarks_of(
            Remark(
                "noted",
                "last lines without a line break",
                int(is_cut),
                "check that the file is complete: OBJ states no counts",
            )
        ),
    ]
    soup = Soup(points, triangles, parts[polygon], name=path.name, part_names=names)
    return Reading(soup, tuple(remarks))


def _vertices(lines: list[bytes], path: Path) -> FloatArray:
    """Return the coordinates of all vertices, without weights and colours."""
    rows = [line.split() for line in lines]
    n_words = np.array([len(row) for row in rows], dtype=np.int64)
    if (n_words < 3).any():
        first = int(np.flatnonzero(n_words < 3)[0])
        raise damaged(
            path,
            f"vertex {first + 1} has {n_words[first]} coordinates",
            expected="three coordinates for every vertex",
        )
    words = [word for row in rows for word in row[:3]]
    return numbers_of(words, path, what="coordinates").reshape(-1, 3)


def _corners(
    faces: list[bytes], n_before: IntArray, n_points: int, path: Path
) -> tuple[IntArray, IntArray]:
    """Return the points at the corners of all faces, from 0, and each face's number of corners.

    Negative numbers count back from the last vertex before the face; `n_before`, shape (n_faces,),
    is the number of vertices before each face.
    """
    rows = [face.split() for face in faces]
    counts = np.array([len(row) for row in rows], dtype=np.int64)
    words = [word.partition(b"/")[0] for row in rows for word in row]
    values = numbers_of(words, path, what="corners of faces")
    numbers = values.astype(np.int64)
    face = np.repeat(np.arange(len(rows)), counts)
    corners = np.where(numbers < 0, n_before[face] + numbers, numbers - 1)
    is_bad = (numbers == 0) | (numbers != values) | (corners < 0) | (corners >= n_points)
    if is_bad.any():
        k = int(np.flatnonzero(is_bad)[0])
        raise damaged(
            path,
            f"face {face[k] + 1} has the corner {words[k].decode(errors='replace')}",
            expected=f"vertices from 1 to {n_points}: OBJ counts from 1, and from -1 backwards",
            remedy="copy or export the file again; it is cut off or damaged",
        )
    return corners, counts


def _parts(
    statements: Statements, keywords: NDArray[np.bytes_], is_face: BoolArray
) -> tuple[IntArray, tuple[str, ...]]:
    """Return the object of every face, numbered from 0 without gaps, and the names of objects."""
    stated = ["", *(_name(words) for keyword, words in statements if keyword == b"o")]
    numbers, parts = np.unique(np.cumsum(keywords == b"o")[is_face], return_inverse=True)
    return parts.astype(np.int64), tuple(stated[k] for k in numbers.tolist())


def _groups(
    statements: Statements, keywords: NDArray[np.bytes_], is_face: BoolArray
) -> tuple[IntArray, tuple[str, ...]]:
    """Return the group of every face and the names of groups; equal names are one group."""
    stated = ["", *(_name(words) for keyword, words in statements if keyword == b"g")]
    first = np.array([stated.index(name) for name in stated], dtype=np.int64)
    numbers, parts = np.unique(first[np.cumsum(keywords == b"g")][is_face], return_inverse=True)
    return parts.astype(np.int64), tuple(stated[k] for k in numbers.tolist())


def _name(words: bytes) -> str:
    """Return the words of a statement as a name."""
    return " ".join(words.decode("utf-8", errors="replace").split())


def _check_counts(content: bytes, n_points: int, n_faces: int, path: Path) -> None:
    """Compare the numbers of points and faces with those that MeshLab writes as comments."""
    for (keyword, stated), again in _stated(content):
        found = n_points if keyword == b"Vertices" else n_faces
        if not again and int(stated) != found:
            raise damaged(
                path,
                f"the file states {int(stated)} {keyword.decode().lower()} and holds {found}",
                expected="as many as it states in its comments",
            )


def _stated(content: bytes) -> list[tuple[tuple[bytes, bytes], bool]]:
    """Return the counts in comments, and whether there are several of the same kind."""
    found = _COUNT.findall(content)
    kinds = [kind for kind, _ in found]
    return [((kind, number), kinds.count(kind) > 1) for kind, number in found]


def _ends_within_geometry(content: bytes) -> bool:
    """Return whether the last line is a vertex or a face, so that the file may be cut off."""
    return content[content.rfind(b"\n") + 1 :].lstrip()[:2] in (b"v ", b"f ", b"v\t", b"f\t")
