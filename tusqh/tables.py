"""Canonical tables: CSV for programs, Markdown for people."""

from __future__ import annotations

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
