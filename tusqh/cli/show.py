"""Tables and errors on the terminal."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:
    import pandas as pd

#: Width of output that is not a terminal, in columns; no line is longer, so no line is wrapped.
_UNLIMITED = 100_000


def make_console(**options: Any) -> Console:
    """Return a console on the standard output, which wraps lines only where that is a terminal.

    Parameters
    ----------
    **options
        Further parameters of `rich.console.Console`.
    """
    return Console(width=None if sys.stdout.isatty() else _UNLIMITED, **options)


def show(frame: pd.DataFrame, *, title: str) -> None:
    """Print a table; numbers have six digits, missing numbers stay empty.

    Names from files are shown unchanged; nothing in them is interpreted as markup.

    Parameters
    ----------
    frame
        The table.
    title
        Its title.
    """
    table = Table(title=title, title_justify="left")
    for k, column in enumerate(frame.columns):
        table.add_column(str(column), overflow="fold", no_wrap=k == 0, min_width=len(str(column)))
    for row in frame.itertuples(index=False):
        table.add_row(*map(_to_text, row))
    print_table(make_console(markup=False, highlight=False), table)


def print_table(console: Console, table: Table) -> None:
    """Print a table; on what is not a terminal, no line ends with spaces.

    Parameters
    ----------
    console
        From `make_console`.
    table
        The table.
    """
    if console.is_terminal:
        console.print(table)
        return
    with console.capture() as captured:
        console.print(table)
    for line in captured.get().splitlines():
        print(line.rstrip())


def report_error(message: str) -> None:
    """Print an error on the standard error stream, with its lines unchanged.

    Parameters
    ----------
    message
        The message.
    """
    console = Console(stderr=True, markup=False, highlight=False)
    console.print(message, style="red", soft_wrap=True)


def _to_text(value: object) -> str:
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.6g}"
    return str(value)
