"""The boundary of a mesh of hexes as a surface of its own: normals, neighbours, smoothing."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numba
import numpy as np
from scipy.sparse import coo_array, csr_array

from tusqh.fitting.crossings import find_crossings
from tusqh.grid import BoolArray, FloatArray, IntArray

#: How often the way to the smoothed points is halved where facets would cross.
_HALVINGS = 6


@dataclass(frozen=True)
class Skin:
    """The boundary facets of a mesh.

    Parameters
    ----------
    vertices
        Points of the mesh that lie on the boundary, ascending, shape (b,).
    facets
        Corners of the facets, as rows of `vertices`, facing outwards, shape (f, 4).
    """

    vertices: IntArray
    facets: IntArray

    @classmethod
    def of(cls, facets: IntArray) -> Skin:
        """Return the skin of boundary facets.

        Parameters
        ----------
        facets
            Corners of the facets, points of the mesh, shape (f, 4).
        """
        vertices, local = np.unique(facets, return_inverse=True)
        return cls(vertices, local.reshape(facets.shape))

    @property
    def n_vertices(self) -> int:
        """Number of vertices."""
        return len(self.vertices)

    @cached_property
    def averages(self) -> csr_array:
        """Matrix that gives every vertex the mean of its neighbours along edges."""
        start, end = self.facets.ravel(), np.roll(self.facets, -1, axis=1).ravel()
        n = self.n_vertices
        pairs = np.concatenate([start, end]), np.concatenate([end, start])
        graph = coo_array((np.ones(2 * len(start)), pairs), shape=(n, n)).tocsr()
        graph.data[:] = 1.0
        degree = np.asarray(graph.sum(axis=1)).ravel()
        graph.data /= np.repeat(degree, np.diff(graph.indptr))
        return graph

    def normals(
        self, points: FloatArray, is_counted: BoolArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Return unit normals of the vertices and area vectors of the facets.

        Parameters
        ----------
        points
            Places of `vertices`, shape (b, 3).
        is_counted
            Facets that count for the normals of vertices, shape (f,); None: all.

        Returns
        -------
        of_vertices
            Unit normals, shape (b, 3).
        of_facets
            Normals whose length is the area, shape (f, 3).
        """
        of_facets = np.empty((len(self.facets), 3))
        of_vertices = np.zeros_like(points)
        counts = np.ones(len(self.facets), dtype=np.bool_) if is_counted is None else is_counted
        _add_normals(points, self.facets, counts, of_facets, of_vertices)
        return unit(of_vertices), of_facets

    def smooth(
        self, points: FloatArray, rounds: int, averages: csr_array | None = None
    ) -> FloatArray:
        """Return points moved half-way to the mean of their neighbours, several times.

        Parameters
        ----------
        points
            Places of `vertices`, shape (b, 3).
        rounds
            How often.
        averages
            Matrix of means of neighbours; None: of the neighbours along edges.
        """
        means = self.averages if averages is None else averages
        for _ in range(rounds):
            points = 0.5 * points + 0.5 * (means @ points)
        return points

    def smooth_apart(
        self, points: FloatArray, rounds: int, averages: csr_array | None = None
    ) -> FloatArray:
        """Return smoothed points, less far from the given ones where facets would cross.

        Parameters
        ----------
        points
            Places of `vertices`, at which no facets cross, shape (b, 3).
        rounds, averages
            See `smooth`.
        """
        away = self.smooth(points, rounds, averages) - points
        share = np.ones(len(points))
        for _ in range(_HALVINGS):
            places = points + share[:, None] * away
            is_crossed = find_crossings(places, self.facets)
            if not is_crossed.any():
                return np.asarray(places)
            near = np.zeros(len(points), dtype=np.bool_)
            near[self.facets[is_crossed]] = True
            near[self.facets[near[self.facets].any(axis=1)]] = True
            share[near] *= 0.5
        return np.asarray(points + np.where(near, 0.0, share)[:, None] * away)


def rows_of_facets(wanted: IntArray, given: IntArray) -> IntArray:
    """Return the row of every wanted facet among given ones, shape (f,).

    Parameters
    ----------
    wanted, given
        Corners of the same facets in two orders, shape (f, corners) each.

    Examples
    --------
    >>> rows_of_facets(np.array([[1, 2], [0, 1]]), np.array([[1, 0], [2, 1]])).tolist()
    [1, 0]
    """
    one, other = (np.lexsort(np.sort(facets, axis=1).T) for facets in (wanted, given))
    rows = np.empty(len(one), dtype=np.int64)
    rows[one] = other
    return rows


def unit(vectors: FloatArray) -> FloatArray:
    """Return vectors with unit length; those without a length stay zero.

    Parameters
    ----------
    vectors
        The vectors, shape (n, 3).
    """
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.maximum(lengths, 1e-300))


@numba.njit(cache=True)
def _add_normals(points, facets, is_counted, of_facets, of_vertices):  # type: ignore[no-untyped-def]
    """Fill in the area vectors of facets, and add them up at their corners."""
    for f in range(len(facets)):
        a, b, c, d = facets[f, 0], facets[f, 1], facets[f, 2], facets[f, 3]
        ux, uy, uz = (
            points[c, 0] - points[a, 0],
            points[c, 1] - points[a, 1],
            points[c, 2] - points[a, 2],
        )
        vx, vy, vz = (
            points[d, 0] - points[b, 0],
            points[d, 1] - points[b, 1],
            points[d, 2] - points[b, 2],
        )
        of_facets[f, 0] = (uy * vz - uz * vy) / 2
        of_facets[f, 1] = (uz * vx - ux * vz) / 2
        of_facets[f, 2] = (ux * vy - uy * vx) / 2
        for corner in range(4 if is_counted[f] else 0):
            for k in range(3):
                of_vertices[facets[f, corner], k] += of_facets[f, k]
