"""Read the rows of a PLY file, text or binary, as columns."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numba
import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.readers.ply_header import Element, Header
from tusqh.readers.polygon_faces import damaged, numbers_of


class Lists(NamedTuple):
    """A property that is a list: entries of all rows, and the number of entries of each row."""

    entries: FloatArray
    counts: IntArray


#: The properties of an element by name.
Columns = dict[str, "FloatArray | Lists"]


def read_rows(header: Header, body: bytes, path: Path) -> tuple[dict[str, Columns], int]:
    """Return the properties of all elements, and the number of bytes or words after them.

    Parameters
    ----------
    header
        The header, which describes the rows.
    body
        The bytes after the header.
    path
        The file, for messages.

    Returns
    -------
    columns : dict
        For every element name, the properties by name.
    n_surplus : int
        Bytes of a binary file, or words of a text, after the last row.

    Raises
    ------
    GeometryError
        The file holds fewer rows than its header states.
    """
    columns: dict[str, Columns] = {}
    if header.encoding == "ascii":
        words = body.split()
        values = numbers_of(words, path, what="rows")
        place = 0
        for element in header.elements:
            columns[element.name], place = _from_words(element, values, place, path)
        return columns, len(words) - place
    data = np.frombuffer(body, dtype=np.uint8)
    is_big = header.encoding == "binary_big_endian"
    place = 0
    for element in header.elements:
        columns[element.name], place = _from_bytes(element, data, place, is_big, path)
    return columns, len(body) - place


def count_lists(values: FloatArray, n_lists: int) -> tuple[IntArray, int]:
    """Return the lengths of consecutive lists, each preceded by its length, and the place after.

    Parameters
    ----------
    values
        Counts and entries, shape (n,).
    n_lists
        Expected number of lists.

    Returns
    -------
    counts : numpy.ndarray
        Number of entries of every complete list, shape (n_whole,).
    end : int
        The place after the last complete list.

    Examples
    --------
    >>> counts, end = count_lists(np.array([2.0, 7, 8, 1, 9]), 2)
    >>> counts.tolist(), end
    ([2, 1], 5)
    """
    is_list = np.ones(1, dtype=np.bool_)
    _, counts, end, n_whole = _walk_words(values, 0, min(n_lists, len(values)), is_list)
    return counts[:n_whole, 0], int(end)


def _from_words(
    element: Element, values: FloatArray, place: int, path: Path
) -> tuple[Columns, int]:
    """Return the properties of an element of a text file, and the place after it."""
    is_list = np.array([p.count_type is not None for p in element.properties], dtype=np.bool_)
    if not element.has_lists:
        width = len(element.properties)
        rows = values[place : place + width * element.n_rows]
        _require(element, len(rows) // max(width, 1), path)
        table = rows.reshape(element.n_rows, width)
        columns: Columns = {
            p.name: _rounded(table[:, k], p.type) for k, p in enumerate(element.properties)
        }
        return columns, place + width * element.n_rows
    n_rows = min(element.n_rows, len(values))
    starts, counts, end, n_whole = _walk_words(values, place, n_rows, is_list)
    _require(element, n_whole if n_rows == element.n_rows else n_rows, path)
    result: Columns = {}
    for k, p in enumerate(element.properties):
        entries = _rounded(values[spread(starts[:, k], counts[:, k], 1)], p.type)
        result[p.name] = Lists(entries, counts[:, k]) if is_list[k] else entries
    return result, int(end)


def _from_bytes(
    element: Element, data: np.typing.NDArray[np.uint8], place: int, is_big: bool, path: Path
) -> tuple[Columns, int]:
    """Return the properties of an element of a binary file, and the place after it."""
    order = ">" if is_big else "<"
    if not element.has_lists:
        names = [f"{k}" for k in range(len(element.properties))]
        row = np.dtype({"names": names, "formats": [order + p.type for p in element.properties]})
        end = place + row.itemsize * element.n_rows
        _require(element, (len(data) - place) // max(row.itemsize, 1), path)
        table = data[place:end].view(row) if element.n_rows else np.empty(0, dtype=row)
        columns: Columns = {
            p.name: table[name].astype(np.float64)
            for p, name in zip(element.properties, names, strict=True)
        }
        return columns, end
    sizes = np.array([int(p.type[1]) for p in element.properties])
    count_sizes = np.array([int((p.count_type or "u0")[1]) for p in element.properties])
    n_rows = min(element.n_rows, len(data))
    starts, counts, end, n_whole = _walk_bytes(data, place, n_rows, sizes, count_sizes, is_big)
    _require(element, n_whole if n_rows == element.n_rows else n_rows, path)
    result: Columns = {}
    for k, p in enumerate(element.properties):
        places = spread(starts[:, k], counts[:, k], sizes[k])
        chosen = data[places[:, None] + np.arange(sizes[k])]
        entries = chosen.reshape(-1).view(order + p.type).astype(np.float64)
        result[p.name] = Lists(entries, counts[:, k]) if p.count_type else entries
    return result, int(end)


def _rounded(values: FloatArray, type_name: str) -> FloatArray:
    """Return numbers in the precision that the header states."""
    return values.astype(np.float32).astype(np.float64) if type_name == "f4" else values


def _require(element: Element, n_found: int, path: Path) -> None:
    """Raise an error if rows are missing."""
    if n_found < element.n_rows:
        raise damaged(
            path,
            f"the header promises {element.n_rows} rows of `{element.name}`, the file holds "
            f"{n_found}",
            expected="as many rows as the header promises",
        )


def spread(starts: IntArray, counts: IntArray, step: int) -> IntArray:
    """Return arithmetic sequences (start, start + step, ...), one after the other.

    Parameters
    ----------
    starts
        First terms of the sequences, shape (n,).
    counts
        Numbers of terms, shape (n,).
    step
        Difference between two terms.

    Examples
    --------
    >>> spread(np.array([5, 20]), np.array([3, 1]), 2).tolist()
    [5, 7, 9, 20]
    """
    first = np.cumsum(counts) - counts
    rank = np.arange(int(counts.sum())) - np.repeat(first, counts)
    return np.repeat(starts, counts) + step * rank


@numba.njit(cache=True)
def _walk_words(values, place, n_rows, is_list):  # type: ignore[no-untyped-def]
    """Return places and counts of entries, the place after the last row, and complete rows."""
    width = len(is_list)
    starts = np.zeros((n_rows, width), dtype=np.int64)
    counts = np.ones((n_rows, width), dtype=np.int64)
    for r in range(n_rows):
        for k in range(width):
            if is_list[k]:
                if place >= len(values) or not 0 <= values[place] <= len(values):
                    return starts, counts, place, r
                counts[r, k] = int(values[place])
                place += 1
            starts[r, k] = place
            place += counts[r, k]
            if place > len(values):
                return starts, counts, place, r
    return starts, counts, place, n_rows


@numba.njit(cache=True)
def _walk_bytes(data, place, n_rows, sizes, count_sizes, is_big):  # type: ignore[no-untyped-def]
    """Return the same for bytes; `count_sizes` is 0 for properties that are not lists."""
    width = len(sizes)
    starts = np.zeros((n_rows, width), dtype=np.int64)
    counts = np.ones((n_rows, width), dtype=np.int64)
    for r in range(n_rows):
        for k in range(width):
            size = count_sizes[k]
            if size:
                if place + size > len(data):
                    return starts, counts, place, r
                n = 0
                for b in range(size):
                    shift = size - 1 - b if is_big else b
                    n |= int(data[place + b]) << (8 * shift)
                if n > len(data):
                    return starts, counts, place, r
                counts[r, k] = n
                place += size
            starts[r, k] = place
            place += counts[r, k] * sizes[k]
            if place > len(data):
                return starts, counts, place, r
    return starts, counts, place, n_rows
