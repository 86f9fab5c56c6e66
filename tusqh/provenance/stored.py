"""The records that are there: what every step left when it last succeeded."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tusqh.provenance.hashing import canonical_json

#: Where all records are, and in it the files that each fingerprint of code stands for.
RECORDS = Path("results/provenance")
CODE = "code"

_KEYS = {"step", "model", "parameters", "code", "inputs", "outputs", "environment"}
_HOW = ".how.json"


@dataclass(frozen=True)
class Record:
    """A record as it was read.

    Parameters
    ----------
    what, how
        Its two parts; `how` is empty when it cannot be read.
    problem
        Why it is not as a step writes it; empty when it is.
    """

    what: dict[str, Any]
    how: dict[str, Any]
    problem: str = ""

    @property
    def outputs(self) -> dict[str, str]:
        """The SHA-256 of every output."""
        return {entry["path"]: entry["sha256"] for entry in self.what["outputs"]}

    @property
    def inputs(self) -> dict[str, str]:
        """The SHA-256 of every input."""
        return {entry["path"]: entry["sha256"] for entry in self.what["inputs"]}


def read_records(folder: Path = RECORDS) -> dict[str, Record]:
    """Return all records by the key of their step, ``chesapeake/mesh`` or ``tables``."""
    found = {}
    for path in sorted(folder.rglob("*.json")):
        if path.name.endswith(_HOW) or path.name.startswith(".") or path.parent == folder / CODE:
            continue
        key = path.relative_to(folder).with_suffix("").as_posix()
        found[key] = _read(path)
    return found


def read_code_list(fingerprint: str, folder: Path = RECORDS) -> dict[str, str]:
    """Return the files that a fingerprint of code stands for; empty when that is not known."""
    return _json(folder / CODE / f"{fingerprint}.json")


def _read(path: Path) -> Record:
    how = _json(path.with_name(path.stem + _HOW))
    what = _json(path)
    if what.keys() != _KEYS:
        odd = ", ".join(sorted(what.keys() ^ _KEYS)) if what else "no JSON object"
        return Record({"outputs": [], "inputs": []}, how, f"is not as a step writes it: {odd}")
    for entries in (what["inputs"], what["outputs"]):
        if any(not isinstance(e, dict) or e.keys() != {"path", "sha256", "size"} for e in entries):
            problem = "is not as a step writes it: inputs, outputs"
            return Record({"outputs": [], "inputs": []}, how, problem)
    if path.read_text("utf-8") != canonical_json(what):
        return Record(what, how, "was written by something else than a step")
    return Record(what, how)


def _json(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}
