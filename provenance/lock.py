"""The lock, which describes the results that `tusqh lock` accepted.

For each output it holds the digest, the class of equality that it must reach and, if real numbers
are compared, its content.  Only `tusqh lock` changes it.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import jsonschema

from provenance.environment import describe_platform, installed_versions
from provenance.equality import Equality, EqualityRules
from provenance.plan import Plan
from provenance.read_content import read_content
from provenance.stored import Record, read_code_list
from tusqh.atomic import write_text
from tusqh.errors import ConfigError
from tusqh.hashing import canonical_json

#: The lock, in the folder of the results.
LOCK = Path("results/lock.json")
_VERSION = 2


def make_lock(plan: Plan, records: dict[str, Record]) -> dict[str, Any]:
    """Return the lock of the results in the current folder.

    Parameters
    ----------
    plan
        The steps of the workflow.
    records
        The record of each step, by its key.
    """
    code: dict[str, str] = {}
    sources: dict[str, str] = {}
    steps = {}
    for step in plan.steps.values():
        record = records[step.key]
        code |= read_code_list(record.what["code"]["sha256"])
        made = plan.maker.keys() | plan.recorder.keys()
        sources |= {path: record.inputs[path] for path in record.inputs.keys() - made}
        steps[step.key] = {
            "parameters": record.what["parameters"],
            "code": record.what["code"]["sha256"],
            "outputs": {
                path: _describe_output(path, digest, plan.equality)
                for path, digest in record.outputs.items()
            },
        }
    return {
        "lock": _VERSION,
        "environment": {"versions": installed_versions(), **describe_platform()},
        "code": code,
        "sources": sources,
        "steps": steps,
    }


def _describe_output(path: str, digest: str, equality: EqualityRules) -> dict[str, Any]:
    rule = equality.of(path)
    entry: dict[str, Any] = {"equality": str(rule.equality), "sha256": digest}
    if rule.equality is Equality.NUMERIC:
        entry["tolerance"] = rule.tolerance
        content = read_content(Path(path))
        if content is not None:
            entry["content"] = content.to_dict()
    return entry


def write_lock(lock: dict[str, Any], path: Path) -> None:
    """Write a lock with one line per output, so that differences are easy to read.

    Parameters
    ----------
    lock
        The lock from `make_lock`.
    path
        File to write.
    """
    outputs: dict[str, str] = {}

    def shelve(entry: dict[str, Any]) -> str:
        name = f"@{len(outputs)}@"
        outputs[name] = json.dumps(entry, sort_keys=True)
        return name

    steps = {
        key: step | {"outputs": {path: shelve(entry) for path, entry in step["outputs"].items()}}
        for key, step in lock["steps"].items()
    }
    text = canonical_json(lock | {"steps": steps})
    write_text(path, re.sub(r'"(@\d+@)"', lambda match: outputs[match[1]], text))


def read_lock(path: Path) -> dict[str, Any] | None:
    """Return the lock in a file, or None if the file does not exist.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    ConfigError
        The file is not a lock of this version.
    """
    if not path.is_file():
        return None
    schema = json.loads((Path(__file__).parent / "schemas/lock.schema.json").read_text("utf-8"))
    try:
        lock = json.loads(path.read_text("utf-8"))
        jsonschema.validate(lock, schema)
    except (OSError, ValueError, jsonschema.ValidationError) as reason:
        raise ConfigError(
            f"cannot be read as a lock: {str(reason).splitlines()[0]}",
            where=str(path),
            expected=f"a file that `tusqh lock` wrote, version {_VERSION}",
            remedy=f"git checkout {path}, or tusqh lock to make a new one",
        ) from reason
    return dict(lock)


def changed_outputs(old: dict[str, Any] | None, new: dict[str, Any]) -> list[tuple[str, str]]:
    """Return the outputs that differ between two locks, each with "added", "removed" or "changed".

    Parameters
    ----------
    old
        The previous lock; None if there was none.
    new
        The current lock.
    """
    before, after = _digests(old), _digests(new)
    changes = [(path, "added") for path in after.keys() - before.keys()]
    changes += [(path, "removed") for path in before.keys() - after.keys()]
    both = before.keys() & after.keys()
    changes += [(path, "changed") for path in both if before[path] != after[path]]
    return sorted(changes)


def _digests(lock: dict[str, Any] | None) -> dict[str, str]:
    """Return the SHA-256 of each output in a lock."""
    steps = lock["steps"].values() if lock else []
    return {path: entry["sha256"] for step in steps for path, entry in step["outputs"].items()}
