"""Check records against each other and against the steps that the workflow would run today."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from provenance.check_files import FileCheck
from provenance.code import code_files
from provenance.digests import Digests, shorten
from provenance.environment import changed_versions, environment_fingerprint, installed_versions
from provenance.findings import Finding, Outcome
from provenance.plan import Plan, Step
from provenance.stored import RECORDS, Record, read_code_list


def check_records(
    plan: Plan,
    records: dict[str, Record],
    register: dict[str, dict[str, str]],
    digests: Digests,
) -> Iterator[Finding]:
    """Find all disagreements between results, records, sources and today's workflow.

    Parameters
    ----------
    plan
        The steps that the workflow would run today.
    records
        The records of the steps that ran, by the key of the step.
    register
        The register of data by file.
    digests
        Digests of the files in the current folder.
    """
    versions = installed_versions()
    files = FileCheck(plan, records, register, digests)
    for step in plan.steps.values():
        record = records.get(step.key)
        if record is None:
            yield _missing_record(plan, step)
        elif record.problem:
            yield Finding(
                outcome=Outcome.DIFFERENT,
                step=step.key,
                file=str(step.record),
                found=record.problem,
                expected="the record that the step wrote",
                remedy=plan.remake(step.outputs[0]),
            )
        else:
            yield from _check_plan(plan, step, record)
            yield from _check_code(plan, step, record)
            yield from _check_environment(plan, step, record, versions)
            yield from files.check_outputs(step, record)
            yield from files.check_inputs(step, record)
    yield from _check_left_over(plan, records, digests)


def _missing_record(plan: Plan, step: Step) -> Finding:
    # Snakemake does not notice that the record of existing outputs is missing.
    is_lost = any(Path(path).exists() for path in step.outputs)
    return Finding(
        outcome=Outcome.CANNOT_TELL,
        step=step.key,
        file=str(step.record if is_lost else RECORDS),
        found="outputs without a record" if is_lost else "steps that have not run",
        expected="the record of the step" if is_lost else "their records and outputs",
        remedy=plan.rerun(str(step.record)) if is_lost else plan.command,
    )


def _check_plan(plan: Plan, step: Step, record: Record) -> Iterator[Finding]:
    """Compare the rule, files and parameters of a step with those of today's plan."""
    parts: dict[str, tuple[Any, Any]] = {
        "step": (record.what["step"], step.rule),
        "model": (record.what["model"], step.model),
        "inputs": (sorted(record.inputs), step.inputs),
        "outputs": (sorted(record.outputs), step.outputs),
    }
    for part, (old, new) in parts.items():
        if old != new:
            yield Finding(
                outcome=Outcome.DIFFERENT,
                step=step.key,
                file=f"{step.record}: {part}",
                found=_show_difference(old, new),
                expected=_show_difference(new, old),
                remedy=plan.remake(step.outputs[0]),
            )
    old_values, new_values = _flatten(record.what["parameters"]), _flatten(step.parameters)
    for name in sorted(old_values.keys() | new_values.keys()):
        old, new = (values.get(name, "nothing") for values in (old_values, new_values))
        if old != new or isinstance(old, bool) != isinstance(new, bool):
            yield Finding(
                outcome=Outcome.DIFFERENT,
                step=step.key,
                file=f"parameter {name}",
                found=f"{old}, when the step ran",
                expected=f"{new}, in the workflow today",
                remedy=plan.rerun(str(step.record)),
            )


def _check_code(plan: Plan, step: Step, record: Record) -> Iterator[Finding]:
    """Compare the recorded code of a step with today's code."""
    if record.what["code"] == step.code:
        return
    was = read_code_list(str(record.what["code"].get("sha256")))
    now = code_files(step.code["script"], base=plan.base)
    changed = sorted(f for f in was.keys() | now.keys() if was.get(f) != now.get(f))
    if not was or not changed:
        changed = [step.code["script"]]
    for file in changed:
        old, new = was.get(file), now.get(file)
        yield Finding(
            outcome=Outcome.DIFFERENT,
            step=step.key,
            file=file,
            found=f"code with {shorten(new)}" if new else "no longer imported",
            expected=f"{shorten(old)}, when the step ran" if old else "the code that the step ran",
            remedy=f"{plan.command}; with --forceall if it finds nothing to do",
        )


def _check_environment(
    plan: Plan, step: Step, record: Record, versions: dict[str, str]
) -> Iterator[Finding]:
    """Compare the packages with which a step ran with those installed now."""
    if record.what["environment"] == environment_fingerprint(versions):
        return
    was = record.how.get("versions", {})
    changed = changed_versions(was, versions) if was else []
    unknown = "the same versions, but another digest; the record may have been edited"
    yield Finding(
        outcome=Outcome.CANNOT_TELL,
        step=step.key,
        file="environment",
        found="installed now: "
        + (", ".join(new for _, new in changed) or (unknown if was else "other packages")),
        expected="when the step ran: "
        + (", ".join(old for old, _ in changed) or "the packages of the record"),
        remedy=f"pip install -r requirements.lock; or {plan.command} --forceall",
    )


def _check_left_over(plan: Plan, records: dict[str, Record], digests: Digests) -> Iterator[Finding]:
    """Examine records of steps that the workflow no longer has."""
    needed = {path for step in plan.steps.values() for path in step.inputs}
    for key in sorted(records.keys() - plan.steps.keys()):
        inputs = records[key].inputs
        gone = [path for path in inputs if path not in plan.maker and digests.of(path) is None]
        if gone and needed & records[key].outputs.keys():
            # Snakemake omits a step without its source if its outputs exist.
            yield Finding(
                outcome=Outcome.DIFFERENT,
                step=key,
                file=gone[0],
                found="the file does not exist",
                expected=f"{shorten(inputs[gone[0]])}, which {key} read",
                remedy="restore the source file",
            )
        else:
            yield Finding(
                outcome=Outcome.SAME,
                step=key,
                file=f"results/provenance/{key}.json",
                found="a record of a step that the default targets do not need",
                expected="no such file, unless the step was requested",
                remedy="remove it if its results are no longer needed",
            )


def _flatten(value: Any, name: str = "") -> dict[str, Any]:
    """Return the values in nested mappings by their path, such as ``grid.cells``."""
    if isinstance(value, dict) and value:
        inner = (_flatten(v, f"{name}.{k}" if name else str(k)) for k, v in value.items())
        return {path: leaf for leaves in inner for path, leaf in leaves.items()}
    return {name: value}


def _show_difference(one: Any, other: Any) -> str:
    """Return the items of a list that another list lacks; other values do not change."""
    if isinstance(one, list) and isinstance(other, list):
        own = [item for item in one if item not in other]
        return ", ".join(own[:3]) + (" ..." if len(own) > 3 else "") if own else "none of these"
    return str(one)
