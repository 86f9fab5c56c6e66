"""Convert a volume mesh that passes our checks to a mesh of MFEM."""

from __future__ import annotations

from typing import Any

import numpy as np

from tusqh.errors import MeshError, SimulationError
from tusqh.extras import require
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.element_mesh import ElementMesh
from tusqh.meshes.measure import Measurement


def to_mfem(measured: Measurement, attributes: IntArray | None = None) -> Any:
    """Return the `mfem.ser.Mesh` of a measured mesh of quads or hexes.

    MFEM silently accepts pinched, inverted, flat and orphaned input, and a bad index can crash the
    process, so the mesh must be sound.

    Parameters
    ----------
    measured
        The measurement of the mesh.
    attributes
        Attribute of every element, from 1, shape (m,); None: all 1.

    Raises
    ------
    SimulationError
        Our checks or MFEM reject the mesh; the message names the model.
    """
    mesh = measured.mesh
    if mesh.n_cells == 0:
        raise _rejected(mesh, "it has no elements")
    try:
        measured.require_sound()
    except MeshError as reason:
        raise _rejected(mesh, reason.found) from reason
    try:
        native = _from_arrays(mesh, np.ones(mesh.n_cells) if attributes is None else attributes)
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


def _from_arrays(mesh: ElementMesh, elements: FloatArray | IntArray) -> Any:
    """Return an MFEM mesh that owns a copy of the arrays; MFEM constructs the boundary itself."""
    mfem = require("mfem.ser", extra="simulate")

    coordinates = np.zeros((len(mesh.points), 3))
    coordinates[:, : mesh.dim] = mesh.points
    vertices = mfem.Vector(coordinates.size)
    vertices.GetDataArray()[:] = coordinates.ravel()
    corners, attributes = mfem.intArray(mesh.cells.size), mfem.intArray(mesh.n_cells)
    corners.GetDataArray()[:] = mesh.cells.ravel()
    attributes.GetDataArray()[:] = elements
    none = mfem.intArray(1)
    is_2d = mesh.dim == 2
    shape = mfem.Geometry.SQUARE if is_2d else mfem.Geometry.CUBE
    side = mfem.Geometry.SEGMENT if is_2d else mfem.Geometry.SQUARE
    borrowed = mfem.Mesh(
        vertices.GetData(),
        len(mesh.points),
        corners.GetData(),
        shape,
        attributes.GetData(),
        mesh.n_cells,
        none.GetData(),
        side,
        none.GetData(),
        0,
        mesh.dim,
        mesh.dim,
    )
    native = mfem.Mesh(borrowed, True)
    native.Finalize(False, False)
    return native


def _rejected(mesh: ElementMesh, why: str) -> SimulationError:
    return SimulationError(
        f"the mesh of {mesh.name!r} cannot be simulated on: {why}",
        where=mesh.name,
        expected="a conforming, manifold mesh of valid elements",
        remedy="read the model's verdict.csv for the check that fails",
    )
