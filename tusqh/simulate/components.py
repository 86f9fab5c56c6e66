"""Count the components of the matrix that MFEM assembles."""

from __future__ import annotations

from scipy.sparse.csgraph import connected_components

from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.simulate.operators import assemble


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
    stiffness = assemble(mesh).stiffness
    stiffness.eliminate_zeros()
    return int(connected_components(stiffness, directed=False, return_labels=False))
