"""The application that every command joins, and its entry point."""

from __future__ import annotations

import sys
import warnings
from importlib import import_module
from importlib.util import find_spec
from typing import Annotated

import typer

import tusqh
from tusqh.cli import background
from tusqh.cli.add import add
from tusqh.cli.check import check
from tusqh.cli.inspect import inspect
from tusqh.cli.interruption import catch_signals, to_exit_code
from tusqh.cli.mesh import mesh
from tusqh.cli.options import Command
from tusqh.cli.recommend import recommend
from tusqh.cli.show import report_error
from tusqh.cli.view import view
from tusqh.errors import TusqhError


def _print_version(is_wanted: bool) -> None:
    if is_wanted:
        typer.echo(f"tusqh {tusqh.__version__}")
        raise typer.Exit


app = typer.Typer(
    help="Meshes with the topology you ask for, from geometry that nobody has repaired.",
    no_args_is_help=True,
    rich_markup_mode="markdown",
    add_completion=False,
    pretty_exceptions_enable=False,
)
for command in (mesh, recommend, inspect, view, check, add):
    app.command(cls=Command)(command)
app.add_typer(background.app, name="background")


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Print the version and exit.", callback=_print_version, is_eager=True
        ),
    ] = False,
) -> None:
    """Handle the options that stand before a command."""


def _add_workflow_commands() -> None:
    """Add `verify`, `trace` and `lock`, which only a checkout of the project has."""
    if find_spec("provenance") is None:
        return
    for name in ("verify", "trace", "lock"):
        module = import_module(f"provenance.commands.{name}")
        app.command()(getattr(module, name))


_add_workflow_commands()


def main() -> None:
    """Run the command line; errors that a user can fix are messages, not tracebacks."""
    catch_signals()
    if not sys.warnoptions:  # Remarks and checks say what a user must know; -W shows warnings.
        warnings.simplefilter("ignore")
    # Numba warns on every run about an optional library that it does not find.
    warnings.filterwarnings("ignore", message=".*TBB threading layer.*")
    try:
        app()
    except (TusqhError, OSError) as error:
        report_error(f"error in {error}")
        raise SystemExit(2) from None
    except SystemExit as end:
        _flush_output()
        raise SystemExit(to_exit_code(end.code)) from None


def _flush_output() -> None:
    """Write what is still buffered, so that a reader who has left is noticed before Python ends."""
    try:
        sys.stdout.flush()
    except (BrokenPipeError, SystemExit):
        return  # `catch_signals` has noted the signal.
