"""The application that every command joins, and its entry point."""

from __future__ import annotations

import typer
from rich.console import Console

from tusqh.cli.check import check
from tusqh.cli.inspect import inspect
from tusqh.errors import TusqhError

app = typer.Typer(
    help="Meshes with the topology you ask for, from geometry nobody repaired.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for command in (inspect, check):
    app.command()(command)


def main() -> None:
    """Run the command line; errors that a user can mend are messages, not tracebacks."""
    try:
        app()
    except TusqhError as error:
        Console(stderr=True).print(f"error in {error}", style="red", highlight=False, markup=False)
        raise SystemExit(2) from None
