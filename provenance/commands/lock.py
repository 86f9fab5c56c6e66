"""`tusqh lock`: accept the results in the current folder."""

from __future__ import annotations

from pathlib import Path

import typer

from provenance.commands.options import ConfigFiles, LockFile, Snakefile
from tusqh.cli.show import make_console, report_error


def lock(
    snakefile: Snakefile = Path("Snakefile"),
    configfile: ConfigFiles = None,
    lock: LockFile = Path("results/lock.json"),
) -> None:
    """Accept the results in the current folder as the reference for `tusqh verify`.

    Fails if a result is missing, if one differs from its record, or if a claim does not have the
    status that workflow/claims.yaml declares as accepted.
    Example: tusqh lock && git add results/lock.json
    """
    from provenance.lock import changed_outputs, make_lock, read_lock, write_lock
    from provenance.plan import make_plan
    from provenance.stored import read_records
    from provenance.verify import require_lockable
    from tusqh.errors import ConfigError

    plan, records = make_plan(snakefile, configfile or []), read_records()
    require_lockable(plan, records)
    new = make_lock(plan, records)
    try:
        old = read_lock(lock)
    except ConfigError as reason:  # The new lock replaces it.
        report_error(f"warning: {reason}")
        old = None
    write_lock(new, lock)
    console = make_console()
    for path, change in changed_outputs(old, new):
        console.print(f"{change:>8}  {path}", markup=False, highlight=False)
    n_outputs = sum(len(step["outputs"]) for step in new["steps"].values())
    typer.echo(f"{lock}: {n_outputs} outputs of {len(new['steps'])} steps")
