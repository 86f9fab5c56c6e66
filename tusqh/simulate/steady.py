"""Solve steady diffusion in several materials, and measure the flux through their interfaces.

The equation ``div(D grad u) = 0`` with the diffusivity D of each material is discretized with H1
elements.  The flux out of a set of nodes is the residual of the equation there, which is the flux
that the discrete equation conserves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve

from tusqh.errors import SimulationError
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.simulate.operators import assemble


@dataclass(frozen=True)
class SteadyField:
    """A steady field in several materials.

    Parameters
    ----------
    values
        The field at the points of the mesh, shape (n,).
    stiffness
        The stiffness matrix of every material, with its diffusivity, by name.
    """

    values: FloatArray
    stiffness: Mapping[str, csr_matrix]

    def flux_from(self, material: str, points: IntArray) -> float:
        """Return the flux that leaves a material through some of its points.

        Parameters
        ----------
        material
            The material.
        points
            Points on its boundary, shape (r,).

        Returns
        -------
        float
            Amount per time, in the units of diffusivity times field times length^(dim - 2).
        """
        return -float((self.stiffness[material] @ self.values)[points].sum())


def solve_steady(
    mesh: VolumeMesh,
    regions: Regions,
    diffusivities: Mapping[str, float],
    fixed: Mapping[float, IntArray],
) -> SteadyField:
    """Return the steady field with given values at some points and no flux through other sides.

    Parameters
    ----------
    mesh
        The mesh.
    regions
        The material of every element.
    diffusivities
        Diffusivity of every material that has elements, by name.
    fixed
        Points by the value of the field there.

    Raises
    ------
    SimulationError
        A material has no positive diffusivity, or no value is given anywhere.
    """
    present = [regions.names[k] for k in np.unique(regions.material).tolist()]
    missing = [name for name in present if not diffusivities.get(name, 0.0) > 0]
    if missing or not fixed:
        raise SimulationError(
            f"no diffusivity of {', '.join(missing)}" if missing else "no given values",
            where=mesh.name,
            expected="a positive diffusivity for each material, and values at some points",
            remedy="add them",
        )
    stiffness = {}
    for name in present:
        is_own = regions.material == regions.names.index(name)
        stiffness[name] = assemble(mesh, coefficient=is_own * diffusivities[name]).stiffness
    system = sum(stiffness.values())
    values = np.zeros(len(mesh.points))
    is_free = np.ones(len(mesh.points), dtype=bool)
    for value, points in fixed.items():
        values[points], is_free[points] = value, False
    right = -(system @ values)[is_free]
    values[is_free] = spsolve(system[is_free][:, is_free].tocsc(), right)
    return SteadyField(values, stiffness)
