"""Check, before reading, that a file is regular, has its stated format, and fits in memory."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable
from pathlib import Path

from tusqh.errors import GeometryError
from tusqh.machine import available_memory
from tusqh.readers.content import recognise
from tusqh.readers.formats import Format, suffix_of

_KINDS: tuple[tuple[Callable[[int], bool], str], ...] = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


def check_file(path: Path, found: Format) -> None:
    """Raise an error if a file cannot be read in its format, before reading the whole file.

    Only a few kilobytes are read; pipes and devices are never opened.

    Parameters
    ----------
    path
        The file.
    found
        The format that its suffix names.

    Raises
    ------
    GeometryError
        There is no such file; it is a folder, pipe, socket or device; reading is not permitted; it
        is empty, needs more memory than is available, or has another format.
    """
    size = _size_of_regular(path)
    require_memory(path, int(size * found.growth), what=f"reading its {_in_gb(size)}")
    content = recognise(path)
    if content is None or suffix_of(path) in content.suffixes:
        return
    if content.suffixes:
        renamed = path.with_suffix(content.suffixes[0]).name
        remedy = f"rename it to {renamed}"
    elif "archive" in content.name or "compressed" in content.name:
        remedy = "unpack it and give the file with the geometry"
    else:
        remedy = f"export the geometry as {found.name}, or in another format that is read"
    raise GeometryError(
        f"the file cannot be read: it is {content.name}",
        where=str(path),
        expected=f"a file of the format {found.name}, as its suffix {path.suffix} says",
        remedy=remedy,
    )


def check_part(path: Path, name: str) -> Path:
    """Return the path of a file that belongs to another file, after checking its location.

    Parameters
    ----------
    path
        The file that refers to it.
    name
        The name, relative to the folder of the file.

    Raises
    ------
    GeometryError
        The name leads out of that folder, or the target is not a regular file.
    """
    folder = path.parent.resolve()
    part = folder / name
    if "\0" in name or not part.resolve().is_relative_to(folder):
        raise GeometryError(
            f"it takes a part of its data from {name[:60]!r}, outside its own folder",
            where=str(path),
            expected="all files of a geometry in one folder",
            remedy="put them into one folder, and name them without a folder",
        )
    if not part.is_file():
        raise GeometryError(
            f"its data is in {name[:60]!r}, and there is no such file",
            where=str(path),
            expected="the files that belong to it in the same folder",
            remedy="copy the files that belong to it too",
        )
    return part


def require_memory(path: Path, needed: int, *, what: str) -> None:
    """Raise an error if an operation needs more memory than is available.

    Parameters
    ----------
    path
        The file.
    needed
        The estimate, in bytes.
    what
        The operation, such as "reading its 10.0 GB".

    Raises
    ------
    GeometryError
        The estimate exceeds the available memory.
    """
    available = available_memory()
    if needed > available:
        raise GeometryError(
            f"{what} needs about {_in_gb(needed)} of memory",
            where=str(path),
            expected=f"at most the {_in_gb(available)} that are available",
            remedy="simplify or crop the geometry, or use a machine with more memory",
        )


def _size_of_regular(path: Path) -> int:
    """Return the size of a regular file that is not empty and may be read."""
    try:
        status = path.stat()
    except (OSError, ValueError) as error:
        reason = "" if isinstance(error, FileNotFoundError) else f" ({_reason(error)})"
        raise _wrong(path, f"there is no such file{reason}", "check the path") from None
    for is_kind, name in _KINDS:
        if is_kind(status.st_mode):
            remedy = "give a file in it" if name == "a folder" else "write its data to a file"
            raise _wrong(path, f"it is {name}", remedy)
    if not os.access(path, os.R_OK):
        raise _wrong(path, "you may not read it", "ask for the permission, or copy it")
    if status.st_size == 0:
        raise _wrong(path, "the file is empty", "export or copy it again")
    return status.st_size


def _wrong(path: Path, found: str, remedy: str) -> GeometryError:
    """Return the error for something that is not a file with a geometry."""
    return GeometryError(found, where=str(path), expected="a geometry file", remedy=remedy)


def _reason(error: Exception) -> str:
    """Return why a path cannot be examined."""
    return str(getattr(error, "strerror", None) or error)


def _in_gb(n_bytes: int) -> str:
    """Return a number of bytes as text."""
    return f"{n_bytes / 1e9:.1f} GB" if n_bytes >= 1e8 else f"{n_bytes / 1e6:.1f} MB"
