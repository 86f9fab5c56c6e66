"""Read the triangles of an STL file.

STL has no connectivity, so every triangle has its own corners; only equal coordinates show which
triangles meet, see `tusqh.geometry.soup.Soup.matched`.
"""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np

from tusqh.geometry.remark import Remark
from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray, IntArray
from tusqh.readers.polygon_faces import (
    cut_polygons,
    damaged,
    numbers_of,
    polygon_remarks,
    without_byte_order_mark,
)
from tusqh.readers.reading import Reading

_EXPECTED = "a complete STL file"
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_BORDER = re.compile(rb"^[ \t]*(end[ \t]*solid|solid)\b([^\n]*)", re.MULTILINE | re.IGNORECASE)


def read(path: Path) -> Reading:
    """Read every solid of the file as a part of the soup.

    Parameters
    ----------
    path
        The file, binary or text.

    Returns
    -------
    Reading
        The geometry, with remarks on surplus bytes and on facets of more than three corners.

    Raises
    ------
    GeometryError
        The file is incomplete, its size contradicts its count, or the soup is empty, without
        extent or not finite.
    """
    content = path.read_bytes()
    if _is_text(content):
        return _read_text(without_byte_order_mark(content, path), path)
    return _read_binary(content, path)


def _is_text(content: bytes) -> bool:
    """Return whether the file is text, although some binary files also begin with ``solid``."""
    start = content[:512].removeprefix(b"\xef\xbb\xbf").lstrip()
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return True
    if len(content) >= 84:
        (n_triangles,) = struct.unpack("<I", content[80:84])
        if len(content) == 84 + 50 * n_triangles:
            return False
    return start[:5].lower() in (b"solid", b"facet") and b"\0" not in start


def _read_binary(content: bytes, path: Path) -> Reading:
    """Return the triangles of a binary file whose size agrees with its count."""
    size = len(content)
    if size < 84:
        raise damaged(
            path, f"the file has {size} bytes, too few for an STL header", expected=_EXPECTED
        )
    (n_stated,) = struct.unpack("<I", content[80:84])
    n_found, n_surplus = divmod(size - 84, 50)
    if n_found != n_stated:
        raise damaged(
            path,
            f"the header promises {n_stated} triangles, the file holds {n_found}",
            expected=_EXPECTED,
        )
    facets = np.frombuffer(content, dtype=_FACET, count=n_found, offset=84)
    points = facets["corners"].astype(np.float64).reshape(-1, 3)
    soup = Soup(
        points,
        np.arange(3 * n_found).reshape(-1, 3),
        np.zeros(n_found, dtype=np.int64),
        name=path.name,
    )
    surplus = [Remark("left out", "bytes after the last triangle", n_surplus)] if n_surplus else []
    return Reading(soup, tuple(surplus))


def _read_text(content: bytes, path: Path) -> Reading:
    """Return the facets of all solids of a text file."""
    text = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    borders = list(_BORDER.finditer(text))
    is_end = [border[1][:3].lower() == b"end" for border in borders]
    if not is_end or not is_end[-1] or text[borders[-1].end() :].strip():
        raise damaged(path, "the text ends before `endsolid`", expected=_EXPECTED)
    starts = [0, *(border.end() for border in borders)]
    stops = [*(border.start() for border in borders), len(text)]
    names = [b"", *(b"" if e else b[2].strip() for b, e in zip(borders, is_end, strict=True))]
    solids = [
        (text[a:b], name)
        for a, b, name in zip(starts, stops, names, strict=True)
        if text[a:b].strip()
    ]
    facets = [_facets(solid.lower().split(), path) for solid, _ in solids]
    if not facets:
        raise damaged(path, "the text has no facet", expected=_EXPECTED)
    points = np.concatenate([points for points, _ in facets])
    counts = np.concatenate([counts for _, counts in facets])
    triangles, facet = cut_polygons(np.arange(len(points)), counts)
    parts = np.repeat(np.arange(len(facets)), [len(counts) for _, counts in facets])
    soup = Soup(
        points,
        triangles,
        parts[facet].astype(np.int64),
        name=path.name,
        part_names=tuple(name.decode("utf-8", errors="replace") for _, name in solids),
    )
    return Reading(soup, tuple(polygon_remarks(counts)))


def _facets(words: list[bytes], path: Path) -> tuple[FloatArray, IntArray]:
    """Return the corners of the facets of a solid, and the number of corners of each."""
    regular = b"facet normal % % % outer loop vertex % % % vertex % % % vertex % % % "
    pattern = (regular + b"endloop endfacet").split()
    is_regular = len(words) % len(pattern) == 0 and all(
        set(words[k :: len(pattern)]) == {word} for k, word in enumerate(pattern) if word != b"%"
    )
    if is_regular:
        columns = [
            numbers_of(words[k :: len(pattern)], path, what="coordinates")
            for k in (8, 9, 10, 12, 13, 14, 16, 17, 18)
        ]
        points = np.stack(columns, axis=1).reshape(-1, 3)
        return points, np.full(len(points) // 3, 3, dtype=np.int64)
    return _irregular_facets(words, path)


def _irregular_facets(words: list[bytes], path: Path) -> tuple[FloatArray, IntArray]:
    """Return the same for facets without a normal or with other numbers of corners."""
    array = np.array([word[:8] for word in words])
    opened = np.flatnonzero(array == b"facet")
    closed = np.flatnonzero(array == b"endfacet")
    vertices = np.flatnonzero(array == b"vertex")
    if len(opened) != len(closed) or not (opened < closed).all() or len(closed) == 0:
        raise damaged(
            path,
            f"{len(opened)} facets begin and {len(closed)} end",
            expected="`endfacet` at the end of every facet",
        )
    if len(vertices) and vertices[-1] + 3 >= len(words):
        raise damaged(path, "the last vertex has no coordinates", expected=_EXPECTED)
    keywords = {b"facet", b"normal", b"outer", b"loop", b"vertex", b"endloop", b"endfacet"}
    n_numbers = sum(word not in keywords for word in words)
    n_normals = int((array == b"normal").sum())
    if n_numbers != 3 * (len(vertices) + n_normals):
        wrong = [w for w in words if w not in keywords]
        numbers_of(wrong, path, what="coordinates")
        raise damaged(
            path,
            f"{len(vertices)} vertices and {n_normals} normals have {n_numbers} numbers",
            expected="three numbers for each",
        )
    coordinates = [word for k in vertices.tolist() for word in words[k + 1 : k + 4]]
    points = numbers_of(coordinates, path, what="coordinates")
    facet = np.searchsorted(opened, vertices) - 1
    return points.reshape(-1, 3), np.bincount(facet, minlength=len(opened))
