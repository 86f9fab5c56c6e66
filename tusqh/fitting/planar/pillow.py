"""Put a layer of quads around the boundary of a quad mesh (a pillow).

The old boundary points move inwards, new points take their places, and a quad joins each boundary
side with its copy.  At every boundary point two quads of the layer share the angle, so a smooth
boundary is never bent inside one quad.  The number of components and holes does not change.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numba
import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.facets import find_facets
from tusqh.meshes.jacobians import QUAD_NEIGHBOURS

#: How far the old boundary moves inwards, in lengths of the shortest side at the point.
_INWARDS = 0.3

#: Scaled determinant below which a point moves half as far.
_LEAST = 0.2


@dataclass(frozen=True)
class Layered:
    """A quad mesh whose boundary consists of the outer sides of a layer.

    Parameters
    ----------
    points
        Coordinates, shape (n, 2); the first points are those of the mesh without the layer, which
        have moved inwards on its boundary.
    cells
        Quads, shape (m, 4); the first ones are those of the mesh, those of the layer follow.
    sides
        Boundary sides, directed so that the mesh lies to their left, shape (k, 2).
    inner_sides
        The old boundary side that each boundary side covers, as points, shape (k, 2).
    quads
        The quad of the mesh behind each boundary side, shape (k,).
    """

    points: FloatArray
    cells: IntArray
    sides: IntArray
    inner_sides: IntArray
    quads: IntArray

    @cached_property
    def corners_at(self) -> tuple[IntArray, IntArray]:
        """The corners ``4 * quad + local corner`` at every point: first, shape (n + 1,); list."""
        flat = self.cells.ravel()
        first = np.zeros(len(self.points) + 1, dtype=np.int64)
        np.cumsum(np.bincount(flat, minlength=len(self.points)), out=first[1:])
        return first, np.argsort(flat, kind="stable").astype(np.int64)

    @cached_property
    def loop(self) -> tuple[IntArray, IntArray]:
        """The boundary sides before and after each side, shape (k,) each."""
        starting = np.empty(len(self.points), dtype=np.int64)
        ending = np.empty(len(self.points), dtype=np.int64)
        rows = np.arange(len(self.sides))
        starting[self.sides[:, 0]] = rows
        ending[self.sides[:, 1]] = rows
        return ending[self.sides[:, 0]], starting[self.sides[:, 1]]

    def near(self, points: IntArray, rings: int) -> IntArray:
        """Return the points at most some sides of quads away from given ones, ascending.

        Parameters
        ----------
        points
            Numbers of points, of any shape.
        rings
            The number of sides.
        """
        is_near = np.zeros(len(self.points), dtype=np.bool_)
        is_near[points] = True
        for _ in range(rings):
            is_near[self.cells[is_near[self.cells].any(axis=1)]] = True
        return np.flatnonzero(is_near).astype(np.int64)


def directions_of(points: FloatArray, sides: IntArray) -> FloatArray:
    """Return the outward unit normals of boundary sides, shape (k, 2).

    Parameters
    ----------
    points
        Coordinates, shape (n, 2).
    sides
        Boundary sides, directed so that the mesh lies to their left, shape (k, 2).
    """
    along = points[sides[:, 1]] - points[sides[:, 0]]
    normals = np.stack([along[:, 1], -along[:, 0]], axis=1)
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1)[:, None], 1e-300))


def add_layer(points: FloatArray, cells: IntArray) -> Layered:
    """Return a valid quad mesh with a layer of quads around its boundary.

    Parameters
    ----------
    points
        Coordinates of a valid mesh, shape (n, 2).
    cells
        Its quads, shape (m, 4), counter-clockwise; each boundary point lies on two boundary sides.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> layered = add_layer(square, np.array([[0, 1, 2, 3]]))
    >>> layered.points.shape, layered.cells.shape, layered.sides.tolist()[0]
    ((8, 2), (5, 4), [4, 5])
    """
    facets = find_facets(cells)
    inner = facets.boundary
    rows = np.flatnonzero(facets.on_boundary)
    on_boundary = np.unique(inner)
    copy = np.full(len(points), -1, dtype=np.int64)
    copy[on_boundary] = len(points) + np.arange(len(on_boundary))
    outer = copy[inner]
    quads = np.column_stack([outer, inner[:, ::-1]])
    layered = Layered(
        points=np.concatenate([points, points[on_boundary]]),
        cells=np.concatenate([cells, quads]),
        sides=outer,
        inner_sides=inner,
        quads=rows // 4,
    )
    inwards = np.zeros_like(layered.points)
    normals = directions_of(points, inner)
    lengths = np.linalg.norm(points[inner[:, 1]] - points[inner[:, 0]], axis=1)
    shortest = np.full(len(points), np.inf)
    for k in range(2):
        np.add.at(inwards, inner[:, k], -normals)
        np.minimum.at(shortest, inner[:, k], lengths)
    norm = np.linalg.norm(inwards[on_boundary], axis=1)[:, None]
    inwards[on_boundary] *= _INWARDS * shortest[on_boundary, None] / np.maximum(norm, 1e-300)
    first, corners = layered.corners_at
    _move_inwards(
        layered.points, layered.cells, QUAD_NEIGHBOURS, first, corners, on_boundary, inwards
    )
    return layered


@numba.njit(cache=True)
def _move_inwards(points, cells, neighbours, first, corners, order, inwards):  # type: ignore[no-untyped-def]
    """Move the old boundary points inwards, each half as far as long as a quad at it is bad."""
    n = len(order)
    for v in order:
        points[v, 0] += inwards[v, 0]
        points[v, 1] += inwards[v, 1]
    for attempt in range(60):
        n_bad = 0
        for i in range(n):
            v = order[i]
            if _is_bad(points, cells, neighbours, first, corners, v, attempt):
                n_bad += 1
                inwards[v, 0] *= 0.5
                inwards[v, 1] *= 0.5
                points[v, 0] -= inwards[v, 0]
                points[v, 1] -= inwards[v, 1]
        if n_bad == 0:
            return


@numba.njit(cache=True)
def _is_bad(points, cells, neighbours, first, corners, v, attempt):  # type: ignore[no-untyped-def]
    """Return whether a corner of a quad at a vertex is too flat; later attempts allow more."""
    least = _LEAST if attempt < 3 else 1e-3
    for e in range(first[v], first[v + 1]):
        cell = corners[e] >> 2
        for local in range(4):
            at = cells[cell, local]
            i, j = cells[cell, neighbours[local, 0]], cells[cell, neighbours[local, 1]]
            ax, ay = points[i, 0] - points[at, 0], points[i, 1] - points[at, 1]
            bx, by = points[j, 0] - points[at, 0], points[j, 1] - points[at, 1]
            lengths = np.sqrt((ax * ax + ay * ay) * (bx * bx + by * by))
            if not ax * by - ay * bx > least * lengths:
                return True
    return False
