"""Assemble Q1 matrices of any mesh, sound or not, and compute properties that affect solvers.

MFEM accepts sound meshes only (`tusqh.meshes.mfem_mesh`), so the matrices of other meshes are
assembled here; on sound meshes they equal those of MFEM.
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy.linalg import eigvalsh_tridiagonal
from scipy.sparse import csr_matrix, diags_array
from scipy.sparse.csgraph import connected_components

from tusqh.grid import HEX_CORNERS, QUAD_CORNERS, BoolArray, FloatArray, IntArray
from tusqh.meshes.volume_mesh import VolumeMesh

#: Relative residual of a solution, to which iterations are counted.
_SOLVED = 1e-8
#: Relative residual at which the condition number is known: its relative error is then near 1e-9.
_SETTLED = 1e-12
_MAX_ITERATIONS = 5000


def element_matrices(mesh: VolumeMesh) -> tuple[FloatArray, FloatArray]:
    """Return the lumped mass and the stiffness matrix of every element.

    The Gauss points are those of MFEM: two along each axis in 2D, three in 3D.

    Parameters
    ----------
    mesh
        The mesh.

    Returns
    -------
    lumped
        Integral of every corner's shape function, shape (m, 2**dim), model units**dim.
    stiffness
        Integrals of products of gradients, shape (m, 2**dim, 2**dim), model units**(dim - 2).
    """
    dim = mesh.dim
    signs = 2.0 * (QUAD_CORNERS if dim == 2 else HEX_CORNERS) - 1
    corners = mesh.points[mesh.cells]
    lumped = np.zeros(mesh.cells.shape)
    stiffness = np.zeros((mesh.n_cells, 2**dim, 2**dim))
    places, weights = np.polynomial.legendre.leggauss(dim)
    for index in itertools.product(range(dim), repeat=dim):
        factors = (1 + signs * places[list(index)]) / 2
        shape = factors.prod(axis=1)
        slope = np.stack(
            [signs[:, k] / 2 * np.delete(factors, k, axis=1).prod(axis=1) for k in range(dim)], 1
        )
        jacobian = np.einsum("mci,cj->mij", corners, slope)
        weight = np.linalg.det(jacobian) * weights[list(index)].prod()
        gradient = np.einsum("cj,mji->mci", slope, np.linalg.inv(jacobian))
        lumped += weight[:, None] * shape
        stiffness += np.einsum("m,mai,mbi->mab", weight, gradient, gradient, optimize=True)
    return lumped, stiffness


def assemble_stiffness(mesh: VolumeMesh, stiffness: FloatArray) -> csr_matrix:
    """Return the sum of element matrices, shape (n_points, n_points).

    Parameters
    ----------
    mesh
        The mesh.
    stiffness
        Stiffness matrix of every element, shape (m, 2**dim, 2**dim).
    """
    n_corners = mesh.cells.shape[1]
    rows = np.repeat(mesh.cells, n_corners, axis=1).ravel()
    columns = np.tile(mesh.cells, (1, n_corners)).ravel()
    n = len(mesh.points)
    return csr_matrix((stiffness.ravel(), (rows, columns)), shape=(n, n))


def count_kernel(stiffness: csr_matrix) -> int:
    """Return the number of zero eigenvalues of a Neumann stiffness matrix, one per component.

    Parameters
    ----------
    stiffness
        The matrix of the whole mesh, shape (n_points, n_points).
    """
    return int(connected_components(stiffness, directed=False, return_labels=False))


def estimate_condition(stiffness: csr_matrix) -> tuple[float, int]:
    """Return the condition number of a singular matrix on its range, and the iterations needed.

    Conjugate gradients with Jacobi's preconditioner are equivalent to the Lanczos iteration: their
    coefficients form a tridiagonal matrix whose extreme eigenvalues approach those of the scaled
    matrix (Golub and Van Loan, Matrix Computations, 11.3).  The right-hand side is in the range, so
    the zero eigenvalues do not appear.

    Parameters
    ----------
    stiffness
        The matrix, symmetric and positive semi-definite.

    Returns
    -------
    condition
        Lower estimate of the ratio of the largest to the smallest positive eigenvalue of the scaled
        matrix, dimensionless, from the iteration to a relative residual of 1e-12.
    iterations
        Number of iterations to a relative residual of 1e-8.  It depends on the last digits of the
        matrix, and so on the processor: another one may need one iteration more or less.

    Examples
    --------
    >>> path = np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    >>> condition, iterations = estimate_condition(csr_matrix(path))
    >>> round(condition, 6), iterations
    (2.0, 2)
    """
    scale = 1 / np.sqrt(stiffness.diagonal())
    matrix = (diags_array(scale) @ stiffness @ diags_array(scale)).tocsr()
    residual = matrix @ np.random.default_rng(0).standard_normal(matrix.shape[0])
    direction = residual.copy()
    squared = float((residual * residual).sum())
    solved, settled = squared * _SOLVED**2, squared * _SETTLED**2
    iterations = 0
    diagonal: list[float] = []
    beside: list[float] = []
    step, ratio = 1.0, 0.0
    while squared > settled and len(diagonal) < _MAX_ITERATIONS:
        iterations += squared > solved
        image = matrix @ direction
        last_step, step = step, squared / float((direction * image).sum())
        diagonal.append(1 / step + ratio / last_step)
        residual -= step * image
        ratio, squared = 1 / squared, float((residual * residual).sum())
        ratio *= squared
        beside.append(np.sqrt(ratio) / step)
        direction = residual + ratio * direction
    if not diagonal:
        return 1.0, 0
    ends = eigvalsh_tridiagonal(np.array(diagonal), np.array(beside[:-1]))
    return float(ends[-1] / ends[0]), iterations


def label_parts(mesh: VolumeMesh) -> tuple[IntArray, int]:
    """Return the part of every element (joined by shared facets), and the number of parts.

    Parameters
    ----------
    mesh
        The mesh.

    Returns
    -------
    part, n_parts
        Part of each element, from 0, shape (m,), int64; number of parts.

    Examples
    --------
    >>> points = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [2, 1], [2, 2], [1, 2]])
    >>> quads = np.array([[0, 1, 2, 3], [2, 4, 5, 6]])
    >>> label_parts(VolumeMesh.from_arrays(points, quads))[1]      # they share a vertex
    2
    """
    facets = mesh.facets
    order = np.argsort(facets.unique, kind="stable")
    same = facets.unique[order[1:]] == facets.unique[order[:-1]]
    pairs = (facets.cell[order[:-1]][same], facets.cell[order[1:]][same])
    graph = csr_matrix((np.ones(len(pairs[0])), pairs), shape=(mesh.n_cells,) * 2)
    n_parts, part = connected_components(graph, directed=False)
    return part.astype(np.int64), int(n_parts)


def count_mechanisms(mesh: VolumeMesh) -> int:
    """Return the number of zero modes of an elastic mesh beyond rigid motions of its components.

    Parts joined only by a vertex or an edge can rotate about it without energy, which gives
    additional zero eigenvalues of the elastic stiffness matrix.  The count assumes that each part
    moves rigidly, and that each point shared by parts moves with all of them.

    Parameters
    ----------
    mesh
        The mesh.
    """
    part, n_parts = label_parts(mesh)
    dim, n_rigid = mesh.dim, mesh.dim * (mesh.dim + 1) // 2
    pairs = np.unique(
        np.stack([mesh.cells.ravel(), np.repeat(part, mesh.cells.shape[1])], axis=1), axis=0
    )
    n_parts_at = np.bincount(pairs[:, 0])
    pairs = pairs[n_parts_at[pairs[:, 0]] > 1]
    if len(pairs) == 0:
        return 0
    is_next = pairs[1:, 0] == pairs[:-1, 0]
    tied, others = pairs[:-1][is_next], pairs[1:][is_next]
    centre, size = mesh.points.mean(axis=0), np.ptp(mesh.points, axis=0).max()
    motion = _rigid_motions((mesh.points[tied[:, 0]] - centre) / size)
    rows = np.zeros((len(tied), dim, n_parts, n_rigid))
    at = np.arange(len(tied))
    rows[at, :, tied[:, 1]] += motion
    rows[at, :, others[:, 1]] -= motion
    kernel = n_parts * n_rigid - int(np.linalg.matrix_rank(rows.reshape(len(tied) * dim, -1)))
    joined = csr_matrix((np.ones(len(tied)), (tied[:, 1], others[:, 1])), shape=(n_parts,) * 2)
    return kernel - n_rigid * int(connected_components(joined, directed=False)[0])


def _rigid_motions(points: FloatArray) -> FloatArray:
    """Return the displacement of points under each rigid motion, shape (n, dim, n_rigid)."""
    n, dim = points.shape
    planes = list(itertools.combinations(range(dim), 2))
    motion = np.zeros((n, dim, dim + len(planes)))
    motion[:, np.arange(dim), np.arange(dim)] = 1.0
    for column, (a, b) in enumerate(planes, start=dim):
        motion[:, a, column], motion[:, b, column] = -points[:, b], points[:, a]
    return motion


def points_of(mesh: VolumeMesh, elements: BoolArray) -> BoolArray:
    """Return whether each point belongs to a chosen element, shape (n_points,).

    Parameters
    ----------
    mesh
        The mesh.
    elements
        Whether each element is chosen, shape (m,).
    """
    is_used = np.zeros(len(mesh.points), dtype=bool)
    is_used[mesh.cells[elements].ravel()] = True
    return is_used
