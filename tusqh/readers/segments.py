"""Read a CSV file of loose segments: a header ``x0,y0,x1,y1``, then one segment per row."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from tusqh.errors import GeometryError
from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray
from tusqh.readers.reading import Reading

#: The header of the file.
SEGMENT_COLUMNS = ("x0", "y0", "x1", "y1")


def read(path: Path) -> Reading:
    """Read every row as a chain of two points.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Reading
        The geometry.

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
    return Reading(Outline.from_chains(chains, name=path.name))


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
