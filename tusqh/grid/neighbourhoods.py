"""Return neighbourhoods as shifted views: cells around vertices and edges, corners, faces.

A value per cell has shape n, a value per grid vertex shape ``n + 1``, a value per grid edge along
an axis shape n along that axis and ``n + 1`` along the others.  Cells outside the grid have the
value 0 (False).

The cells around a vertex are in the order of their bits: bit ``axis`` of a cell's number is set if
it lies on the upper side along that axis.  Around an edge only the other two axes count::

      +-----+-----+
      |  2  |  3  |        in 2D: 0 lower left, 1 lower right,
      +-----v-----+               2 upper left, 3 upper right
      |  0  |  1  |
      +-----+-----+
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tusqh.grid.arrays import BoolArray, IntArray
from tusqh.grid.numbering import CORNERS, FACES

Array = np.ndarray[Any, Any]


def along(axis: int, start: int | None, stop: int | None) -> tuple[slice, ...]:
    """Return the index of a range along one axis.

    Parameters
    ----------
    axis
        The axis.
    start, stop
        The range, as in a slice.

    Returns
    -------
    index
        Index into an array with at least `axis` + 1 axes.

    Examples
    --------
    >>> np.arange(6).reshape(2, 3)[along(1, 1, None)].tolist()
    [[1, 2], [4, 5]]
    """
    return (slice(None),) * axis + (slice(start, stop),)


def neighbours_along(array: Array, axis: int) -> tuple[Array, Array]:
    """Return views of the lower and the upper entries of all pairs of neighbours along an axis.

    Parameters
    ----------
    array
        Any array.
    axis
        The axis.

    Returns
    -------
    lower, upper
        Views, one shorter along the axis.

    Examples
    --------
    >>> [view.tolist() for view in neighbours_along(np.arange(3), 0)]
    [[0, 1], [1, 2]]
    """
    return array[along(axis, None, -1)], array[along(axis, 1, None)]


def window(array: Array, offset: IntArray | Sequence[int], shape: tuple[int, ...]) -> Array:
    """Return the view of the given shape that starts at an offset.

    Parameters
    ----------
    array
        Any array.
    offset
        Index of the view's first entry, one number per axis.
    shape
        Shape of the view.

    Examples
    --------
    >>> window(np.arange(9).reshape(3, 3), (1, 0), (2, 2)).tolist()
    [[3, 4], [6, 7]]
    """
    return array[tuple(slice(o, o + n) for o, n in zip(offset, shape, strict=True))]


def around_vertices(cells: Array) -> list[Array]:
    """Return the values of the ``2**dim`` cells around every vertex, in the order of their bits.

    Parameters
    ----------
    cells
        A value per cell, shape n.

    Returns
    -------
    around
        Arrays of shape ``n + 1``.

    Examples
    --------
    >>> [view[1, 1].item() for view in around_vertices(np.array([[1, 3], [2, 4]]))]
    [1, 2, 3, 4]
    """
    padded, dim = np.pad(cells, 1), cells.ndim
    shape = tuple(n + 1 for n in cells.shape)
    return [
        window(padded, tuple(bits >> axis & 1 for axis in range(dim)), shape)
        for bits in range(2**dim)
    ]


def around_edges(cells: Array, axis: int) -> list[Array]:
    """Return the values of the four cells around every edge along an axis of a 3D grid.

    Parameters
    ----------
    cells
        A value per cell, shape n.
    axis
        Direction of the edges.

    Returns
    -------
    around
        Four arrays, in the order of their bits; their shape is n along the axis and ``n + 1`` along
        the others.
    """
    padded = np.pad(cells, [(0, 0) if k == axis else (1, 1) for k in range(3)])
    across = [k for k in range(3) if k != axis]
    lower, upper = neighbours_along(padded, across[1])
    return [view for half in (lower, upper) for view in neighbours_along(half, across[0])]


def is_full(around: list[Array]) -> BoolArray:
    """Return where all cells of a neighbourhood are kept.

    Parameters
    ----------
    around
        Kept cells, see `around_vertices` and `around_edges`.
    """
    return np.asarray(np.logical_and.reduce(around))


def is_diagonal(four: list[Array]) -> BoolArray:
    """Return where exactly two opposite cells out of four are kept, so that an edge is a pinch.

    Parameters
    ----------
    four
        Kept cells around edges in 3D, or vertices in 2D, in the order of their bits.
    """
    a, b, c, d = four
    return np.asarray((a == d) & (b == c) & (a != b))


def at_corners(vertices: Array) -> list[Array]:
    """Return the values at the corners of every cell, in VTK order.

    Parameters
    ----------
    vertices
        A value per grid vertex, shape ``n + 1``.

    Returns
    -------
    corners
        ``2**dim`` views of shape n.
    """
    shape = tuple(n - 1 for n in vertices.shape)
    return [window(vertices, corner, shape) for corner in CORNERS[vertices.ndim]]


def across_faces(cells: Array) -> list[Array]:
    """Return the values of the cells across every face of every cell, in the order of `FACES`.

    Parameters
    ----------
    cells
        A value per cell, shape n.

    Returns
    -------
    across
        ``2 dim`` arrays of shape n; 0 (False) outside the grid.

    Examples
    --------
    >>> [view.tolist() for view in across_faces(np.array([[1, 2]]))]
    [[[0, 1]], [[0, 0]], [[2, 0]], [[0, 0]]]
    """
    padded = np.pad(cells, 1)
    return [
        window(padded, [1 + (2 * end - 1) * (k == axis) for k in range(cells.ndim)], cells.shape)
        for axis, end in FACES[cells.ndim]
    ]
