"""The lock: what the results were when somebody said that they are right.

It holds every output's digest, the class of equality that it must reach and, for all but exact
classes, what it says.  Only `tusqh lock` changes it.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import jsonschema

from provenance.content import read_content
from provenance.environment import describe_platform, installed_versions
from provenance.equality import TOLERANCE, Equality, class_of
from provenance.plan import Plan
from provenance.stored import Record, read_code_list
from tusqh.atomic import write_text
from tusqh.errors import ConfigError
from tusqh.hashing import canonical_json

#: Where the lock is, beside the results.
LOCK = Path("results/lock.json")
_VERSION = 1


def _object(*, each: Any = None, **properties: Any) -> dict[str, Any]:
    """Return the schema of an object with these properties, or with any of one kind."""
    others = {} if each is None else {"additionalProperties": each}
    return {"type": "object", "required": list(properties), "properties": properties, **others}


_TEXT = {"type": "string"}
_TEXTS = _object(each=_TEXT)
_NUMBERS = _object(scale={"type": ["number", "string"]}, values={"type": "array"})
_OUTPUT = _object(**{"class": {"enum": [str(kind) for kind in Equality]}, "sha256": _TEXT})
_OUTPUT["properties"]["content"] = _object(skeleton=_TEXT, numbers=_object(each=_NUMBERS))
_STEP = _object(parameters={"type": "object"}, code=_TEXT, outputs=_object(each=_OUTPUT))
_SCHEMA = _object(
    lock={"const": _VERSION},
    environment=_object(versions=_TEXTS, python=_TEXT, platform=_TEXT),
    code=_TEXTS,
    sources=_TEXTS,
    steps=_object(each=_STEP),
)


def make_lock(plan: Plan, records: dict[str, Record]) -> dict[str, Any]:
    """Return the lock of the results that are there; every step must have its record."""
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
            "outputs": {path: _entry(path, digest) for path, digest in record.outputs.items()},
        }
    return {
        "lock": _VERSION,
        "environment": {"versions": installed_versions(), **describe_platform()},
        "code": code,
        "sources": sources,
        "steps": steps,
    }


def _entry(path: str, digest: str) -> dict[str, Any]:
    kind = class_of(path)
    entry: dict[str, Any] = {"class": str(kind), "sha256": digest}
    content = read_content(Path(path)) if kind in TOLERANCE else None
    return entry if content is None else entry | {"content": content.to_dict()}


def write_lock(lock: dict[str, Any], path: Path) -> None:
    """Write a lock with one line per output, which differences are easy to read in."""
    outputs: dict[str, str] = {}

    def shelve(entry: dict[str, Any]) -> str:
        outputs[name := f"@{len(outputs)}@"] = json.dumps(entry, sort_keys=True)
        return name

    steps = {
        key: step | {"outputs": {path: shelve(entry) for path, entry in step["outputs"].items()}}
        for key, step in lock["steps"].items()
    }
    text = canonical_json(lock | {"steps": steps})
    write_text(path, re.sub(r'"(@\d+@)"', lambda match: outputs[match[1]], text))


def read_lock(path: Path) -> dict[str, Any] | None:
    """Return the lock in a file, None when there is none.

    Raises
    ------
    ConfigError
        The file is no lock.
    """
    if not path.is_file():
        return None
    try:
        lock = json.loads(path.read_text("utf-8"))
        jsonschema.validate(lock, _SCHEMA)
    except (OSError, ValueError, jsonschema.ValidationError) as reason:
        raise ConfigError(
            f"cannot be read as a lock: {str(reason).splitlines()[0]}",
            where=str(path),
            expected=f"a file that `tusqh lock` wrote, of version {_VERSION}",
            remedy=f"git checkout {path}, or tusqh lock to make a new one",
        ) from reason
    return dict(lock)


def changed_outputs(old: dict[str, Any] | None, new: dict[str, Any]) -> list[tuple[str, str]]:
    """Return the outputs that two locks know differently: added, removed or changed."""
    before, after = (
        {
            path: entry["sha256"]
            for step in (lock or {"steps": {}})["steps"].values()
            for path, entry in step["outputs"].items()
        }
        for lock in (old, new)
    )
    changes = []
    for path in sorted(before.keys() | after.keys()):
        if before.get(path) != after.get(path):
            known = (path in before, path in after)
            change = {(True, True): "changed", (True, False): "removed", (False, True): "added"}
            changes.append((path, change[known]))
    return changes
