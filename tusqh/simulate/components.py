"""Count the components of the matrix that MFEM assembles."""

from __future__ import annotations

import numpy as np

from tusqh.extras import require
from tusqh.grid.components import label_components
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.simulate.operators import assemble_form, to_arrays


def count_matrix_components(mesh: VolumeMesh) -> int:
    """Return the number of components that MFEM's stiffness matrix couples.

    Two unknowns belong to the same component if a chain of nonzero entries connects them.  On a
    conforming mesh this number equals the number of components of the mesh and the number of zero
    eigenvalues of the Neumann problem; it tests that MFEM reads the mesh's connectivity correctly.

    Parameters
    ----------
    mesh
        The mesh.

    Raises
    ------
    SimulationError
        The mesh is rejected.
    """
    mfem = require("mfem.ser", extra="simulate")

    native = mesh.to_mfem()
    space = mfem.FiniteElementSpace(native, mfem.H1_FECollection(1, mesh.dim))
    integrator = mfem.DiffusionIntegrator()
    # Two points along each axis are exact for parallelepipeds; MFEM takes three by itself.
    integrator.SetIntRule(mfem.IntRules.Get(native.GetElementBaseGeometry(0), 3))
    form = assemble_form(space, integrator)
    entries, columns, starts = to_arrays(form.SpMat())
    rows = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    is_linked = entries != 0
    return label_components(rows[is_linked], columns[is_linked], len(starts) - 1)[1]
