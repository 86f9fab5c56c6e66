"""SHA-256 of files and of plain values."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any


def hash_file(path: Path) -> str:
    """Return the SHA-256 of a file's bytes, in hexadecimal.

    Parameters
    ----------
    path
        An existing file.
    """
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def canonical_json(value: Any) -> str:
    r"""Return a value as JSON that depends only on the value.

    Parameters
    ----------
    value
        Dictionaries with string keys, lists, strings, numbers, booleans and None.

    Examples
    --------
    >>> canonical_json({"b": 1, "a": [2.5]})
    '{\n  "a": [\n    2.5\n  ],\n  "b": 1\n}\n'
    """
    return json.dumps(value, indent=2, sort_keys=True, ensure_ascii=False) + "\n"


def hash_value(value: Any) -> str:
    """Return the SHA-256 of a plain value's canonical JSON, in hexadecimal.

    Parameters
    ----------
    value
        As for `canonical_json`.

    Examples
    --------
    >>> hash_value({"b": 1, "a": 2}) == hash_value({"a": 2, "b": 1})
    True
    """
    return hashlib.sha256(canonical_json(value).encode()).hexdigest()
