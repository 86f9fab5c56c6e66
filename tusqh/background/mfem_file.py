"""Read linear meshes in MFEM's own format."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

import numpy as np

from tusqh.errors import MeshError
from tusqh.grid import FloatArray, IntArray

#: Kinds of element by their number in the file, and their corners.
_KINDS = {
    1: ("line", 2),
    2: ("triangle", 3),
    3: ("quad", 4),
    4: ("tetra", 4),
    5: ("hexahedron", 8),
    6: ("wedge", 6),
    7: ("pyramid", 5),
}


def is_mfem(path: Path) -> bool:
    """Return whether a file states that it is one of MFEM.

    Parameters
    ----------
    path
        The file.
    """
    with path.open("rb") as stream:
        return stream.read(4) == b"MFEM"


def read_mfem(path: Path) -> tuple[FloatArray, list[tuple[str, IntArray]]]:
    """Return the points and the elements of a file, in blocks of one kind.

    Parameters
    ----------
    path
        The file, version 1.0.

    Raises
    ------
    MeshError
        The mesh has hanging vertices, is curved, or is damaged.

    Returns
    -------
    points
        Coordinates, shape (n, dim).
    blocks
        Kind and corners of the elements.
    """
    lines = [line.partition("#")[0].strip() for line in path.read_text("utf-8").splitlines()]
    lines = [line for line in lines if line]
    if lines[0] != "MFEM mesh v1.0" or "nodes" in lines or "vertex_parents" in lines:
        raise _error(path, f"is `{lines[0]}` with hanging vertices or curved elements")
    try:
        points = _read_points(lines)
        rows = [np.array(line.split(), dtype=np.int64) for line in _section(lines, "elements")]
        by_kind = groupby(rows, key=lambda row: int(row[1]))
        blocks = [
            (_KINDS[kind][0], np.stack([row[2 : 2 + _KINDS[kind][1]] for row in group]))
            for kind, group in by_kind
        ]
    except (ValueError, IndexError, KeyError) as reason:
        raise _error(path, f"is damaged: {reason}") from reason
    return points, blocks


def _section(lines: list[str], name: str) -> list[str]:
    """Return the lines of a section, which states their number first."""
    at = lines.index(name)
    n = int(lines[at + 1])
    found = lines[at + 2 : at + 2 + n]
    if len(found) < n:
        raise ValueError(f"the section {name} ends too early")
    return found


def _read_points(lines: list[str]) -> FloatArray:
    at = lines.index("vertices")
    n, dim = int(lines[at + 1]), int(lines[at + 2])
    text = " ".join(lines[at + 3 : at + 3 + n])
    return np.array(text.split(), dtype=np.float64).reshape(n, dim)


def _error(path: Path, found: str) -> MeshError:
    return MeshError(
        found,
        where=str(path),
        expected="a linear, conforming mesh, `MFEM mesh v1.0`",
        remedy="let MFEM save such a mesh, or convert it to VTU",
    )
