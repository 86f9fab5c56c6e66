"""Add middle nodes to a mesh, which lie on the geometry at a fitted boundary."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.meshes.elements import Element
from tusqh.meshes.facets import HEX_EDGES, QUAD_FACETS
from tusqh.meshes.numbering import number_rows
from tusqh.meshes.volume_mesh import VolumeMesh

#: Moves points of a boundary onto the geometry: their places, whether each is on a sharp edge, and
#: how far each may move.
Mover = Callable[[FloatArray, BoolArray, FloatArray], FloatArray]

#: How far a middle node may move, in lengths of its edge.
_FAR = 0.25

#: Cosine of the angle between facets beyond which their common edge is sharp.
_SHARP = np.cos(np.radians(40.0))

#: Most times that middle nodes of inverted elements are put back.
_ROUNDS = 20


@dataclass(frozen=True)
class Nodes:
    """The nodes of a mesh and of its elements.

    Parameters
    ----------
    points
        Coordinates of all nodes, those of the corners first, shape (n, dim).
    cells
        Nodes of every element in VTK's order, shape (m, k).
    n_moved, n_straight
        Middle nodes that were moved onto the geometry, and those that stay in the middle of their
        edge because an element would be inverted.
    """

    points: FloatArray
    cells: IntArray
    n_moved: int = 0
    n_straight: int = 0


def make_nodes(mesh: VolumeMesh, element: Element, mover: Mover | None = None) -> Nodes:
    """Return the nodes of a mesh for a kind of element.

    Parameters
    ----------
    mesh
        The mesh.
    element
        The element.
    mover
        Moves middle nodes of the boundary onto the geometry; None: they stay in the middle.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> mesh = VolumeMesh.from_arrays(square, [[0, 1, 2, 3]])
    >>> make_nodes(mesh, Element.of("quad8", 2)).points[4:].tolist()
    [[0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]]
    """
    if not element.is_quadratic:
        return Nodes(mesh.points, mesh.cells)
    local = QUAD_FACETS if mesh.dim == 2 else HEX_EDGES
    number, n_edges = number_rows(mesh.cells, local)
    ends = np.empty((n_edges, 2), dtype=np.int64)
    ends[number] = mesh.cells[:, local].reshape(-1, 2)
    of_cell = number.reshape(-1, len(local)).astype(np.int64)
    straight = mesh.points[ends].mean(axis=1)
    middle = straight.copy()
    is_moved = np.zeros(n_edges, dtype=np.bool_)
    n_straight = 0
    if mover is not None:
        rows, is_sharp = _boundary_edges(mesh, ends)
        length = np.linalg.norm(mesh.points[ends[rows, 1]] - mesh.points[ends[rows, 0]], axis=1)
        middle[rows] = mover(straight[rows], is_sharp, _FAR * length)
        is_moved = (middle != straight).any(axis=1)
        n_wanted = int(is_moved.sum())
        _put_back(mesh, of_cell, middle, straight, is_moved)
        n_straight = n_wanted - int(is_moved.sum())
    n = len(mesh.points)
    points, cells = np.concatenate([mesh.points, middle]), np.hstack([mesh.cells, n + of_cell])
    if element.n_nodes in (9, 27):
        points, cells = _add_centres(mesh, points, cells)
    return Nodes(points, cells, int(is_moved.sum()), n_straight)


def _boundary_edges(mesh: VolumeMesh, ends: IntArray) -> tuple[IntArray, BoolArray]:
    """Return the edges on the boundary, and whether each is sharp."""
    corners, n = mesh.boundary.corners.astype(np.int64), len(mesh.points)
    edge = np.sort(ends, axis=1) @ np.array([n, 1])
    order = np.argsort(edge)
    if mesh.dim == 2:
        rows = order[np.searchsorted(edge[order], np.sort(corners, axis=1) @ np.array([n, 1]))]
        return np.sort(rows), np.zeros(len(rows), dtype=np.bool_)
    places = mesh.points[corners]
    normals = np.cross(places[:, 2] - places[:, 0], places[:, 3] - places[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    sides = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2), axis=2)
    keys, row = np.unique((sides @ np.array([n, 1])).ravel(), return_inverse=True)
    total = np.zeros((len(keys), 3))
    np.add.at(total, row, np.repeat(normals, 4, axis=0))
    # The sum of two unit normals with the angle t is as long as the root of 2 + 2 cos t.
    is_sharp = (total**2).sum(axis=1) < 2 + 2 * _SHARP
    rows = order[np.searchsorted(edge[order], keys)]
    back = np.argsort(rows)
    return rows[back], is_sharp[back]


def _put_back(
    mesh: VolumeMesh,
    of_cell: IntArray,
    middle: FloatArray,
    straight: FloatArray,
    is_moved: BoolArray,
) -> None:
    """Put middle nodes back, in place, where an element would be inverted."""
    for _ in range(_ROUNDS):
        cells = np.flatnonzero(is_moved[of_cell].any(axis=1))
        nodes = np.concatenate([mesh.points[mesh.cells[cells]], middle[of_cell[cells]]], axis=1)
        is_bad = smallest_determinants(nodes) <= 0
        if not is_bad.any():
            return
        back = of_cell[cells[is_bad]].ravel()
        middle[back], is_moved[back] = straight[back], False


def smallest_determinants(nodes: FloatArray) -> FloatArray:
    """Return the smallest Jacobian determinant at the nodes of quadratic elements, shape (m,).

    The element with nodes on its edges alone is the one whose other nodes follow from these.

    Parameters
    ----------
    nodes
        Nodes of every element in VTK's order, without centres, shape (m, 8, 2) or (m, 20, 3).
    """
    smallest = np.full(len(nodes), np.inf)
    for gradient in _GRADIENTS[nodes.shape[2]]:
        jacobian = np.einsum("ak,mai->mki", gradient, nodes)
        np.minimum(smallest, np.linalg.det(jacobian), out=smallest)
    return smallest


def _serendipity_gradients(dim: int) -> FloatArray:
    """Return the derivatives of all shape functions at the nodes, also at centres."""
    corner = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    edges = QUAD_FACETS
    if dim == 3:
        corner = np.array([[*row, z] for z in (0, 1) for row in corner.tolist()])
        edges = HEX_EDGES
    corner = 2.0 * corner - 1
    own = np.concatenate([corner, corner[edges].mean(axis=1)])
    axis = np.stack(np.meshgrid(*dim * [[-1.0, 0.0, 1.0]], indexing="ij"), axis=-1)
    places = axis.reshape(-1, dim)
    gradients = np.empty((len(places), len(own), dim))
    # Fit the monomials of the element to the nodes, so that no formula is written twice.
    powers = [p for p in np.ndindex(*dim * (3,)) if sum(k for k in p if k > 1) <= 2]
    at_nodes = np.stack([np.prod(own ** np.array(p), axis=1) for p in powers], axis=1)
    coefficients = np.linalg.inv(at_nodes)
    for k in range(dim):
        rows = []
        for p in powers:
            lower = np.array(p)
            factor = lower[k]
            lower[k] = max(lower[k] - 1, 0)
            rows.append(factor * np.prod(places**lower, axis=1))
        gradients[:, :, k] = np.stack(rows, axis=1) @ coefficients
    return gradients


_GRADIENTS = {dim: _serendipity_gradients(dim) for dim in (2, 3)}


def serendipity_centres(places: FloatArray) -> FloatArray:
    """Add the centres of faces and elements, which follow from the other nodes.

    Parameters
    ----------
    places
        Nodes of every element in VTK's order, shape (m, 8, 2) or (m, 20, 3).

    Returns
    -------
    places
        The same with centres, shape (m, 9, 2) or (m, 27, 3).
    """
    n_corners, n = (4, 8) if places.shape[2] == 2 else (8, 20)
    parts = [places]
    if n == 20:
        nodes = places[:, Element.of("hex20", 3).facets]
        parts.append(nodes[:, :, 4:].sum(axis=2) / 2 - nodes[:, :, :4].sum(axis=2) / 4)
    # In space there are twelve edges with the weight 1/4, in the plane four with 1/2.
    centre = places[:, n_corners:].sum(axis=1) / n_corners * 2
    parts.append((centre - places[:, :n_corners].sum(axis=1) / 4)[:, None])
    return np.concatenate(parts, axis=1)


def _add_centres(
    mesh: VolumeMesh, points: FloatArray, cells: IntArray
) -> tuple[FloatArray, IntArray]:
    """Add the centres of faces and elements, which follow from the other nodes."""
    places = serendipity_centres(points[cells])
    n, m = len(points), len(cells)
    if mesh.dim == 2:
        own = n + np.arange(m)
        return np.concatenate([points, places[:, 8]]), np.column_stack([cells, own])
    facets = mesh.facets
    of_faces = np.empty((facets.n_unique, 3))
    of_faces[facets.unique] = places[:, 20:26].reshape(-1, 3)
    faces = n + facets.unique.reshape(-1, 6).astype(np.int64)
    own = n + len(of_faces) + np.arange(m)
    points = np.concatenate([points, of_faces, places[:, 26]])
    return points, np.hstack([cells, faces, own[:, None]])
