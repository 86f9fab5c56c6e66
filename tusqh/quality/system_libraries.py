"""System libraries that Python wheels expect to find and cannot bring."""

from __future__ import annotations

import ctypes
import sys

from tusqh.errors import TusqhError

#: Library, the Debian package that has it, and what is lost without it.
REQUIRED = (
    ("libGL.so.1", "libgl1", "pymeshlab's checks of the mesh surface"),
    ("libX11.so.6", "libx11-6", "pymeshlab's checks of the mesh surface"),
)


class SystemLibraryError(TusqhError):
    """A system library is missing that a Python package needs."""


def find_missing_libraries() -> list[tuple[str, str, str]]:
    """Return those rows of `REQUIRED` that cannot be loaded; none are looked for off Linux."""
    return [row for row in REQUIRED if sys.platform == "linux" and not _can_load(row[0])]


def describe_missing() -> str:
    """Return a line for users about missing libraries, empty when there are none."""
    missing = find_missing_libraries()
    if not missing:
        return ""
    names = ", ".join(name for name, _, _ in missing)
    packages = " ".join(package for _, package, _ in missing)
    costs = "; ".join(sorted({cost for _, _, cost in missing}))
    return f"{names} not found: install {packages} (Debian, Ubuntu). Without: {costs} are not run."


def _can_load(name: str) -> bool:
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True
