"""Read the polygons and triangle strips of a PLY file, text or binary."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tusqh.geometry.remark import Remark
from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray, IntArray
from tusqh.readers.ply_header import read_header
from tusqh.readers.ply_rows import Columns, Lists, read_rows
from tusqh.readers.polygon_faces import (
    cut_polygons,
    cut_strips,
    damaged,
    polygon_remarks,
    remarks_of,
    without_byte_order_mark,
)
from tusqh.readers.reading import Reading

_USED = ("vertex", "face", "tristrips")
_CORNERS = ("vertex_indices", "vertex_index")


def read(path: Path) -> Reading:
    """Read all faces and triangle strips as a soup of one part.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Reading
        The geometry, with remarks on polygons, strips and elements of other kinds.

    Raises
    ------
    GeometryError
        The header is damaged, the file holds fewer rows than its header states, or the soup is
        empty, without extent or not finite.
    """
    content = without_byte_order_mark(path.read_bytes(), path)
    header, body = read_header(content, path)
    rows, n_surplus = read_rows(header, body, path)
    points = _points(rows.get("vertex", {}), path)
    corners, counts = _lists(rows.get("face", {}), path)
    triangles, _ = cut_polygons(corners, counts)
    strips = _strips(*_lists(rows.get("tristrips", {}), path))
    triangles = np.concatenate([triangles, strips])
    parts = np.zeros(len(triangles), dtype=np.int64)
    soup = Soup(points=points, triangles=triangles, parts=parts, name=path.name)
    others = [
        Remark("left out", f"rows of `{element.name}`", element.n_rows)
        for element in header.elements
        if element.name not in _USED
    ]
    what = "words" if header.encoding == "ascii" else "bytes"
    remarks = remarks_of(
        Remark("changed", "triangles cut from strips", len(strips)),
        *others,
        Remark("left out", f"{what} after the last row", n_surplus),
    )
    return Reading(soup, (*polygon_remarks(counts), *remarks))


def _points(columns: Columns, path: Path) -> FloatArray:
    """Return the coordinates of the vertices."""
    axes = [columns.get(axis) for axis in "xyz"]
    if any(axis is None or isinstance(axis, Lists) for axis in axes):
        raise damaged(
            path,
            f"the vertices have the properties {', '.join(columns) or '(none)'}",
            expected="vertices with the properties x, y and z",
            remedy="export the surface with three coordinates",
        )
    return np.stack([np.asarray(axis, dtype=np.float64) for axis in axes], axis=1)


def _lists(columns: Columns, path: Path) -> tuple[IntArray, IntArray]:
    """Return the points of all faces or strips, one after the other, and the count of each."""
    for name in _CORNERS:
        found = columns.get(name)
        if isinstance(found, Lists):
            if not (found.entries == np.trunc(found.entries)).all():
                raise damaged(path, "a corner is not a whole number", expected="whole numbers")
            return found.entries.astype(np.int64), found.counts
    if columns and len(next(iter(columns.values()))):
        raise damaged(
            path,
            f"the faces have the properties {', '.join(columns)}",
            expected="faces with the property vertex_indices",
        )
    none = np.empty(0, dtype=np.int64)
    return none, none


def _strips(points: IntArray, counts: IntArray) -> IntArray:
    """Return the triangles of strips; -1 separates one strip from the next."""
    is_end = points == -1
    row = np.repeat(np.arange(len(counts)), counts)
    strip = np.cumsum(is_end) + row
    kept = ~is_end
    _, lengths = np.unique(strip[kept], return_counts=True)
    return cut_strips(points[kept], lengths)
