"""The doubled grid, which holds the primal cells of all dimensions in one array.

The doubled grid (Khalimsky grid) of shape ``2 n + 1`` has a place for every cell, face, edge and
vertex.  Along each axis an odd index is the open body of a cell and an even one a grid plane::

    (even, odd)  (odd, odd)  (even, odd)        edge    cell    edge
    (even, even) (odd, even) (even, even)       vertex  edge    vertex

The number of odd indices is the dimension of the place; the *parity* of a place is its index
modulo 2.  A grid in the plane is a single layer of cells of a grid in space: see `as_layer`.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from tusqh.grid.arrays import BoolArray, FloatArray, IntArray

Offset = tuple[int, ...]
Index = tuple[slice, ...]


def cells(dim: int) -> Index:
    """Return the index of the cells in a doubled array.

    Parameters
    ----------
    dim
        Dimension of the grid.

    Examples
    --------
    >>> np.arange(25).reshape(5, 5)[cells(2)].tolist()
    [[6, 8], [16, 18]]
    """
    return (slice(1, None, 2),) * dim


def vertices(dim: int) -> Index:
    """Return the index of the grid vertices in a doubled array.

    Parameters
    ----------
    dim
        Dimension of the grid.

    Examples
    --------
    >>> np.arange(9).reshape(3, 3)[vertices(2)].tolist()
    [[0, 2], [6, 8]]
    """
    return (slice(0, None, 2),) * dim


def edges(dim: int, axis: int) -> Index:
    """Return the index of the edges along an axis in a doubled array.

    Parameters
    ----------
    dim
        Dimension of the grid.
    axis
        Direction of the edges.

    Examples
    --------
    >>> np.arange(9).reshape(3, 3)[edges(2, 0)].tolist()
    [[3, 5]]
    """
    return tuple(slice(1 if k == axis else 0, None, 2) for k in range(dim))


def place_dimensions(shape: tuple[int, ...]) -> IntArray:
    """Return the dimension of every place: 0 at a vertex, 1 in an edge, and so on.

    Parameters
    ----------
    shape
        Shape of a doubled array.

    Examples
    --------
    >>> place_dimensions((3, 3)).tolist()
    [[0, 1, 0], [1, 2, 1], [0, 1, 0]]
    """
    odd = [np.arange(n, dtype=np.int64) % 2 for n in shape]
    return np.asarray(sum(np.ix_(*odd)), dtype=np.int64)


def cells_around(parity: Offset) -> list[Offset]:
    """Return the offsets from a place to the cells that touch it; the first axis varies slowest.

    Parameters
    ----------
    parity
        Index of the place modulo 2 along each axis.

    Examples
    --------
    >>> cells_around((0, 1))
    [(-1, 0), (1, 0)]
    """
    return list(itertools.product(*[(0,) if odd else (-1, 1) for odd in parity]))


def unit_offsets(dim: int) -> list[Offset]:
    """Return the offsets to the two neighbours along each axis.

    Parameters
    ----------
    dim
        Dimension of the grid.

    Examples
    --------
    >>> unit_offsets(2)
    [(-1, 0), (1, 0), (0, -1), (0, 1)]
    """
    return [
        tuple(sign if k == axis else 0 for k in range(dim))
        for axis in range(dim)
        for sign in (-1, 1)
    ]


def as_layer(array: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return a doubled array in space; an array in the plane becomes a layer of cells.

    The layer has index 1 along the new first axis: its cells, edges and vertices in the plane are
    cells, faces and edges in space.  The layers 0 and 2 are zero.

    Parameters
    ----------
    array
        A doubled array in 2D or 3D.

    Examples
    --------
    >>> as_layer(np.ones((3, 5))).shape
    (3, 3, 5)
    """
    if array.ndim == 3:
        return array
    return np.pad(array[None], ((1, 1), (0, 0), (0, 0)))


def marked_edges(is_marked: BoolArray) -> FloatArray:
    """Return both ends of the marked edges, ordered by axis.

    Parameters
    ----------
    is_marked
        Marked places of the doubled grid, shape ``2 n + 1``.

    Returns
    -------
    ends
        Positions in cells from the lowest corner of the grid, shape (m, 2, dim).

    Examples
    --------
    >>> is_marked = np.zeros((3, 3), dtype=bool)
    >>> is_marked[1, 2] = True
    >>> marked_edges(is_marked).tolist()
    [[[0.0, 1.0], [1.0, 1.0]]]
    """
    dim = is_marked.ndim
    found = []
    for axis in range(dim):
        lower = np.argwhere(is_marked[edges(dim, axis)]).astype(np.float64)
        upper = lower.copy()
        upper[:, axis] += 1
        found.append(np.stack([lower, upper], axis=1))
    return np.concatenate(found)
