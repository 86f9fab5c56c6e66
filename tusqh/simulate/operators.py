"""Assemble the mass and stiffness matrices of H1 elements with MFEM."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tusqh.coarsening import CoarseMesh
from tusqh.coarsening.mfem_text import to_mfem
from tusqh.extras import require
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.volume_mesh import VolumeMesh


@dataclass(frozen=True)
class Operators:
    """The discrete problem on a mesh.

    Parameters
    ----------
    mass, stiffness
        Sparse matrices of the forms (u, v) and (a grad u, grad v), shape (n_dofs, n_dofs), where a
        is the coefficient.
    nodes
        Positions of the degrees of freedom, shape (n_dofs, dim).  Hanging vertices have none.
    points, cells
        The mesh after refinement; at order 1 the points are the nodes.
    """

    mass: Any
    stiffness: Any
    nodes: FloatArray
    points: FloatArray
    cells: IntArray

    def scaled(self, factor: float) -> Operators:
        """Return the operators of the mesh in another unit of length.

        Parameters
        ----------
        factor
            A length times this factor is the length in the other unit.
        """
        dim = self.nodes.shape[1]
        return Operators(
            mass=self.mass * factor**dim,
            stiffness=self.stiffness * factor ** (dim - 2),
            nodes=self.nodes * factor,
            points=self.points * factor,
            cells=self.cells,
        )


def assemble(
    mesh: VolumeMesh | CoarseMesh,
    *,
    refinements: int = 0,
    order: int = 1,
    coefficient: FloatArray | None = None,
) -> Operators:
    """Return the matrices of H1 elements with natural (zero-flux) boundary conditions.

    Parameters
    ----------
    mesh
        The mesh, which is checked first.  In a coarse mesh, the values at hanging vertices are
        those that the elements between which they hang give them.
    refinements
        Uniform refinements before the assembly.
    order
        Polynomial order of the elements.
    coefficient
        Factor of (grad u, grad v) in every element, shape (m,); None: 1.

    Raises
    ------
    SimulationError
        The mesh is rejected, see `tusqh.meshes.volume_mesh.VolumeMesh.to_mfem`.
    """
    mfem = require("mfem.ser", extra="simulate")

    factors, attributes = np.unique(
        np.ones(_n_elements(mesh)) if coefficient is None else coefficient, return_inverse=True
    )
    if isinstance(mesh, CoarseMesh):
        native, mesh = to_mfem(mesh, attributes + 1), mesh.mesh
    else:
        native = mesh.to_mfem(attributes + 1)
    for _ in range(refinements):
        native.UniformRefinement()
    space = mfem.FiniteElementSpace(native, mfem.H1_FECollection(order, mesh.dim))
    mass = assemble_form(space, mfem.MassIntegrator())
    factor = mfem.PWConstCoefficient(mfem.Vector(factors.tolist()))
    stiffness = assemble_form(space, mfem.DiffusionIntegrator(factor))
    points = np.array(native.GetVertexArray(), dtype=np.float64).reshape(native.GetNV(), -1)
    cells = mesh.cells
    if refinements:
        cells = np.array([native.GetElementVertices(e) for e in range(native.GetNE())])
    nodes = points[:, : mesh.dim] if order == 1 else _nodes(native, order, mesh.dim)
    matrices = [_to_sparse(form.SpMat()) for form in (mass, stiffness)]
    if native.Nonconforming():
        prolongation = _to_sparse(space.GetConformingProlongation())
        matrices = [prolongation.T @ matrix @ prolongation for matrix in matrices]
        nodes = _to_sparse(space.GetConformingRestriction()) @ nodes
    return Operators(
        mass=matrices[0],
        stiffness=matrices[1],
        nodes=nodes,
        points=points[:, : mesh.dim],
        cells=cells.astype(np.int64),
    )


def _n_elements(mesh: VolumeMesh | CoarseMesh) -> int:
    return (mesh.mesh if isinstance(mesh, CoarseMesh) else mesh).n_cells


def assemble_form(space: Any, integrator: Any) -> Any:
    """Return MFEM's bilinear form of an integrator; its matrix lives as long as the form.

    Parameters
    ----------
    space
        An `mfem.FiniteElementSpace`.
    integrator
        An MFEM integrator over the elements.
    """
    form = require("mfem.ser", extra="simulate").BilinearForm(space)
    form.AddDomainIntegrator(integrator)
    form.Assemble()
    form.Finalize()
    return form


def to_arrays(matrix: Any) -> tuple[FloatArray, IntArray, IntArray]:
    """Return the arrays of an MFEM sparse matrix, which live longer than the matrix.

    Parameters
    ----------
    matrix
        An `mfem.SparseMatrix`.

    Returns
    -------
    entries, columns, starts
        Value and column of every entry, row by row, shape (k,); the first entry of every row, and
        the number of entries at the end, shape (n + 1,).
    """
    arrays = (matrix.GetDataArray(), matrix.GetJArray(), matrix.GetIArray())
    entries, columns, starts = (np.array(a) for a in arrays)
    return entries, columns, starts


def _nodes(native: Any, order: int, dim: int) -> FloatArray:
    """Return the positions of the degrees of freedom of elements of higher order."""
    mfem = require("mfem.ser", extra="simulate")

    vector_space = mfem.FiniteElementSpace(
        native, mfem.H1_FECollection(order, dim), dim, mfem.Ordering.byVDIM
    )
    nodes = mfem.GridFunction(vector_space)
    native.GetNodes(nodes)
    return np.array(nodes.GetDataArray()).reshape(-1, dim)


def _to_sparse(matrix: Any) -> Any:
    """Return an MFEM sparse matrix as a `scipy.sparse.csr_matrix` that owns its memory."""
    from scipy.sparse import csr_matrix

    return csr_matrix(to_arrays(matrix), shape=(matrix.Height(), matrix.Width()))
