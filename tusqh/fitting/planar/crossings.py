"""Sides of the boundary that cross, and the components of a mesh."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tusqh.geometry.segment_pairs import compare_segments
from tusqh.grid import FloatArray, IntArray

#: Boundary points nearer than this count as the same place, in cells.
_SAME = 0.01


def find_crossing_points(points: FloatArray, sides: IntArray) -> IntArray:
    """Return the ends of sides that cross, overlap or touch others, and points that nearly meet.

    Parameters
    ----------
    points
        Coordinates in cells, shape (n, 2).
    sides
        Boundary sides, shape (k, 2).

    Examples
    --------
    >>> points = np.array([[0.0, 0.0], [2.0, 2.0], [0.0, 2.0], [2.0, 0.0], [5.0, 5.0]])
    >>> find_crossing_points(points, np.array([[0, 1], [2, 3], [1, 4]])).tolist()
    [0, 1, 2, 3]
    """
    pairs = compare_segments(points, sides)
    crossing = sides[pairs.crossings].ravel()
    overlapping = sides[pairs.overlaps].ravel()
    used = np.unique(sides)
    same = used[cKDTree(points[used]).query_pairs(_SAME, output_type="ndarray").ravel()]
    found = np.concatenate([crossing, overlapping, pairs.touching, same])
    return np.unique(found).astype(np.int64)


def find_components(cells: IntArray, n_points: int) -> IntArray:
    """Return the component of every point, shape (n,).

    Parameters
    ----------
    cells
        Quads, shape (m, 4).
    n_points
        Number of points.
    """
    a, b = cells[:, :1].repeat(3, axis=1).ravel(), cells[:, 1:].ravel()
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(n_points, n_points))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def find_runs(points: IntArray, sides: IntArray) -> list[IntArray]:
    """Return points of the boundary in groups that sides between them connect.

    Parameters
    ----------
    points
        Numbers of points, each once.
    sides
        Boundary sides, shape (k, 2).

    Returns
    -------
    list of array
        The groups, in the order of their lowest points.

    Examples
    --------
    >>> sides = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    >>> [group.tolist() for group in find_runs(np.array([0, 1, 3]), sides)]
    [[0, 1, 3]]
    >>> [group.tolist() for group in find_runs(np.array([0, 2]), sides)]
    [[0], [2]]
    """
    points = np.sort(points)
    inside = sides[np.isin(sides, points).all(axis=1)]
    a, b = np.searchsorted(points, inside).T
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(len(points), len(points)))
    number = connected_components(graph, directed=False)[1]
    return [points[number == k] for k in range(int(number.max(initial=-1)) + 1)]
