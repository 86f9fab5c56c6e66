"""The number of zero eigenvalues of the Neumann stiffness matrix."""

from __future__ import annotations

from scipy.sparse.csgraph import connected_components

from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.simulate.operators import assemble


def count_zero_modes(mesh: VolumeMesh) -> int:
    """Return how many independent fields cost no energy: one per connected component.

    The energy of a field is the integral of its squared gradient, which is zero only for fields
    that are constant on every component; so the zero eigenvalues of the stiffness matrix are as
    many as the components of its sparsity pattern, which are counted here on MFEM's matrix.

    Raises
    ------
    SimulationError
        The mesh is rejected.
    """
    stiffness = assemble(mesh).stiffness
    stiffness.eliminate_zeros()
    return int(connected_components(stiffness, directed=False, return_labels=False))
