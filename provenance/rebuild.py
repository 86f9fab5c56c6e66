"""Rebuild a model in an empty folder, and compare it with the results here."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from provenance.digests import shorten
from provenance.equality import Equality, is_numerically_equal
from provenance.findings import Finding, Outcome
from provenance.plan import Plan, Step
from provenance.read_content import read_content
from provenance.stored import Record
from tusqh.errors import ProvenanceError
from tusqh.hashing import hash_file

#: Function that makes some files of a plan in a folder.
Runner = Callable[[Plan, Path, list[str]], None]


def run_snakemake(plan: Plan, folder: Path, targets: list[str]) -> None:
    """Make files of a plan in a folder, printing the log on the terminal.

    Parameters
    ----------
    plan
        The steps that the workflow would run today.
    folder
        Folder in which Snakemake runs.
    targets
        The files to make.

    Raises
    ------
    ProvenanceError
        A step fails.
    """
    command = [sys.executable, "-m", "snakemake", "--cores", "all", "--directory", str(folder)]
    command += ["--snakefile", str(plan.snakefile.resolve())]
    if plan.given_config_files:
        command.append("--configfile")
        command += [str(path.resolve()) for path in plan.given_config_files]
    done = subprocess.run([*command, "--", *targets], stdout=sys.stderr)
    if done.returncode:
        raise ProvenanceError(
            f"snakemake ended with exit code {done.returncode}",
            where=f"rebuilding {targets[0].split('/')[1]}",
            expected="all steps to succeed",
            remedy="read its messages above: they name the step that failed and the reason",
        )


def rebuild_model(
    model: str, plan: Plan, records: dict[str, Record], *, run: Runner = run_snakemake
) -> list[Finding]:
    """Run all steps of a model in a temporary folder, and compare each output.

    Parameters
    ----------
    model
        The model.
    plan
        The steps that the workflow would run today.
    records
        The records of the steps that ran, by the key of the step.
    run
        Function that makes the files.

    Returns
    -------
    list of Finding
        One finding for each output.

    Raises
    ------
    ProvenanceError
        The model does not exist, or a step fails.
    """
    steps = [step for step in plan.steps.values() if step.model == model]
    if not steps:
        models = sorted({step.model for step in plan.steps.values() if step.model})
        raise ProvenanceError(
            f"there is no model {model!r}",
            where="--rebuild",
            expected="one of " + ", ".join(models),
            remedy="name a model of the configuration",
        )
    made = {path for step in steps for path in step.outputs}
    with tempfile.TemporaryDirectory(prefix="tusqh-rebuild-") as name:
        folder = Path(name)
        needed = {path for step in steps for path in step.inputs} - made
        for path in [*map(Path, sorted(needed)), *plan.config_files]:
            if path.is_file() and not path.is_absolute():
                (folder / path).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, folder / path)
        run(plan, folder, sorted(made))
        return _compare(model, folder, plan, records)


def _compare(model: str, folder: Path, plan: Plan, records: dict[str, Record]) -> list[Finding]:
    findings = []
    classes: dict[str, Equality | None] = {}
    for key, step in plan.steps.items():
        record = records.get(key)
        if step.model != model or record is None:
            continue
        for path in step.outputs:
            new, old = hash_file(folder / path), record.outputs.get(path, "")
            classes[path] = (
                Equality.EXACT if new == old else _reach(path, folder, plan, step, classes)
            )
            if classes[path] is None:
                findings.append(
                    Finding(
                        outcome=Outcome.DIFFERENT,
                        step=key,
                        file=path,
                        found=f"{shorten(new)} when made again",
                        expected=f"{shorten(old)} as recorded, "
                        f"equality {plan.equality.of(path).equality}",
                        remedy=f"{plan.remake(path)}; tusqh trace {path}",
                    )
                )
    counts = Counter(str(kind or "different") for kind in classes.values())
    text = ", ".join(f"{n} {kind}" for kind, n in counts.items())
    note = Finding(
        outcome=Outcome.SAME,
        step=model,
        file="rebuild",
        found=f"{len(classes)} outputs made again: {text}",
        expected="each reaches its class of equality",
        remedy="nothing",
    )
    return [*findings, note]


def _reach(
    path: str, folder: Path, plan: Plan, step: Step, classes: dict[str, Equality | None]
) -> Equality | None:
    """Return the class that a file with different bytes reaches, given those of its inputs."""
    rule = plan.equality.of(path)
    if rule.equality is Equality.UNCHECKED:
        is_same = all(classes.get(source, Equality.EXACT) for source in step.inputs)
        return Equality.UNCHECKED if is_same else None
    if rule.equality is Equality.NUMERIC and Path(path).is_file():
        new, old = read_content(folder / path), read_content(Path(path))
        return Equality.NUMERIC if is_numerically_equal(new, old, rule.tolerance) else None
    return None
