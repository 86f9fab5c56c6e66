"""Find pinches: grid vertices at which kept cells, or empty ones, meet without sharing a face.

Paper: Anti-aliasing.  Tables computed once from the definition state which of the ``2**(2**dim)``
neighbourhoods of a vertex are pinches.
"""

from __future__ import annotations

import functools
import itertools

import numpy as np

from tusqh.grid import BoolArray, IntArray
from tusqh.grid.neighbourhoods import around_edges, around_vertices, is_diagonal


def neighbourhood_codes(kept: BoolArray) -> IntArray:
    """Return a number for every grid vertex whose bits state which of its cells are kept.

    Parameters
    ----------
    kept
        Kept cells of the grid, shape n; cells outside the grid are empty.

    Returns
    -------
    codes
        Shape ``n + 1``.  Bit ``b`` belongs to the cell that lies on the upper side along axis ``k``
        if bit ``k`` of ``b`` is set: in 2D bits 0, 1, 2, 3 are lower left, lower right, upper
        left, upper right.

    Examples
    --------
    >>> import numpy as np
    >>> neighbourhood_codes(np.array([[True]])).tolist()  # doctest: +NORMALIZE_WHITESPACE
    [[8, 2], [4, 1]]
    """
    around = around_vertices(kept)
    codes = np.zeros(around[0].shape, dtype=np.int64)
    for bit, is_kept in enumerate(around):
        codes |= is_kept.astype(np.int64) << bit
    return codes


@functools.cache
def pinch_table(dim: int) -> BoolArray:
    """Return, for every neighbourhood code, whether its vertex is a pinch.

    A vertex is a pinch if its kept cells, or its empty cells, are not connected through shared
    faces within the neighbourhood (algorithm 4.1).  In 2D the two diagonal neighbourhoods are
    pinches.

    Parameters
    ----------
    dim
        Dimension of the grid.

    Returns
    -------
    is_pinch
        Shape (2**(2**dim),), see `neighbourhood_codes`; read-only.

    Examples
    --------
    >>> pinch_table(2).nonzero()[0].tolist()
    [6, 9]
    >>> int(pinch_table(3).sum())
    128
    """
    kept, empty = _component_table(dim, 1), _component_table(dim, 1)[::-1]
    return _frozen((kept > 1) | (empty > 1))


def _component_table(dim: int, reach: int) -> IntArray:
    """Count the components of kept cells of every code; joined cells differ along <= `reach` axes.

    Reversed, the table counts the components of the empty cells, since the code of the complement
    is the largest code minus the code.
    """
    n_cells = 2**dim
    counts = [
        _n_components([b for b in range(n_cells) if code >> b & 1], reach)
        for code in range(2**n_cells)
    ]
    return np.array(counts, dtype=np.int64)


def _n_components(cells: list[int], reach: int) -> int:
    """Count the components of cells; cells that differ along at most `reach` axes are joined."""
    parent = {c: c for c in cells}

    def root(c: int) -> int:
        while parent[c] != c:
            c = parent[c]
        return c

    for a, b in itertools.combinations(cells, 2):
        if (a ^ b).bit_count() <= reach:
            parent[root(a)] = root(b)
    return sum(parent[c] == c for c in cells)


def _frozen(table: BoolArray) -> BoolArray:
    table.setflags(write=False)
    return table


def find_pinch_edges(kept: BoolArray, axis: int) -> BoolArray:
    """Return the grid edges along an axis around which exactly two opposite cells are kept.

    Parameters
    ----------
    kept
        Kept cells of a 3D grid, shape n.
    axis
        Direction of the edges.

    Returns
    -------
    is_pinch
        Shape n along the axis, ``n + 1`` along the others.

    Examples
    --------
    >>> kept = np.zeros((2, 2, 1), dtype=bool)
    >>> kept[0, 0] = kept[1, 1] = True
    >>> np.argwhere(find_pinch_edges(kept, 2)).tolist()
    [[1, 1, 0]]
    """
    return is_diagonal(around_edges(kept, axis))


def find_pinches(kept: BoolArray) -> BoolArray:
    """Return the pinch vertices of a set of kept cells.

    Parameters
    ----------
    kept
        Kept cells, shape n.

    Returns
    -------
    is_pinch
        Shape ``n + 1``.

    Examples
    --------
    >>> find_pinches(np.array([[True, False], [False, True]])).astype(int)[1].tolist()
    [0, 1, 0]
    """
    return pinch_table(kept.ndim)[neighbourhood_codes(kept)]
