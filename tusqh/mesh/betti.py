"""The Betti numbers of a finished mesh, measured from its connectivity alone, by two methods."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.grid import IntArray
from tusqh.mesh.facets import find_facets
from tusqh.mesh.volume_mesh import VolumeMesh
from tusqh.topology.betti_numbers import BettiNumbers


def count_components(groups: IntArray) -> int:
    """Return how many components rows of a table form that share entries.

    Examples
    --------
    >>> import numpy as np
    >>> count_components(np.array([[0, 1], [1, 2], [7, 8]]))
    2
    """
    if len(groups) == 0:
        return 0
    _, compact = np.unique(groups, return_inverse=True)
    compact = compact.reshape(groups.shape)
    n = int(compact.max()) + 1
    first = np.repeat(compact[:, 0], groups.shape[1] - 1)
    graph = coo_array((np.ones(len(first)), (first, compact[:, 1:].ravel())), shape=(n, n))
    return int(connected_components(graph, directed=False, return_labels=False))


def betti_by_euler(mesh: VolumeMesh) -> BettiNumbers:
    """Return the Betti numbers of a quad mesh from its components and Euler characteristic.

    Components are sets of elements that share points; ``betti_1 = betti_0 - (V - E + F)``.
    """
    n_points = len(np.unique(mesh.cells))
    euler = n_points - find_facets(mesh.cells).n_unique + mesh.n_cells
    betti_0 = count_components(mesh.cells)
    return BettiNumbers(betti_0, betti_0 - euler)


def betti_by_boundary(mesh: VolumeMesh) -> BettiNumbers:
    """Return the Betti numbers of a planar quad mesh from its boundary loops.

    Components are sets of elements that share sides; each has one outer loop, and every other
    loop of the boundary is a hole.  Equal to `betti_by_euler` on manifold meshes only.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([[x, y] for x in range(4) for y in range(4)], dtype=float)
    >>> corners = np.array([[i * 4 + j, i * 4 + j + 4, i * 4 + j + 5, i * 4 + j + 1]
    ...                     for i in range(3) for j in range(3) if (i, j) != (1, 1)])
    >>> annulus = VolumeMesh.from_arrays(points, corners)
    >>> str(betti_by_boundary(annulus)), str(betti_by_euler(annulus))
    ('(1, 1, 0)', '(1, 1, 0)')
    """
    facets = find_facets(mesh.cells)
    neighbours = np.column_stack([facets.cell, mesh.n_cells + facets.unique])
    betti_0 = count_components(neighbours)
    n_loops = count_components(facets.corners[facets.on_boundary])
    return BettiNumbers(betti_0, n_loops - betti_0)
