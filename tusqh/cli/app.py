"""The application that every command joins, and its entry point."""

from __future__ import annotations

import warnings
from importlib import import_module
from importlib.util import find_spec

import typer

from tusqh.cli.add import add
from tusqh.cli.check import check
from tusqh.cli.inspect import inspect
from tusqh.cli.interruption import catch_signals, to_exit_code
from tusqh.cli.mesh import mesh
from tusqh.cli.show import report_error
from tusqh.cli.view import view
from tusqh.errors import TusqhError

app = typer.Typer(
    help="Meshes with the topology you ask for, from geometry nobody repaired.",
    no_args_is_help=True,
    rich_markup_mode="markdown",
    add_completion=False,
    pretty_exceptions_enable=False,
)
for command in (mesh, inspect, view, check, add):
    app.command()(command)


def _add_workflow_commands() -> None:
    """Add `verify`, `trace` and `lock`, which only a checkout of the project has."""
    if find_spec("provenance") is None:
        return
    for name in ("verify", "trace", "lock"):
        module = import_module(f"provenance.commands.{name}")
        app.command()(getattr(module, name))


_add_workflow_commands()


def main() -> None:
    """Run the command line; errors that a user can mend are messages, not tracebacks."""
    catch_signals()
    # Numba says on every run that it does not use a library which is not needed.
    warnings.filterwarnings("ignore", message=".*TBB threading layer.*")
    try:
        app()
    except (TusqhError, OSError) as error:
        report_error(f"error in {error}")
        raise SystemExit(2) from None
    except SystemExit as end:
        raise SystemExit(to_exit_code(end.code)) from None
