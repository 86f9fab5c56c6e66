"""Compute the smallest corner Jacobians and the volumes of quads and hexes."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.facets import HEX_FACETS

#: Neighbours of every corner, ordered so that a valid element has positive determinants.
QUAD_NEIGHBOURS: IntArray = np.array([[1, 3], [2, 0], [3, 1], [0, 2]], dtype=np.int64)
HEX_NEIGHBOURS: IntArray = np.array(
    [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]],
    dtype=np.int64,
)


class Jacobians(NamedTuple):
    """The smallest Jacobians of elements.

    Parameters
    ----------
    determinant
        Smallest determinant of the edges that leave a corner of each element, shape (m,), model
        units**dim.
    scaled
        The same with edges of unit length, dimensionless; NaN if an edge has no length.
    """

    determinant: FloatArray
    scaled: FloatArray


def smallest_jacobians(points: FloatArray, cells: IntArray) -> Jacobians:
    """Return the smallest Jacobian and the smallest scaled Jacobian of every element.

    Parameters
    ----------
    points
        Coordinates, shape (n, 2) for quads, (n, 3) for hexes.
    cells
        Connectivity, shape (m, 4) or (m, 8), VTK order.

    Returns
    -------
    jacobians
        `determinant` and `scaled`.

    Examples
    --------
    >>> import numpy as np
    >>> trapezoid = np.array([[0.0, 0.0], [4.0, 0.0], [3.0, 1.0], [1.0, 1.0]])
    >>> jacobian, scaled = smallest_jacobians(trapezoid, np.array([[0, 1, 2, 3]]))
    >>> jacobian.tolist(), float(scaled.min().round(6))
    ([2.0], 0.707107)
    """
    if cells.shape[1] == 8:
        found = Jacobians(np.empty(len(cells)), np.empty(len(cells)))
        _smallest_of_hexes(points, cells, HEX_NEIGHBOURS, *found)
        return found
    corners = points[cells]
    a, b = np.moveaxis(corners[:, QUAD_NEIGHBOURS] - corners[:, :, None], 2, 0)
    jacobian = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    lengths = np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return Jacobians(jacobian.min(axis=1), (jacobian / lengths).min(axis=1))


@numba.njit(cache=True)
def _smallest_of_hexes(points, cells, neighbours, determinant, scaled):  # type: ignore[no-untyped-def]
    """Fill in the smallest determinant, and the smallest one over the lengths of its edges."""
    edge = np.empty((3, 3))
    for cell in range(len(cells)):
        least, least_scaled, is_number, has_length = np.inf, np.inf, True, True
        for corner in range(8):
            at = cells[cell, corner]
            product = 1.0
            for k in range(3):
                to = cells[cell, neighbours[corner, k]]
                square = 0.0
                for axis in range(3):
                    edge[k, axis] = points[to, axis] - points[at, axis]
                    square += edge[k, axis] ** 2
                product *= np.sqrt(square)
            value = (
                (edge[0, 1] * edge[1, 2] - edge[0, 2] * edge[1, 1]) * edge[2, 0]
                + (edge[0, 2] * edge[1, 0] - edge[0, 0] * edge[1, 2]) * edge[2, 1]
                + (edge[0, 0] * edge[1, 1] - edge[0, 1] * edge[1, 0]) * edge[2, 2]
            )
            is_number = is_number and value == value
            least = min(least, value)
            has_length = has_length and product > 0
            if product > 0:
                least_scaled = min(least_scaled, value / product)
        determinant[cell] = least if is_number else np.nan
        scaled[cell] = least_scaled if is_number and has_length else np.nan


def element_volumes(points: FloatArray, cells: IntArray) -> FloatArray:
    """Return the area of every quad or the volume of every hex, shape (m,), model units**dim.

    Hex faces are bilinear, so the mean of the two ways to cut each face into triangles is exact.

    Parameters
    ----------
    points
        Coordinates, shape (n, dim), in model units.
    cells
        Corners of every element in VTK order, shape (m, 2**dim).

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    >>> element_volumes(square, np.array([[0, 1, 2, 3]])).tolist()
    [2.0]
    >>> cube = np.array([[x, y, z] for z in (0.0, 1.0)
    ...                  for x, y in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))])
    >>> element_volumes(cube, np.array([[0, 1, 2, 3, 4, 5, 6, 7]])).tolist()
    [1.0]
    """
    if cells.shape[1] == 8:
        volumes = np.empty(len(cells))
        _hex_volumes(points, cells, HEX_FACETS, volumes)
        return volumes
    corners = points[cells] - points[cells[:, :1]]
    diagonals = corners[:, 2:] - corners[:, :2]
    return np.asarray(np.linalg.det(diagonals) / 2 if len(cells) else np.zeros(0))


@numba.njit(cache=True)
def _hex_volumes(points, cells, facets, volumes):  # type: ignore[no-untyped-def]
    """Fill in the volumes of hexes, from tetrahedra between faces and the first corner."""
    at = np.empty((4, 3))
    for cell in range(len(cells)):
        total = 0.0
        for face in range(6):
            for c in range(4):
                for axis in range(3):
                    at[c, axis] = (
                        points[cells[cell, facets[face, c]], axis] - points[cells[cell, 0], axis]
                    )
            total += _six_volumes(at[0], at[1], at[2]) + _six_volumes(at[0], at[2], at[3])
            total += _six_volumes(at[0], at[1], at[3]) + _six_volumes(at[1], at[2], at[3])
        volumes[cell] = total / 12


@numba.njit(cache=True)
def _six_volumes(p, q, r):  # type: ignore[no-untyped-def]
    """Return six times the volume of the tetrahedron of three points and the origin."""
    return (
        p[0] * (q[1] * r[2] - q[2] * r[1])
        + p[1] * (q[2] * r[0] - q[0] * r[2])
        + p[2] * (q[0] * r[1] - q[1] * r[0])
    )


def enclosed_volume(points: FloatArray, faces: IntArray) -> float:
    """Return the volume that quad faces enclose, by the divergence theorem.

    Parameters
    ----------
    points
        Coordinates, shape (n, 3).
    faces
        Corners of a closed surface of quads that face outwards, shape (m, 4).
    """
    corners = points[faces] - points.mean(axis=0)
    a, b, c, d = np.moveaxis(corners, 1, 0)
    triangles = [(a, b, c), (a, c, d), (a, b, d), (b, c, d)]
    return float(sum(np.einsum("mi,mi->", p, np.cross(q, r)) for p, q, r in triangles) / 12)
