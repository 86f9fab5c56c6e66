"""Measure the Betti numbers of a finished mesh from its connectivity alone, by two methods."""

from __future__ import annotations

from tusqh.grid import IndexArray
from tusqh.meshes.element_mesh import ElementMesh
from tusqh.meshes.facets import ClosedSurface, count_edges
from tusqh.meshes.numbering import count_components, count_components_by_parts, count_used
from tusqh.topology.betti_numbers import BettiNumbers


def betti_by_euler(mesh: ElementMesh) -> BettiNumbers:
    """Return the Betti numbers of a mesh from its components and Euler characteristic.

    Components are sets of elements that share points.  In 2D the holes follow from the Euler
    characteristic; in 3D the voids are the components of the boundary, less the outer ones, and
    the holes follow.

    Parameters
    ----------
    mesh
        The mesh.
    """
    facets = mesh.facets
    betti_0 = count_components(mesh.cells)
    n_points = count_used(mesh.cells)
    if mesh.dim == 2:
        return BettiNumbers(betti_0, betti_0 - (n_points - facets.n_unique + mesh.n_cells))
    euler = n_points - count_edges(mesh.cells) + facets.n_unique - mesh.n_cells
    return betti_from_euler(betti_0, euler, facets.boundary)


def betti_from_euler(betti_0: int, euler: int, boundary: IndexArray) -> BettiNumbers:
    """Return the Betti numbers of a mesh of hexes from its counts, see `betti_by_euler`.

    Parameters
    ----------
    betti_0
        Number of components of elements that share points.
    euler
        Euler characteristic of the mesh.
    boundary
        Points of the boundary faces, shape (m, 4).
    """
    betti_2 = count_components(boundary) - betti_0
    return BettiNumbers(betti_0, betti_0 + betti_2 - euler, betti_2)


def betti_by_boundary(mesh: ElementMesh) -> BettiNumbers:
    """Return the Betti numbers of a mesh from its boundary.

    Components are sets of elements that share facets; each has one outer boundary.  In 2D every
    other loop of the boundary is a hole.  In 3D every other surface is a void, and the number of
    holes is the total genus of all surfaces.  The result equals `betti_by_euler` only for manifold
    meshes.

    Parameters
    ----------
    mesh
        The mesh.

    Examples
    --------
    >>> import numpy as np
    >>> from tusqh.meshes.volume_mesh import VolumeMesh
    >>> points = np.array([[x, y] for x in range(4) for y in range(4)], dtype=float)
    >>> corners = np.array([[i * 4 + j, i * 4 + j + 4, i * 4 + j + 5, i * 4 + j + 1]
    ...                     for i in range(3) for j in range(3) if (i, j) != (1, 1)])
    >>> annulus = VolumeMesh.from_arrays(points, corners)
    >>> str(betti_by_boundary(annulus)), str(betti_by_euler(annulus))
    ('(1, 1, 0)', '(1, 1, 0)')
    """
    facets, boundary = mesh.facets, mesh.facets.boundary
    betti_0 = count_components_by_parts(facets.unique, len(facets.local))
    if mesh.dim == 2:
        return BettiNumbers(betti_0, count_components(boundary) - betti_0)
    return betti_from_boundary(betti_0, facets)


def betti_from_boundary(betti_0: int, surface: ClosedSurface) -> BettiNumbers:
    """Return the Betti numbers of a mesh of hexes from its boundary, see `betti_by_boundary`.

    Parameters
    ----------
    betti_0
        Number of components of elements that share faces.
    surface
        The boundary of the mesh.
    """
    boundary, sides = surface.boundary, surface.boundary_edges
    n_surfaces = count_components_by_parts(sides.unique, len(sides.local))
    euler = count_used(boundary) - sides.n_unique + len(boundary)
    return BettiNumbers(betti_0, n_surfaces - euler // 2, n_surfaces - betti_0)
