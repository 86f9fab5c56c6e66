"""`tusqh verify`: check the results in the current folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape
from rich.table import Table

from provenance.commands.options import ConfigFiles, LockFile, Snakefile
from tusqh.cli.show import make_console, print_table

if TYPE_CHECKING:
    from provenance.verify import Verification

_COLOURS = {"same": "green", "different": "red", "cannot tell": "yellow"}


def verify(
    snakefile: Snakefile = Path("Snakefile"),
    configfile: ConfigFiles = None,
    lock: LockFile = Path("results/lock.json"),
    rebuild: Annotated[
        str | None,
        typer.Option(
            metavar="MODEL", help="Also make a model again in an empty folder, and compare."
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the report as JSON.")] = False,
) -> None:
    """Check the results here against records, sources, code, parameters, lock and claims.

    Exit code 0: the same; 1: different; 2: cannot tell, because something is missing.
    Example: tusqh verify --rebuild chesapeake
    """
    from provenance.lock import LOCK, read_lock
    from provenance.plan import make_plan
    from provenance.rebuild import rebuild_model
    from provenance.stored import read_records
    from provenance.verify import verify as verify_results

    if lock != LOCK:
        _require_lock(lock)
    plan = make_plan(snakefile, configfile or [])
    verification = verify_results(plan, read_records(), read_lock(lock))
    if rebuild:
        verification = verification.extended(rebuild_model(rebuild, plan, read_records()))
    if as_json:
        typer.echo(json.dumps(verification.to_dict(), indent=2))
    else:
        _show(verification)
    raise typer.Exit(int(verification.verdict))


def _require_lock(lock: Path) -> None:
    """Raise an error if the named lock does not exist."""
    from tusqh.errors import ConfigError

    if not lock.is_file():
        raise ConfigError(
            "the lock does not exist",
            where=str(lock),
            expected="a file that `tusqh lock` wrote",
            remedy="check the path",
        )


def _show(verification: Verification) -> None:
    """Print a table of steps, the findings and the verdict."""
    from provenance.findings import Outcome, merge

    console = make_console()
    print_table(console, _table(verification))
    for finding in merge(verification.findings):
        if finding.outcome is Outcome.SAME:
            continue
        colour = _COLOURS[finding.outcome.text]
        where = f" ({finding.step})" if finding.step else ""
        console.print(
            f"\n[{colour}]{finding.outcome.text}[/]: {escape(finding.file + where)}", soft_wrap=True
        )
        console.print(f"  found:    {finding.found}", markup=False, highlight=False, soft_wrap=True)
        console.print(
            f"  expected: {finding.expected}", markup=False, highlight=False, soft_wrap=True
        )
        console.print(
            f"  remedy:   {finding.remedy}", markup=False, highlight=False, soft_wrap=True
        )
    remarks = [f for f in merge(verification.findings) if f.outcome is Outcome.SAME]
    for remark in remarks:
        text = f"note: {remark.file}: {remark.found}; expected: {remark.expected}"
        console.print(text, markup=False, highlight=False, soft_wrap=True)
    colour = _COLOURS[verification.verdict.text]
    share = verification.recording_share
    cost = "" if share is None else f"; recording took {100 * share:.1f} % of the steps' time"
    console.print(f"\n[bold {colour}]{verification.verdict.text}[/]: {verification.summary}{cost}")


def _table(verification: Verification) -> Table:
    """Return one row per step; models with the same outcome share a row."""
    rows: dict[tuple[str, str, str], list[str]] = {}
    for key, outcome in verification.outcomes.items():
        model, _, name = key.rpartition("/")
        equality = str(verification.classes.get(key) or "-")
        rows.setdefault((name, outcome.text, equality), []).append(model)
    table = Table(title="Steps", title_justify="left")
    for column in ("step", "models", "outcome", "equality with the lock"):
        table.add_column(column)
    for (name, outcome_text, equality), models in rows.items():
        named = [model for model in models if model]
        shown = ", ".join(named) if len(named) <= 2 else f"{len(named)} models"
        colour = _COLOURS[outcome_text]
        table.add_row(name, escape(shown), f"[{colour}]{outcome_text}[/]", equality)
    return table
