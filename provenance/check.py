"""Results against their records, and records against what the workflow would do today."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from provenance.code import code_files
from provenance.environment import environment_fingerprint, installed_versions
from provenance.findings import Finding, Outcome
from provenance.plan import Plan, Step
from provenance.register import REGISTER
from provenance.stored import RECORDS, Record, read_code_list
from tusqh.errors import GeometryError
from tusqh.geometry.packaged import locate
from tusqh.hashing import hash_file

DIFFERENT, CANNOT_TELL, SAME = Outcome.DIFFERENT, Outcome.CANNOT_TELL, Outcome.SAME

_SHOWN = 12
_NOT_THERE = "not there"


def check_records(
    plan: Plan, records: dict[str, Record], register: dict[str, dict[str, str]]
) -> Iterator[Finding]:
    """Find every way in which results, records, sources and today's workflow disagree.

    Parameters
    ----------
    plan
        What the workflow would do today, in the present folder.
    records
        What it did, by the key of the step.
    register
        The register of data by file.
    """
    versions = installed_versions()
    for step in plan.steps.values():
        record = records.get(step.key)
        if record is None:
            # Snakemake does not miss a record beside outputs.
            is_lost = any(Path(path).exists() for path in step.outputs)
            yield Finding(
                CANNOT_TELL,
                step.key,
                str(step.record) if is_lost else str(RECORDS),
                "no record of outputs that are there" if is_lost else "steps that have not run",
                "the step's record" if is_lost else "their records and outputs",
                plan.rerun(str(step.record)) if is_lost else plan.command,
            )
        elif record.problem:
            yield Finding(
                DIFFERENT,
                step.key,
                str(step.record),
                record.problem,
                "the record that the step wrote",
                plan.remake(step.outputs[0]),
            )
        else:
            yield from _check_plan(plan, step, record)
            yield from _check_code(plan, step, record)
            yield from _check_environment(plan, step, record, versions)
            yield from _check_outputs(plan, step, record)
            yield from _check_inputs(plan, step, record, records, register)
    yield from _check_left_over(plan, records)


def short(digest: str) -> str:
    """Return enough of a digest to recognise it."""
    return f"SHA-256 {digest[:_SHOWN]}"


@cache
def digest_now(name: str) -> str | None:
    """Return the SHA-256 of a file, None when it is not there; read once until `cache_clear`."""
    try:
        return hash_file(locate(name))
    except (OSError, GeometryError):
        return None


def _check_plan(plan: Plan, step: Step, record: Record) -> Iterator[Finding]:
    """Compare what a step was told with what it would be told today."""
    parts: dict[str, tuple[Any, Any]] = {
        "step": (record.what["step"], step.rule),
        "model": (record.what["model"], step.model),
        "inputs": (sorted(record.inputs), step.inputs),
        "outputs": (sorted(record.outputs), step.outputs),
    }
    for part, (old, new) in parts.items():
        if old != new:
            yield Finding(
                DIFFERENT,
                step.key,
                f"{step.record}: {part}",
                _difference(old, new),
                _difference(new, old),
                plan.remake(step.outputs[0]),
            )
    old_values, new_values = _leaves(record.what["parameters"]), _leaves(step.parameters)
    for name in sorted(old_values.keys() | new_values.keys()):
        old, new = (v.get(name, "nothing") for v in (old_values, new_values))
        if old != new or isinstance(old, bool) != isinstance(new, bool):
            yield Finding(
                DIFFERENT,
                step.key,
                f"parameter {name}",
                f"the step was run with {old}",
                f"{new}, as the workflow would today",
                plan.rerun(str(step.record)),
            )


def _check_code(plan: Plan, step: Step, record: Record) -> Iterator[Finding]:
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
            DIFFERENT,
            step.key,
            file,
            f"code with {short(new)}" if new else "no longer imported",
            f"{short(old)}, when the step ran" if old else "as it was when the step ran",
            f"{plan.command}; with --forceall where it finds nothing to do",
        )


def _check_environment(
    plan: Plan, step: Step, record: Record, versions: dict[str, str]
) -> Iterator[Finding]:
    if record.what["environment"] == environment_fingerprint(versions):
        return
    was = record.how.get("versions", {})
    changed = changed_versions(was, versions) if was else []
    unknown = "the same versions, another digest: the record may be edited" if was else "others"
    yield Finding(
        CANNOT_TELL,
        step.key,
        "environment",
        "installed now: " + (", ".join(new for _, new in changed) or unknown),
        "as when the step ran: " + (", ".join(old for old, _ in changed) or "another"),
        f"pip install -r requirements.lock; or {plan.command} --forceall",
    )


def changed_versions(was: dict[str, str], now: dict[str, str]) -> list[tuple[str, str]]:
    """Return the packages whose versions differ, before and after, as ``numpy 2.4.6``.

    >>> changed_versions({"numpy": "2.0", "vtk": "9"}, {"numpy": "2.1", "vtk": "9"})
    [('numpy 2.0', 'numpy 2.1')]
    """
    names = sorted(name for name in was.keys() | now.keys() if was.get(name) != now.get(name))
    return [tuple(f"{name} {v.get(name, 'absent')}" for v in (was, now)) for name in names]  # type: ignore[misc]


def _check_outputs(plan: Plan, step: Step, record: Record) -> Iterator[Finding]:
    for entry in record.what["outputs"]:
        path, found = entry["path"], digest_now(entry["path"])
        if found != entry["sha256"]:
            yield Finding(
                DIFFERENT,
                step.key,
                path,
                short(found) if found else _NOT_THERE,
                f"{short(entry['sha256'])}, as the step wrote it",
                plan.remake(path),
            )
        elif entry["size"] != Path(path).stat().st_size:
            yield _edited_size(plan, step, entry)


def _check_inputs(
    plan: Plan,
    step: Step,
    record: Record,
    records: dict[str, Record],
    register: dict[str, dict[str, str]],
) -> Iterator[Finding]:
    for entry in record.what["inputs"]:
        path, digest = entry["path"], entry["sha256"]
        maker = plan.maker.get(path)
        if path in plan.recorder:
            if digest_now(path) != digest:
                yield Finding(
                    DIFFERENT,
                    step.key,
                    f"{step.record}: {path}",
                    f"the step read {short(digest)}",
                    f"{short(digest_now(path) or 'nothing')}, as it is now",
                    plan.remake(step.outputs[0]),
                )
        elif maker is None:
            yield from _check_source(plan, step, entry, register)
        elif maker.key in records and records[maker.key].outputs.get(path, digest) != digest:
            yield Finding(
                DIFFERENT,
                step.key,
                f"{step.record}: {path}",
                f"the step read {short(digest)}",
                f"{short(records[maker.key].outputs[path])}, as {maker.key} wrote it",
                plan.remake(step.outputs[0]),
            )
        elif digest_now(path) == digest and entry["size"] != Path(path).stat().st_size:
            yield _edited_size(plan, step, entry)


def _check_source(
    plan: Plan, step: Step, entry: dict[str, Any], register: dict[str, dict[str, str]]
) -> Iterator[Finding]:
    path, digest = entry["path"], entry["sha256"]
    found = digest_now(path)
    registered = register.get(path, {}).get("sha256")
    if found != digest:
        yield Finding(
            DIFFERENT,
            step.key,
            path,
            short(found) if found else _NOT_THERE,
            f"{short(digest)}, as the step read it",
            f"restore the source file, or {plan.command}",
        )
    elif registered and registered != digest:
        yield Finding(
            DIFFERENT,
            step.key,
            path,
            short(digest),
            f"{short(registered)}, as {REGISTER} says",
            f"restore the source file, or correct {REGISTER}",
        )
    elif not registered and not _is_of_project(path, plan):
        yield Finding(
            SAME,
            step.key,
            path,
            f"not in {REGISTER}",
            "its origin and licence",
            f"add a row to {REGISTER}",
        )
    if found == digest and entry["size"] != locate(path).stat().st_size:
        yield _edited_size(plan, step, entry)


def _is_of_project(path: str, plan: Plan) -> bool:
    """Tell whether a source is no data: the register itself, a template of the workflow."""
    return path == str(REGISTER) or Path(path).resolve().is_relative_to(plan.base / "workflow")


def _edited_size(plan: Plan, step: Step, entry: dict[str, Any]) -> Finding:
    return Finding(
        DIFFERENT,
        step.key,
        f"{step.record}: {entry['path']}",
        f"a size of {entry['size']} bytes",
        f"{locate(entry['path']).stat().st_size} bytes, which the digest belongs to",
        plan.remake(step.outputs[0]),
    )


def _check_left_over(plan: Plan, records: dict[str, Record]) -> Iterator[Finding]:
    """Look at records of steps that the workflow does not have today."""
    needed = {path for step in plan.steps.values() for path in step.inputs}
    for key in sorted(records.keys() - plan.steps.keys()):
        gone = [p for p in records[key].inputs if p not in plan.maker and digest_now(p) is None]
        if gone and needed & records[key].outputs.keys():
            # Snakemake leaves out a step without its source when its outputs are there.
            yield Finding(
                DIFFERENT,
                key,
                gone[0],
                _NOT_THERE,
                f"{short(records[key].inputs[gone[0]])}, as {key} read it",
                "restore the source file",
            )
        else:
            yield Finding(
                SAME,
                key,
                f"results/provenance/{key}.json",
                "a record of a step that the default targets do not need",
                "no such file, unless somebody asked for it",
                "remove it when its results are no longer needed",
            )


def _leaves(value: Any, name: str = "") -> dict[str, Any]:
    """Return plain values by their path: ``grid.cells`` for a value in a nested mapping."""
    if isinstance(value, dict) and value:
        inner = (_leaves(v, f"{name}.{k}" if name else str(k)) for k, v in value.items())
        return {path: leaf for leaves in inner for path, leaf in leaves.items()}
    return {name: value}


def _difference(one: Any, other: Any) -> str:
    if isinstance(one, list) and isinstance(other, list):
        own = [item for item in one if item not in other]
        return ", ".join(own[:3]) + (" ..." if len(own) > 3 else "") if own else "no other"
    return str(one)
