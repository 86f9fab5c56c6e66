"""Read a background mesh from VTU, VTK, Gmsh, Exodus, Abaqus and MFEM files."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.background.checks import require_background
from tusqh.background.mfem_file import is_mfem, read_mfem
from tusqh.errors import MeshError
from tusqh.extras import require
from tusqh.geometry.remark import Remark
from tusqh.grid import FloatArray, IntArray
from tusqh.grid.arrays import as_indices
from tusqh.meshes.jacobians import smallest_jacobians

#: Suffixes of the files, and meshio's name of the format.
FORMATS = {
    ".vtu": "vtu",
    ".vtk": "vtk",
    ".msh": "gmsh",
    ".e": "exodus",
    ".ex2": "exodus",
    ".exo": "exodus",
    ".inp": "abaqus",
    ".mesh": "MFEM",
}
_SHOWN = ", ".join(FORMATS)

#: Kinds of element of each dimension, as meshio calls them; others are of a higher order.
_SOLIDS = {"tetra", "hexahedron", "wedge", "pyramid"}
_FACES = {"triangle", "quad", "polygon"}
#: Corners of a cell whose numbering runs the other way.
_TURNED = {4: [0, 3, 2, 1], 8: [4, 5, 6, 7, 0, 1, 2, 3]}


def read_background(path: Path | str, *, unit: str = "") -> BackgroundMesh:
    """Return the background mesh in a file, checked.

    Elements of lower dimension, such as the boundary quads of a mesh of hexes, are left out, as are
    points that no cell uses.  Cells that are all numbered the other way are turned.

    Parameters
    ----------
    path
        The file; its suffix names the format.
    unit
        Unit of length of its coordinates; empty if it is not known.

    Raises
    ------
    MeshError
        The file cannot be read, its cells are not only quads in a plane or only hexes, or they
        cannot be a background, see `tusqh.background.checks.require_background`.
    """
    path = Path(path)
    points, blocks = _load(path)
    cells, remarks = _choose_cells(path, blocks)
    if not np.isfinite(points).all():
        raise _error(path, "has coordinates that are not finite", "finite numbers", "mend the file")
    if len(cells) and not 0 <= cells.min() <= cells.max() < len(points):
        raise _error(path, "has corners without a point", "numbers of points", "mend the file")
    is_used = np.zeros(len(points), dtype=bool)
    is_used[cells] = True
    n_unused = len(points) - int(is_used.sum())
    if n_unused:
        remarks.append(Remark("left out", "points of the background without a cell", n_unused))
    number = np.cumsum(is_used) - 1
    places = _in_plane(path, points[is_used]) if cells.shape[1] == 4 else points[is_used]
    cells = number[cells]
    if (smallest_jacobians(places, cells).determinant < 0).all():
        turned = cells[:, _TURNED[cells.shape[1]]]
        if (smallest_jacobians(places, turned).determinant > 0).any():
            cells = turned
            remarks.append(Remark("changed", "cells of the background turned over", len(cells)))
    background = BackgroundMesh(places, as_indices(cells), path.name, unit, tuple(remarks))
    require_background(background)
    return background


def _load(path: Path) -> tuple[FloatArray, list[tuple[str, IntArray]]]:
    """Return the points and the blocks of elements of a file."""
    kind = FORMATS.get(path.suffix.lower())
    if kind is None:
        raise _error(
            path, "has no suffix of a mesh", f"one of {_SHOWN}", "convert the mesh, to VTU say"
        )
    if not path.is_file():
        raise _error(path, "there is no such file", "a background mesh", "correct the path")
    if kind == "exodus":
        require("netCDF4", extra="formats")
    if kind == "MFEM":
        if is_mfem(path):
            return read_mfem(path)
        kind = "medit"
    import meshio

    try:
        mesh = meshio.read(path, file_format=kind)
    except (Exception, SystemExit) as reason:  # meshio raises anything, and ends the process.
        raise _error(
            path, f"cannot be read as {kind}: {reason}", "a complete file", "write the mesh again"
        ) from reason
    return np.asarray(mesh.points, dtype=np.float64), list(_blocks_of(mesh))


def _blocks_of(mesh: Any) -> Iterator[tuple[str, IntArray]]:
    for block in mesh.cells:
        yield block.type, np.asarray(block.data)


def _choose_cells(path: Path, blocks: list[tuple[str, IntArray]]) -> tuple[IntArray, list[Remark]]:
    """Return the hexes, or else the quads, and a remark on elements of lower dimension."""
    counts: Counter[str] = Counter()
    for kind, data in blocks:
        counts[kind] += len(data)
    in_space = [kind for kind in counts if _is_of(kind, _SOLIDS)]
    top = in_space or [kind for kind in counts if _is_of(kind, _FACES)]
    wanted = "hexahedron" if in_space else "quad"
    shown = ", ".join(f"{counts[kind]} {kind}" for kind in sorted(counts)) or "no elements"
    if top != [wanted]:
        raise _error(
            path,
            f"has {shown}",
            "only quads with 4 corners, or only hexes with 8 corners",
            "split each tetrahedron into 4 hexes or each triangle into 3 quads (Gmsh: "
            "`Mesh.SubdivisionAlgorithm`), and export linear elements",
        )
    cells = np.concatenate([data for kind, data in blocks if kind == wanted]).astype(np.int64)
    lower = sum(n for kind, n in counts.items() if kind != wanted)
    what = "elements of lower dimension in the background"
    return cells, [Remark("left out", what, lower)] if lower else []


def _is_of(kind: str, kinds: set[str]) -> bool:
    """Return whether a kind, of any order, belongs to some kinds."""
    return kind.rstrip("0123456789") in kinds


def _in_plane(path: Path, points: FloatArray) -> FloatArray:
    """Return the x and y of points, which must have one z."""
    if points.shape[1] == 2:
        return points
    extent = float(np.ptp(points[:, :2], axis=0).max())
    height = float(np.ptp(points[:, 2]))
    if height > 1e-9 * extent:
        raise _error(
            path,
            f"has quads with z from {points[:, 2].min():g} to {points[:, 2].max():g}",
            "quads in a plane of constant z",
            "give a mesh of hexes, or flatten the quads",
        )
    return np.ascontiguousarray(points[:, :2])


def _error(path: Path, found: str, expected: str, remedy: str) -> MeshError:
    return MeshError(found, where=str(path), expected=expected, remedy=remedy)
