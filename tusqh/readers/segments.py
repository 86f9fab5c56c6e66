"""Read a CSV file of segments: a header ``x0,y0,x1,y1``, then one segment per row."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from tusqh.errors import GeometryError
from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray
from tusqh.readers.loose import join_loose
from tusqh.readers.reading import Reading

#: The header of the file.
SEGMENT_COLUMNS = ("x0", "y0", "x1", "y1")


def read(path: Path) -> Reading:
    """Read every row as a chain of two points.

    If the directions of segments contradict each other, the segments are loose lines: they are
    chained by their end points, and rings follow the even-odd rule, see `tusqh.readers.loose`.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Reading
        The geometry, with remarks if segments were chained.

    Raises
    ------
    GeometryError
        The header differs, a row is not four numbers, or the outline is empty, without extent or
        not finite.
    """
    with path.open(newline="", encoding="utf-8-sig") as file:
        rows = csv.reader(file, skipinitialspace=True)
        header = tuple(name.strip() for name in next(rows, []))
        if header != SEGMENT_COLUMNS:
            raise GeometryError(
                f"the columns are {','.join(header) or '(none)'}",
                where=f"{path}, line 1",
                expected=f"the header {','.join(SEGMENT_COLUMNS)}",
                remedy="give one segment per row: start x and y, end x and y",
            )
        chains = [_as_segment(row, where=f"{path}, line {rows.line_num}") for row in rows if row]
    if not _is_directed(chains):
        joined, remarks = join_loose(chains)
        return Reading(Outline.from_chains(joined, name=path.name), tuple(remarks))
    return Reading(Outline.from_chains(chains, name=path.name))


def _is_directed(chains: list[FloatArray]) -> bool:
    """Return whether equally many of the segments that meet at a point start and end there.

    A point of a single segment is an open end, not a contradiction.
    """
    if not chains or not all(np.isfinite(chain).all() for chain in chains):
        return True
    ends = np.concatenate(chains) + 0.0  # Adding zero makes -0.0 equal to 0.0 in every bit.
    _, point = np.unique(ends, axis=0, return_inverse=True)
    degree = np.bincount(point.ravel())
    balance = np.bincount(point.ravel(), weights=np.tile([-1.0, 1.0], len(chains)))
    return not ((np.abs(balance) > 1) | ((balance != 0) & (degree > 1) & (degree % 2 == 0))).any()


def _as_segment(row: list[str], *, where: str) -> FloatArray:
    """Return a row of four numbers as two points."""
    try:
        return np.array([float(entry) for entry in row]).reshape(2, 2)
    except ValueError as error:
        raise GeometryError(
            f"the row {','.join(row)!r} is not four numbers",
            where=where,
            expected="x0,y0,x1,y1",
            remedy="correct or remove that row",
        ) from error
