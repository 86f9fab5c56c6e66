"""The fit terms of boundary vertices, from planes at the vertices and at the centres of facets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numba
import numpy as np

from tusqh.grid import BoolArray, FloatArray, IntArray

#: Longest way from a vertex to the place that its planes ask for, in cells.
_LONGEST = 0.7


class FitTerms(NamedTuple):
    """Fit terms ``(x - q)^T A (x - q)`` of vertices.

    Parameters
    ----------
    matrix
        A as xx, yy, zz, xy, xz, yz, shape (n, 6).
    place
        q, shape (n, 3).
    """

    matrix: FloatArray
    place: FloatArray


def squares(normals: FloatArray, weight: float = 1.0) -> FloatArray:
    """Return ``weight n n^T`` as xx, yy, zz, xy, xz, yz, shape (n, 6).

    Parameters
    ----------
    normals
        Unit vectors, shape (n, 3).
    weight
        Factor.
    """
    x, y, z = normals.T
    return weight * np.stack([x * x, y * y, z * z, x * y, x * z, y * z], axis=1)


class Planes(NamedTuple):
    """Planes by a point on each and its normal.

    Parameters
    ----------
    row
        The vertex (of the skin) or the facet to which each plane belongs, shape (p,).
    points, normals
        A point on each plane and its unit normal, shape (p, 3) each.
    weight
        Weight of each plane; those with 0 do not count, shape (p,).
    """

    row: IntArray
    points: FloatArray
    normals: FloatArray
    weight: FloatArray


def combine(
    points: FloatArray,
    of_vertices: Sequence[Planes],
    of_facets: Planes,
    facets: IntArray,
    share: FloatArray,
) -> FitTerms:
    """Return the fit terms of vertices that their planes and those of their facets ask for.

    Parameters
    ----------
    points
        Places of the vertices, shape (n, 3).
    of_vertices
        Sets of planes of vertices.
    of_facets
        One plane for each facet, at its centre.
    facets
        Corners of the facets, shape (f, 4).
    share
        Total weight of the facets' planes at each vertex, shape (n,).
    """
    matrix, pull = np.zeros((len(points), 6)), np.zeros((len(points), 3))
    total = np.zeros(len(points))
    for planes in of_vertices:
        _add_planes(points, *planes, matrix, pull)
    _add_facets(points, facets, *of_facets[1:], share, total, matrix, pull)
    whole = np.empty((len(points), 3, 3))
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
        whole[:, i, j] = whole[:, j, i] = matrix[:, k]
    whole += 0.02 * np.eye(3)
    step = np.linalg.solve(whole, pull[:, :, None])[:, :, 0]
    length = np.linalg.norm(step, axis=1, keepdims=True)
    step *= np.minimum(1.0, _LONGEST / np.maximum(length, 1e-300))
    return FitTerms(matrix, points + step)


def choose(is_first: BoolArray, first: FitTerms, second: FitTerms) -> FitTerms:
    """Return the first fit terms where they count, else the second.

    Parameters
    ----------
    is_first
        Where the first ones count, shape (n,).
    first, second
        Fit terms of all vertices.
    """
    chosen = is_first[:, None]
    return FitTerms(
        np.where(chosen, first.matrix, second.matrix), np.where(chosen, first.place, second.place)
    )


@numba.njit(cache=True)
def _add_plane(points, v, place, normal, weight, matrix, pull):  # type: ignore[no-untyped-def]
    """Add one plane to a vertex."""
    off = 0.0
    for k in range(3):
        off += (place[k] - points[v, k]) * normal[k]
    for k in range(3):
        matrix[v, k] += weight * normal[k] * normal[k]
        pull[v, k] += weight * off * normal[k]
    matrix[v, 3] += weight * normal[0] * normal[1]
    matrix[v, 4] += weight * normal[0] * normal[2]
    matrix[v, 5] += weight * normal[1] * normal[2]


@numba.njit(cache=True)
def _add_planes(points, rows, places, normals, weights, matrix, pull):  # type: ignore[no-untyped-def]
    for p in range(len(rows)):
        if weights[p] > 0:
            _add_plane(points, rows[p], places[p], normals[p], weights[p], matrix, pull)


@numba.njit(cache=True)
def _add_facets(points, facets, places, normals, weights, share, total, matrix, pull):  # type: ignore[no-untyped-def]
    """Add the plane of every facet to its corners, in equal parts at each vertex."""
    for f in range(len(facets)):
        for c in range(4):
            total[facets[f, c]] += weights[f]
    for f in range(len(facets)):
        if weights[f] > 0:
            for c in range(4):
                v = facets[f, c]
                if share[v] > 0:
                    part = share[v] * weights[f] / total[v]
                    _add_plane(points, v, places[f], normals[f], part, matrix, pull)
