"""Classify the boundary facets of a mesh by the side of its box or by their direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.facets import Facets

#: Sides of the boundary; attribute ``k`` is ``SIDES[k - 1]``.  `x_min` holds the facets that lie
#: on the plane of the mesh's box where x is smallest, `normal_x_minus` other facets that face -x,
#: such as the walls of a hole, and `slanted` the facets of templates, which face no axis.
SIDES = (
    *("x_min", "x_max", "y_min", "y_max", "z_min", "z_max"),
    *("normal_x_minus", "normal_x_plus", "normal_y_minus", "normal_y_plus"),
    *("normal_z_minus", "normal_z_plus", "slanted"),
)

#: Attribute of the first side that is named by its direction, less one.
_BY_NORMAL = 6

#: Largest deviation of a unit normal from an axis.
_ALIGNED = 1e-6

#: Largest distance from a plane of the box, relative to the largest extent of the mesh.
_ON_PLANE = 1e-9


@dataclass(frozen=True)
class Boundary:
    """Boundary facets.

    Parameters
    ----------
    corners
        Points of every facet, ordered so that it faces outwards, shape (m, 2**(dim - 1)).
    element
        Element to which each facet belongs, shape (m,).
    local
        Number of the facet within its element, shape (m,).
    attribute
        Side of each facet, numbered from 1, see `SIDES`, shape (m,).
    """

    corners: IntArray
    element: IntArray
    local: IntArray
    attribute: IntArray


def describe_side(name: str) -> str:
    """Return a description of the facets on a side of `SIDES`.

    Parameters
    ----------
    name
        The name of the side.

    Examples
    --------
    >>> describe_side("x_min")
    'facets on the lowest plane of the box along x'
    >>> describe_side("normal_z_plus")
    'other facets that face +z'
    """
    first, *rest = name.split("_")
    if first == "normal":
        return f"other facets that face {'-' if rest[1] == 'minus' else '+'}{rest[0]}"
    if not rest:
        return "facets of templates and of fitted boundaries, which face no axis"
    return (
        f"facets on the {'lowest' if rest == ['min'] else 'highest'} plane of the box along {first}"
    )


def find_boundary(points: FloatArray, facets: Facets) -> Boundary:
    """Return the boundary of a mesh with the side of every facet.

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
    tolerance = _ON_PLANE * float((places.max((0, 1)) - places.min((0, 1))).max())
    for axis in range(dim):
        for side, sign in enumerate((-1, 1)):
            is_facing = sign * normals[:, axis] > 1 - _ALIGNED
            away = sign * places[..., axis]
            is_on_box = (away >= away.max(initial=-np.inf) - tolerance).all(axis=1)
            number = 2 * axis + side + 1
            attribute[is_facing] = np.where(is_on_box, number, number + _BY_NORMAL)[is_facing]
    n_local = 2 * dim
    return Boundary(
        corners=facets.boundary,
        element=rows // n_local,
        local=rows % n_local,
        attribute=attribute,
    )
