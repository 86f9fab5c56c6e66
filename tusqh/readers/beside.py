"""List the files that belong to a geometry file, without reading the geometry."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from urllib.parse import unquote

from tusqh.readers.formats import suffix_of

#: Number of bytes in which the header of an image names its data.
_HEAD = 1 << 16


def files_beside(path: Path) -> list[Path]:
    """Return the files that a geometry is read from, beside the one that is given.

    They are the system of a shapefile, the other slices of a DICOM series, the data of an image
    whose header is a file of its own, and the buffers of glTF.  Files that are missing or in
    another folder are not listed; reading the geometry reports them.

    Parameters
    ----------
    path
        The geometry file; if there is none, none are beside it.

    Returns
    -------
    files
        In the folder of the file, sorted.
    """
    find = _FINDERS.get(suffix_of(path))
    if find is None or not path.is_file():
        return []
    folder = path.parent.resolve()
    found = {other for other in find(path) if other != path}
    return sorted(p for p in found if p.is_file() and p.resolve().is_relative_to(folder))


def _system(path: Path) -> list[Path]:
    """Return the files that may state the coordinate system of a shapefile."""
    return [path.with_suffix(suffix) for suffix in (".prj", ".PRJ")]


def _slices(path: Path) -> list[Path]:
    """Return the files with the same suffix, which may be slices of the same series."""
    return [other for other in path.parent.iterdir() if other.suffix == path.suffix]


def _named(pattern: str) -> Callable[[Path], list[Path]]:
    """Return a function that returns the file that a line of a header names."""

    def find(path: Path) -> list[Path]:
        with path.open("rb") as file:
            head = file.read(_HEAD).decode("utf-8", errors="replace")
        names = re.findall(pattern, head, re.IGNORECASE | re.MULTILINE)
        return [path.parent / name.strip() for name in names if "\0" not in name]

    return find


def _buffers(path: Path) -> list[Path]:
    """Return the buffers that a glTF file in text names."""
    try:
        buffers = json.loads(path.read_bytes())["buffers"]
        names = [buffer["uri"] for buffer in buffers if "uri" in buffer]
        return [path.parent / unquote(name) for name in names if not name.startswith("data:")]
    except (ValueError, LookupError, TypeError, AttributeError):
        return []


_DATA_OF_NRRD = _named(r"^data ?file:[ \t]*([^\r\n]+)")
_DATA_OF_METAIMAGE = _named(r"^ElementDataFile[ \t]*=[ \t]*([^\r\n]+)")
_FINDERS: dict[str, Callable[[Path], list[Path]]] = {
    ".shp": _system,
    ".dcm": _slices,
    **dict.fromkeys((".nrrd", ".nhdr"), _DATA_OF_NRRD),
    **dict.fromkeys((".mha", ".mhd"), _DATA_OF_METAIMAGE),
    ".gltf": _buffers,
}
