"""Compute the corner Jacobians and volumes of quads and hexes."""

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
    """The Jacobians at the corners of elements.

    Parameters
    ----------
    determinant
        Determinants of the edges that leave each corner, shape (m, 2**dim), model units**dim.
    scaled
        The same with edges of unit length, dimensionless; NaN if an edge has no length.
    """

    determinant: FloatArray
    scaled: FloatArray


def corner_jacobians(points: FloatArray, cells: IntArray) -> Jacobians:
    """Return the Jacobian and the scaled Jacobian at every corner of every element.

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
    >>> jacobian, scaled = corner_jacobians(trapezoid, np.array([[0, 1, 2, 3]]))
    >>> jacobian.tolist(), float(scaled.min().round(6))
    ([[4.0, 4.0, 2.0, 2.0]], 0.707107)
    """
    if cells.shape[1] == 8:
        jacobian, lengths = np.empty(cells.shape), np.empty(cells.shape)
        _hex_corners(points, cells, HEX_NEIGHBOURS, jacobian, lengths)
    else:
        corners = points[cells]
        a, b = np.moveaxis(corners[:, QUAD_NEIGHBOURS] - corners[:, :, None], 2, 0)
        jacobian = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        lengths = np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return Jacobians(jacobian, jacobian / lengths)


@numba.njit(cache=True)
def _hex_corners(points, cells, neighbours, jacobian, lengths):  # type: ignore[no-untyped-def]
    """Fill in, for each corner, the determinant of its edges and the product of their lengths."""
    edge = np.empty((3, 3))
    for cell in range(len(cells)):
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
            jacobian[cell, corner] = (
                (edge[0, 1] * edge[1, 2] - edge[0, 2] * edge[1, 1]) * edge[2, 0]
                + (edge[0, 2] * edge[1, 0] - edge[0, 0] * edge[1, 2]) * edge[2, 1]
                + (edge[0, 0] * edge[1, 1] - edge[0, 1] * edge[1, 0]) * edge[2, 2]
            )
            lengths[cell, corner] = product


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
    corners = points[cells] - points[cells[:, :1]]
    if cells.shape[1] == 4:
        diagonals = corners[:, 2:] - corners[:, :2]
        return np.asarray(np.linalg.det(diagonals) / 2 if len(cells) else np.zeros(0))
    a, b, c, d = np.moveaxis(corners[:, HEX_FACETS], 2, 0)
    triangles = [(a, b, c), (a, c, d), (a, b, d), (b, c, d)]
    volumes = sum(np.einsum("mfi,mfi->m", p, np.cross(q, r)) for p, q, r in triangles)
    return np.asarray(volumes / 12)


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
