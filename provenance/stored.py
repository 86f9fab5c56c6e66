"""Read the records that steps left when they last succeeded."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema

from tusqh.hashing import canonical_json, hash_value

#: The folder of all records, and its subfolder for the lists of code behind each fingerprint.
RECORDS = Path("results/provenance")
CODE = "code"

_HOW = ".how.json"


@dataclass(frozen=True)
class Record:
    """A record of a step.

    Parameters
    ----------
    what, how
        The two parts of the record; `how` is empty if it cannot be read.
    problem
        Why no step can have written it; empty if a step can.
    """

    what: dict[str, Any]
    how: dict[str, Any]
    problem: str = ""

    @property
    def outputs(self) -> dict[str, str]:
        """The SHA-256 of each output."""
        return {entry["path"]: entry["sha256"] for entry in self.what["outputs"]}

    @property
    def inputs(self) -> dict[str, str]:
        """The SHA-256 of each input."""
        return {entry["path"]: entry["sha256"] for entry in self.what["inputs"]}


def read_records(folder: Path = RECORDS) -> dict[str, Record]:
    """Return all records in a folder by the key of their step, such as ``chesapeake/mesh``.

    Parameters
    ----------
    folder
        Folder of the records.
    """
    found = {}
    for path in sorted(folder.rglob("*.json")):
        if path.name.endswith(_HOW) or path.name.startswith(".") or path.parent == folder / CODE:
            continue
        key = path.relative_to(folder).with_suffix("").as_posix()
        found[key] = _read(path)
    return found


def read_code_list(fingerprint: str, folder: Path = RECORDS) -> dict[str, str]:
    """Return the files behind a fingerprint of code with their SHA-256; empty if it is unknown.

    Parameters
    ----------
    fingerprint
        Fingerprint of the code of a step.
    folder
        Folder of the records.
    """
    files = _read_object(folder / CODE / f"{fingerprint}.json")
    return files if hash_value(files) == fingerprint else {}


def _read(path: Path) -> Record:
    how = _read_object(path.with_name(path.stem + _HOW))
    what = _read_object(path)
    problem = jsonschema.exceptions.best_match(_validator().iter_errors(what))
    if problem is not None:
        where = ": ".join(map(str, [*problem.absolute_path, problem.message]))
        return Record({"outputs": [], "inputs": []}, how, f"does not follow the schema: {where}")
    if path.read_text("utf-8") != canonical_json(what):
        return Record(what, how, "was not written by a workflow step")
    return Record(what, how)


@cache
def _validator() -> jsonschema.Draft202012Validator:
    schema = Path(__file__).parent / "schemas/record.schema.json"
    return jsonschema.Draft202012Validator(json.loads(schema.read_text("utf-8")))


def _read_object(path: Path) -> dict[str, Any]:
    """Return the JSON object in a file; empty if there is none."""
    try:
        content = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}
