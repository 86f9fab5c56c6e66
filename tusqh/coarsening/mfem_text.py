"""Meshes with hanging vertices in the format of MFEM, version 1.1."""

from __future__ import annotations

import io
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.coarsening.coarse_mesh import CoarseMesh
from tusqh.errors import MeshError, SimulationError
from tusqh.extras import require
from tusqh.grid import IntArray
from tusqh.meshes.formats import Export, make_content
from tusqh.meshes.volume_mesh import VolumeMesh


def write_mfem_text(
    coarse: CoarseMesh, export: Export | None = None, attributes: IntArray | None = None
) -> str:
    """Return the text of a file: elements, sets of the boundary, hanging vertices, vertices.

    Parameters
    ----------
    coarse
        The mesh.
    export
        How its sets are found; None: by the mesh alone.
    attributes
        Attribute of every element, from 1, shape (m,); None: the number of its connected part.
    """
    mesh, text = coarse.mesh, io.StringIO()
    dim, n_cells = mesh.dim, mesh.n_cells
    geometry, facet = (3, 1) if dim == 2 else (5, 3)
    # No block is at the boundary, so its sets are those of the uniform mesh.
    content = make_content(coarse.uniform, None, export or Export())
    text.write("MFEM mesh v1.1\n\n# Boundary attributes:\n")
    for found in content.sets.once:
        text.write(f"# {found.number} {found.name}: {found.meaning}\n")
    if attributes is None:
        text.write("\n# Attributes of elements:\n")
        of_uniform = np.empty(content.mesh.n_cells, dtype=np.int64)
        for block in content.sets.blocks:
            text.write(f"# {block.number} {block.name}\n")
            of_uniform[block.elements] = block.number
        attributes = of_uniform[coarse.first_in_uniform()]
    text.write(f"\ndimension\n{dim}\n\nelements\n{n_cells}\n")
    head = np.stack([attributes, np.full(n_cells, geometry)], axis=1)
    np.savetxt(text, np.hstack([head, mesh.cells]), fmt="%d")
    corners, number = content.facets_once()
    text.write(f"\nboundary\n{len(corners)}\n")
    head = np.stack([number, np.full(len(corners), facet)], axis=1)
    np.savetxt(text, np.hstack([head, corners]), fmt="%d")
    text.write(f"\nvertex_parents\n{len(coarse.hanging)}\n")
    np.savetxt(text, coarse.hanging, fmt="%d")
    text.write(f"\nvertices\n{len(mesh.points)}\n{dim}\n")
    np.savetxt(text, mesh.points, fmt="%.17g")
    return text.getvalue()


def to_mfem(coarse: CoarseMesh, attributes: IntArray | None = None) -> Any:
    """Return a coarse mesh as an `mfem.ser.Mesh`.

    Parameters
    ----------
    coarse
        The mesh.
    attributes
        Attribute of every element, from 1, shape (m,); None: all 1.

    Raises
    ------
    SimulationError
        The mesh that it stands for fails our checks, or MFEM rejects the coarse one.
    """
    mfem = require("mfem.ser", extra="simulate")
    mesh = coarse.mesh
    try:
        coarse.uniform.measurement.require_sound()
    except MeshError as reason:
        raise _rejected(mesh, reason.found) from reason
    # MFEM makes meshes with hanging vertices from files only.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "coarse.mesh"
        path.write_text(write_mfem_text(coarse, attributes=attributes))
        try:
            native = mfem.Mesh(str(path), 1, 1)
        except RuntimeError as reason:
            raise _rejected(mesh, f"MFEM says: {reason}") from reason
    n_wrong = native.CheckElementOrientation(False)
    if native.GetNV() != len(mesh.points) or native.GetNE() != mesh.n_cells or n_wrong:
        raise _rejected(
            mesh,
            f"MFEM counts {native.GetNV()} vertices, {native.GetNE()} elements and {n_wrong} "
            f"wrongly oriented ones instead of {len(mesh.points)}, {mesh.n_cells} and 0",
        )
    return native


def _rejected(mesh: VolumeMesh, why: str) -> SimulationError:
    return SimulationError(
        f"the coarse mesh of {mesh.name!r} cannot be simulated on: {why}",
        where=mesh.name,
        expected="valid elements, and hanging vertices that lie between their parents",
        remedy="run `tusqh check` on the file for the check that fails",
    )
