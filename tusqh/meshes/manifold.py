"""Find the boundary points at which a mesh is not a manifold."""

from __future__ import annotations

import numpy as np

from tusqh.grid import IntArray
from tusqh.grid.components import label_components
from tusqh.meshes.facets import ClosedSurface, Facets


def find_non_manifold_points(facets: ClosedSurface) -> IntArray:
    """Return the points at which the boundary is not a manifold.

    In 2D every boundary point of a manifold mesh lies on exactly two boundary sides.  In 3D every
    boundary edge lies in exactly two boundary faces, and the boundary faces at a point form one
    fan.

    Parameters
    ----------
    facets
        The facets of a mesh of quads or hexes, or its boundary alone.

    Returns
    -------
    points
        Indices of the points, in ascending order.
    """
    boundary = facets.boundary
    if boundary.size == 0:
        return np.empty(0, dtype=np.int64)
    if boundary.shape[1] == 2:
        n_sides = np.bincount(boundary.ravel())
        return np.flatnonzero((n_sides != 0) & (n_sides != 2)).astype(np.int64)
    edges = facets.boundary_edges
    is_bad = edges.n_cells_of[edges.unique] != 2
    links = _link_wedges(edges, np.flatnonzero(~is_bad))
    fan, n_fans = label_components(links[:, 0], links[:, 1], boundary.size)
    point_of_fan = np.empty(n_fans, dtype=np.int64)
    point_of_fan[fan] = boundary.ravel()
    several = np.flatnonzero(np.bincount(point_of_fan) > 1)
    return np.union1d(several, edges.corners[is_bad].ravel()).astype(np.int64)


def _link_wedges(edges: Facets, rows: IntArray) -> IntArray:
    """Return the pairs of adjacent wedges at a point, shape (n, 2).

    Corner c of face f is the wedge ``4 f + c``, and edge ``4 f + c`` runs from it to the next
    wedge of the face.  `rows` are the edges that exactly two faces share.
    """
    twins = rows[np.argsort(edges.unique[rows], kind="stable")].reshape(-1, 2)
    start, end = twins, twins - twins % 4 + (twins + 1) % 4
    runs_alike = edges.corners[twins[:, 1], 0] == edges.corners[twins[:, 0], 0]
    at_start = np.where(runs_alike, start[:, 1], end[:, 1])
    at_end = np.where(runs_alike, end[:, 1], start[:, 1])
    links = [np.stack([start[:, 0], at_start], axis=1), np.stack([end[:, 0], at_end], axis=1)]
    return np.concatenate(links)
