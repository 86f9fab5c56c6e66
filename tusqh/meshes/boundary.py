"""The boundary of a mesh, side by side: which way each facet faces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.facets import Facets

#: Names of the sides; attribute ``k`` is ``SIDES[k - 1]``.  Facets of templates face no axis.
SIDES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max", "slanted")

#: Largest deviation of a unit normal from an axis.
_ALIGNED = 1e-6


@dataclass(frozen=True)
class Boundary:
    """Boundary facets.

    Parameters
    ----------
    corners
        Points of every facet, walked so that it faces outwards, shape (m, 2**(dim - 1)).
    element
        Element that each facet belongs to, shape (m,).
    local
        Which of the element's facets it is, shape (m,).
    attribute
        From 1: the side that it faces, see `SIDES`, shape (m,).
    """

    corners: IntArray
    element: IntArray
    local: IntArray
    attribute: IntArray


def find_boundary(points: FloatArray, facets: Facets) -> Boundary:
    """Return the boundary of a mesh with the side that every facet faces.

    Parameters
    ----------
    points
        Coordinates of the mesh, shape (n, dim).
    facets
        The facets of its elements.

    Examples
    --------
    >>> from tusqh.meshes.facets import find_facets
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> boundary = find_boundary(square, find_facets(np.array([[0, 1, 2, 3]])))
    >>> [SIDES[k - 1] for k in boundary.attribute]
    ['y_min', 'x_max', 'y_max', 'x_min']
    """
    dim = points.shape[1]
    rows = np.flatnonzero(facets.on_boundary)
    places = points[facets.boundary]
    if dim == 2:
        along = places[:, 1] - places[:, 0]
        normals = np.stack([along[:, 1], -along[:, 0]], axis=1)
    else:
        normals = np.cross(places[:, 2] - places[:, 0], places[:, 3] - places[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    attribute = np.full(len(rows), len(SIDES), dtype=np.int64)
    for axis in range(dim):
        for side, sign in enumerate((-1, 1)):
            attribute[sign * normals[:, axis] > 1 - _ALIGNED] = 2 * axis + side + 1
    n_local = 2 * dim
    return Boundary(
        corners=facets.boundary,
        element=rows // n_local,
        local=rows % n_local,
        attribute=attribute,
    )
