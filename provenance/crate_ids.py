"""Identifiers of files and scripts in the RO-Crate."""

from __future__ import annotations

import base64
from pathlib import PurePosixPath
from typing import Any

#: The folder of the crate.
ROOT = PurePosixPath("results")


def file_id(entry: dict[str, Any]) -> str:
    """Return the identifier of a file: its path in the crate, or the digest of its bytes.

    Parameters
    ----------
    entry
        The entry of the file in a record: its path, digest and size.
    """
    if is_inside(entry["path"]):
        return PurePosixPath(entry["path"]).relative_to(ROOT).as_posix()
    digest = base64.urlsafe_b64encode(bytes.fromhex(entry["sha256"])).decode().rstrip("=")
    return f"ni:///sha-256;{digest}"  # RFC 6920


def tool_id(script: str) -> str:
    """Return the identifier of a script.

    Parameters
    ----------
    script
        The script, relative to the root of the repository.
    """
    return f"workflow/{script}"


def is_inside(path: str) -> bool:
    """Return whether a file is inside the crate.

    Parameters
    ----------
    path
        The file, relative to the current folder.
    """
    return PurePosixPath(path).is_relative_to(ROOT)
