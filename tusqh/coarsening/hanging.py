"""Find the hanging vertices of a coarse mesh and the vertices that constrain them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from tusqh.grid import IndexArray, IntArray


def find_hanging(point_at: IndexArray, starts: IntArray, sizes: IntArray) -> IntArray:
    """Return the vertices in the middle of edges and faces of blocks, with their parents.

    Parameters
    ----------
    point_at
        Point at each grid vertex, -1 where there is none, one longer than the grid along each axis.
    starts
        Lowest grid vertex of each block, shape (b, dim).
    sizes
        Number of grid cells of each block along an axis, even, shape (b,).

    Returns
    -------
    IntArray
        Shape (h, 3), sorted by vertex: the vertex, and the two vertices of which it is the middle:
        the ends of an edge, or of a face the middles of two opposite edges.

    Examples
    --------
    A block of 2 x 2 cells with a vertex in the middle of its right edge:

    >>> point_at = np.array([[0, -1, 1], [-1, -1, -1], [2, 4, 3]])
    >>> find_hanging(point_at, np.array([[0, 0]]), np.array([2])).tolist()
    [[4, 2, 3]]
    """
    rows = [np.empty((0, 3), dtype=np.int64)]
    for middle, first, second in _middles(starts.shape[1]):
        places = [starts + sizes[:, None] * offset // 2 for offset in (middle, first, second)]
        found = np.stack([point_at[tuple(place.T)] for place in places], axis=1)
        rows.append(found[found[:, 0] >= 0])
    # Blocks that share an edge or a face find the same vertex.
    every = np.concatenate(rows)
    return np.asarray(every[np.unique(every[:, 0], return_index=True)[1]], dtype=np.int64)


def _middles(dim: int) -> Iterator[tuple[IntArray, IntArray, IntArray]]:
    """Yield the middle of every edge and face of a cell with its parents, in half cells."""
    for axis in range(dim):
        others = [other for other in range(dim) if other != axis]
        for ends in product((0, 2), repeat=dim - 1):
            middle = np.ones(dim, dtype=np.int64)
            middle[others] = ends
            yield _with_ends(middle, axis)
    if dim == 3:
        for axis, end in product(range(3), (0, 2)):
            middle = np.ones(3, dtype=np.int64)
            middle[axis] = end
            yield _with_ends(middle, (axis + 1) % 3)


def _with_ends(middle: IntArray, axis: int) -> tuple[IntArray, IntArray, IntArray]:
    """Return a middle and its neighbours on both sides along an axis."""
    step = np.zeros_like(middle)
    step[axis] = 1
    return middle, middle - step, middle + step
