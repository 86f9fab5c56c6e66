"""Cut the polygons of surface files into triangles, and make the error for damaged files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tusqh.errors import GeometryError
from tusqh.geometry.remark import Remark
from tusqh.grid import FloatArray, IntArray

#: Longer words are not put into an array, because all its rows would be as long as the longest.
_LONGEST_NUMBER = 40


def cut_polygons(corners: IntArray, counts: IntArray) -> tuple[IntArray, IntArray]:
    """Return the triangles of polygons, each a fan about its first corner.

    The fan of a planar polygon, convex or not, encloses the same volume as the polygon.

    Parameters
    ----------
    corners
        Points at the corners of all polygons, one polygon after the other, shape (sum of counts,).
    counts
        Number of corners of every polygon, shape (n,).

    Returns
    -------
    triangles : numpy.ndarray
        Shape (m, 3), in the order of the polygons; polygons of fewer than three corners have none.
    polygon : numpy.ndarray
        The polygon of every triangle, shape (m,).

    Examples
    --------
    >>> triangles, polygon = cut_polygons(np.array([0, 1, 2, 3, 4, 5, 6]), np.array([4, 3]))
    >>> triangles.tolist(), polygon.tolist()
    ([[0, 1, 2], [0, 2, 3], [4, 5, 6]], [0, 0, 1])
    """
    n_triangles = np.maximum(counts - 2, 0)
    polygon = np.repeat(np.arange(len(counts)), n_triangles)
    first = (np.cumsum(counts) - counts)[polygon]
    rank = np.arange(len(polygon)) - (np.cumsum(n_triangles) - n_triangles)[polygon]
    places = np.stack([first, first + rank + 1, first + rank + 2], axis=1)
    return np.asarray(corners, dtype=np.int64)[places], polygon


def cut_strips(corners: IntArray, counts: IntArray) -> IntArray:
    """Return the triangles of strips; every second triangle of a strip is reversed.

    Parameters
    ----------
    corners
        Points of all strips, one strip after the other, shape (sum of counts,).
    counts
        Number of points of every strip, shape (n,).

    Returns
    -------
    numpy.ndarray
        Shape (m, 3), without triangles with two equal corners, which only steer a strip.

    Examples
    --------
    >>> cut_strips(np.array([0, 1, 2, 3]), np.array([4])).tolist()
    [[0, 1, 2], [2, 1, 3]]
    """
    n_triangles = np.maximum(counts - 2, 0)
    strip = np.repeat(np.arange(len(counts)), n_triangles)
    rank = np.arange(len(strip)) - (np.cumsum(n_triangles) - n_triangles)[strip]
    first = (np.cumsum(counts) - counts)[strip] + rank
    is_odd = rank % 2
    places = np.stack([first + is_odd, first + 1 - is_odd, first + 2], axis=1)
    triangles = np.asarray(corners, dtype=np.int64)[places]
    is_steering = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    return np.asarray(triangles[~is_steering])


def polygon_remarks(counts: IntArray) -> list[Remark]:
    """Return the remarks on polygons that are cut, and on faces without an area.

    Parameters
    ----------
    counts
        Number of corners of every polygon, shape (n,).
    """
    return remarks_of(
        Remark("changed", "polygons cut into triangles", int((counts > 3).sum())),
        Remark("left out", "faces of fewer than three corners", int((counts < 3).sum())),
    )


def remarks_of(*remarks: Remark) -> list[Remark]:
    """Return the remarks whose count is not zero.

    Parameters
    ----------
    *remarks
        The remarks.
    """
    return [remark for remark in remarks if remark.count]


def without_byte_order_mark(content: bytes, path: Path) -> bytes:
    """Return text without the byte order mark that some editors prepend.

    Parameters
    ----------
    content
        The bytes of the file.
    path
        The file, for the message.

    Raises
    ------
    GeometryError
        The file is empty.
    """
    if not content.strip():
        raise damaged(path, "the file is empty", expected="a surface of triangles or polygons")
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return content.decode("utf-16").encode()
    return content.removeprefix(b"\xef\xbb\xbf")


def numbers_of(words: Sequence[bytes] | NDArray[np.bytes_], path: Path, *, what: str) -> FloatArray:
    """Return words as numbers.

    Parameters
    ----------
    words
        The words.
    path
        The file, for the message.
    what
        Meaning of the numbers in the message, such as "coordinates".

    Raises
    ------
    GeometryError
        A word is not a number.
    """
    if isinstance(words, np.ndarray) or max(map(len, words), default=0) <= _LONGEST_NUMBER:
        try:
            return np.array(words, dtype=np.bytes_).astype(np.float64)
        except ValueError:
            pass
    for word in words:
        try:
            float(word)
        except ValueError:
            shown = word.decode(errors="replace")[:40]
            has_comma = "," in shown
            raise damaged(
                path,
                f"{what} include {shown!r}, which is not a number",
                expected="numbers with a decimal point"
                if has_comma
                else "numbers such as -1.5 or 2e-3",
                remedy="export the file with a decimal point instead of the decimal comma"
                if has_comma
                else "export the file again; it is damaged",
            ) from None
    return np.array([float(word) for word in words])


def damaged(
    path: Path,
    found: str,
    *,
    expected: str,
    remedy: str = "copy or export the file again; it is cut off or damaged",
) -> GeometryError:
    """Return the error for a damaged file.

    Parameters
    ----------
    path
        The file.
    found
        The fault.
    expected
        What a complete file contains.
    remedy
        The remedy.
    """
    return GeometryError(found, where=str(path), expected=expected, remedy=remedy)
