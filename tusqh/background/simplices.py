"""The listed complex of a background mesh.

Nodes are cells, edges of hexes and vertices inside the background.  In space the simplices are all
subsets of (cell, cell, edge, vertex), where the two cells share a face that has the edge, and the
edge ends in the vertex; in the plane those of (cell, cell, vertex).  Simplices are never completed
as cliques: three hexes around an edge share three faces, and what lies between them may be empty.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.grid import IntArray
from tusqh.meshes.facets import HEX_EDGES


def list_simplices(background: BackgroundMesh) -> list[IntArray]:
    """Return the simplices of each dimension by their nodes, as gudhi needs them.

    Nodes are numbered as in `tusqh.background.node_values.NodeValues.all`.  A filtration of the
    complex adds every simplex with the last of its nodes.

    Parameters
    ----------
    background
        The background.

    Returns
    -------
    simplices
        ``simplices[k]`` has shape (m_k, k + 1), rows ascending and different.

    Examples
    --------
    >>> points = np.array([[x, y] for x in range(3) for y in range(3)], dtype=float)
    >>> quads = np.array([[0, 3, 4, 1], [1, 4, 5, 2], [3, 6, 7, 4], [4, 7, 8, 5]])
    >>> [len(s) for s in list_simplices(BackgroundMesh(points, quads))]
    [5, 8, 4]
    """
    top = _list_highest(background)
    cells = np.arange(background.n_cells, dtype=np.int64)[:, None]
    simplices = []
    for k in range(background.dim + 1):
        of_top = [top[:, list(columns)] for columns in combinations(range(top.shape[1]), k + 1)]
        rows = np.concatenate(of_top)
        rows = rows[(rows >= 0).all(axis=1)]
        found = [rows, cells] if k == 0 else [rows, *_at_cells(background, k)]
        simplices.append(np.unique(np.concatenate(found), axis=0))
    return simplices


def _list_highest(background: BackgroundMesh) -> IntArray:
    """Return the simplices at facets inside, shape (n, dim + 1); nodes on the rim are -1."""
    inside = np.flatnonzero(~background.is_rim_facet)
    pair = np.sort(background.facet_cells[inside], axis=1).astype(np.int64)
    edges, vertices = _node_numbers(background)
    if background.dim == 2:
        ends = vertices[background.vertices_of_facets[inside]]
        return np.column_stack([np.repeat(pair, 2, axis=0), ends.ravel()])
    edge = background.edges_of_facets[inside]
    ends = vertices[background.edge_ends[edge]]
    return np.column_stack(
        [np.repeat(pair, 8, axis=0), np.repeat(edges[edge].ravel(), 2), ends.ravel()]
    )


def _at_cells(background: BackgroundMesh, k: int) -> list[IntArray]:
    """Return the k-simplices of one cell with its edges and vertices inside the background."""
    edges, vertices = _node_numbers(background)
    own = np.arange(background.n_cells, dtype=np.int64)
    corner = vertices[background.cells]
    found = []
    if k == 1:
        found.append(np.column_stack([np.repeat(own, corner.shape[1]), corner.ravel()]))
    if background.dim == 3:
        edge = edges[background.edge_of]
        ends = vertices[background.cells[:, HEX_EDGES]]
        if k == 1:
            found.append(np.column_stack([np.repeat(own, 12), edge.ravel()]))
        if k == 2:
            found.append(
                np.column_stack([np.repeat(own, 24), np.repeat(edge.ravel(), 2), ends.ravel()])
            )
    return [rows[(rows >= 0).all(axis=1)] for rows in found]


def _node_numbers(background: BackgroundMesh) -> tuple[IntArray, IntArray]:
    """Return the node number of every edge and vertex, -1 on the rim."""
    n_cells, n_edges = background.n_cells, background.n_edges
    edges = n_cells + np.arange(n_edges, dtype=np.int64)
    vertices = n_cells + n_edges + np.arange(background.n_points, dtype=np.int64)
    edges[background.is_rim_edge] = -1
    vertices[background.is_rim_vertex] = -1
    return edges, vertices
