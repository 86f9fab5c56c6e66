"""Canonical tables: CSV for programs, Markdown for people."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from tusqh.atomic import write_text
from tusqh.extras import require


def write_csv(path: Path, table: pd.DataFrame) -> None:
    r"""Write a table as CSV with ``\n`` line ends and the shortest exact numbers.

    Parameters
    ----------
    path
        The file to write; it appears complete or not at all.
    table
        The table; its index is not written.
    """
    write_text(path, table.to_csv(index=False, lineterminator="\n"))


def join_csv(path: Path, parts: Sequence[Path]) -> None:
    """Write the rows of CSV tables with the same columns into one table, unchanged.

    Parameters
    ----------
    path
        The file to write; it appears complete or not at all.
    parts
        The tables, in order.

    Raises
    ------
    ValueError
        A table has other columns.
    """
    tables = [part.read_text().splitlines(keepends=True) for part in parts]
    if any(table[0] != tables[0][0] for table in tables):
        raise ValueError(f"expected the same columns in {', '.join(map(str, parts))}")
    write_text(path, "".join([tables[0][0], *(row for table in tables for row in table[1:])]))


def write_markdown(path: Path, table: pd.DataFrame) -> None:
    """Write a table as a Markdown table.

    Parameters
    ----------
    path
        The file to write; it appears complete or not at all.
    table
        The table; its index is not written.

    Raises
    ------
    MissingExtraError
        tabulate is not installed; it comes with the extra `workflow`.
    """
    require("tabulate", extra="workflow")
    write_text(path, table.to_markdown(index=False) + "\n")
