"""The records that are there: what every step left when it last succeeded."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tusqh.hashing import canonical_json, hash_value

#: Where all records are, and in it the files that each fingerprint of code stands for.
RECORDS = Path("results/provenance")
CODE = "code"

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
    files = _json(folder / CODE / f"{fingerprint}.json")
    return files if hash_value(files) == fingerprint else {}


def _read(path: Path) -> Record:
    how = _json(path.with_name(path.stem + _HOW))
    what = _json(path)
    odd = _find_odd(what)
    if odd:
        problem = f"is not as a step writes it: {', '.join(odd)}"
        return Record({"outputs": [], "inputs": []}, how, problem)
    if path.read_text("utf-8") != canonical_json(what):
        return Record(what, how, "was written by something else than a step")
    return Record(what, how)


def _find_odd(what: dict[str, Any]) -> list[str]:
    """Return the parts of a record that are missing, unknown or of the wrong kind."""
    if not what:
        return ["no JSON object"]
    return sorted(what.keys() ^ _KINDS.keys()) or [
        key for key, is_right in _KINDS.items() if not is_right(what[key])
    ]


def _are_files(value: Any) -> bool:
    return isinstance(value, list) and all(
        isinstance(entry, dict)
        and entry.keys() == _FILE.keys()
        and all(isinstance(entry[key], kind) for key, kind in _FILE.items())
        for entry in value
    )


def _is_code(value: Any) -> bool:
    return (
        isinstance(value, dict)
        and value.keys() == {"script", "sha256"}
        and all(isinstance(text, str) for text in value.values())
    )


_FILE = {"path": str, "sha256": str, "size": int}
_KINDS: dict[str, Callable[[Any], bool]] = {
    "step": lambda value: isinstance(value, str),
    "model": lambda value: value is None or isinstance(value, str),
    "parameters": lambda value: isinstance(value, dict),
    "code": _is_code,
    "inputs": _are_files,
    "outputs": _are_files,
    "environment": lambda value: isinstance(value, str),
}


def _json(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}
