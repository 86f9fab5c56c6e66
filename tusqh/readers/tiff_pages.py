"""Follow the pages of a TIFF file one by one, and check that all their data is present."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any, BinaryIO

from tusqh.errors import GeometryError

#: For each file version, the formats of an offset and of a number of tags, and the bytes of a tag.
_KINDS = {42: ("I", "H", 12), 43: ("Q", "Q", 20)}


def count_pages(path: Path) -> int:
    """Follow the chain of pages of a TIFF file to its end and return their number.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    int
        Number of pages.

    Raises
    ------
    GeometryError
        The chain leaves the file or forms a loop, so the file is cut off or damaged.
    ValueError
        The file does not start like a TIFF file.
    """
    n_bytes = path.stat().st_size
    with path.open("rb") as file:
        order = {b"II": "<", b"MM": ">"}.get(file.read(2))
        version = _unpack(file, f"{order}H") if order else 0
        if order is None or version not in _KINDS:
            raise ValueError("it does not start like a TIFF file")
        offset_format, number_format, tag_bytes = _KINDS[version]
        if version == 43:
            file.seek(8)
        seen: set[int] = set()
        offset = _unpack(file, order + offset_format)
        while offset:
            if offset in seen or not 8 <= offset < n_bytes:
                raise _cut(path, f"page {len(seen) + 1} would start at byte {offset:,}", n_bytes)
            seen.add(offset)
            file.seek(offset)
            try:
                n_tags = _unpack(file, order + number_format)
                file.seek(n_tags * tag_bytes, 1)
                offset = _unpack(file, order + offset_format)
            except (struct.error, OverflowError, OSError):
                raise _cut(path, f"page {len(seen)} has no end", n_bytes) from None
    return len(seen)


def check_data(path: Path, series: Any) -> int:
    """Check that the file has all data of a series, and return the number of empty parts.

    Parameters
    ----------
    path
        The file.
    series
        A `tifffile.TiffPageSeries`.

    Returns
    -------
    int
        Number of strips and tiles without data.

    Raises
    ------
    GeometryError
        A page is missing, or its data lies beyond the end of the file.
    """
    n_bytes = path.stat().st_size
    if series.dataoffset is not None:
        end = series.dataoffset + series.size * series.dtype.itemsize
        if end > n_bytes:
            raise _cut(path, f"the image would end at byte {end:,}", n_bytes)
    n_empty = 0
    for number, page in enumerate(series.pages, start=1):
        if page is None:
            raise GeometryError(
                f"page {number} of {len(series.pages)} is missing",
                where=str(path),
                expected="all pages in this file",
                remedy="put all files of the series into its folder, or export it as one file",
            )
        extents = list(zip(page.dataoffsets, page.databytecounts, strict=False))
        end = max((start + length for start, length in extents), default=0)
        if end > n_bytes:
            raise _cut(path, f"page {number} would end at byte {end:,}", n_bytes)
        n_empty += sum(1 for start, length in extents if not (start and length))
    return n_empty


def _unpack(file: BinaryIO, form: str) -> int:
    """Return the next number of a file."""
    number: int = struct.unpack(form, file.read(struct.calcsize(form)))[0]
    return number


def _cut(path: Path, found: str, n_bytes: int) -> GeometryError:
    """Return the error for a file that is cut off."""
    return GeometryError(
        f"{found}, but the file has {n_bytes:,} bytes",
        where=str(path),
        expected="a complete file: it is cut off or damaged",
        remedy="copy or download it again, or export it again",
    )
