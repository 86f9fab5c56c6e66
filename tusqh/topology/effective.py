"""Predict the Betti numbers of a mesh from kept cells and pinch decisions alone.

Once the decisions are made, the paper's complex is small enough to count.  Kept cells are joined if
they share a face (in 2D a side) or meet at a connected pinch; empty cells are joined if they share
a face or meet at a separated pinch.  Components of the first graph are the mesh's components;
components of the second (with everything outside the grid as one) are its holes in 2D, or its
voids in 3D, plus the outside, because the complement of a full subcomplex retracts onto the full
subcomplex of the other nodes (algorithm 2).  Holes in 3D follow from the Euler characteristic.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.grid import BoolArray, IntArray
from tusqh.grid.neighbourhoods import (
    around_edges,
    around_vertices,
    is_diagonal,
    is_full,
    neighbours_along,
)
from tusqh.topology.betti_numbers import BettiNumbers


def label_components(cells: BoolArray, joins: BoolArray) -> tuple[IntArray, int]:
    """Return the component of every cell and the number of components.

    Parameters
    ----------
    cells
        Cells of a grid, shape n; they are joined across faces.
    joins
        Grid vertices at which all surrounding cells count as joined, shape ``n + 1``.

    Returns
    -------
    labels
        Component of every cell, from 1; 0 elsewhere, shape n.
    n_components
        Number of components.

    Examples
    --------
    >>> import numpy as np
    >>> diagonal, pinch = np.eye(2, dtype=bool), np.zeros((3, 3), dtype=bool)
    >>> label_components(diagonal, pinch)[1]
    2
    >>> pinch[1, 1] = True
    >>> label_components(diagonal, pinch)[1]
    1
    """
    labels, n_parts = ndimage.label(cells)
    around = _around(labels, joins)
    first = around.max(axis=1, initial=0)
    pairs = np.stack([np.repeat(first, around.shape[1]), around.ravel()], axis=1)
    pairs = pairs[(pairs > 0).all(axis=1)] - 1
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n_parts,) * 2)
    n_components, of_part = connected_components(graph, directed=False)
    return np.concatenate([[0], of_part + 1])[labels].astype(np.int64), int(n_components)


def count_euler_characteristic(kept: BoolArray, connects: BoolArray) -> int:
    """Return the Euler characteristic of kept cells whose pinches have been decided.

    Only nodes whose star changes it are counted: the link of an edge or vertex that is not a pinch
    and has some, but not all, of its cells kept is contractible.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    connects
        Pinches decided to connect, shape ``n + 1``; the ends of a pinch edge agree.

    Examples
    --------
    >>> import numpy as np
    >>> kept = np.ones((3, 3, 1), dtype=bool)
    >>> kept[1, 1] = False
    >>> count_euler_characteristic(kept, np.zeros((4, 4, 2), dtype=bool))      # a solid ring
    0
    """
    euler = int(kept.sum())
    for axis in range(kept.ndim):
        lower, upper = neighbours_along(kept, axis)
        euler -= int((lower & upper).sum())
        if kept.ndim == 3:
            around_edge = around_edges(kept, axis)
            is_joined = is_diagonal(around_edge) & neighbours_along(connects, axis)[0]
            euler += int(is_full(around_edge).sum()) - int(is_joined.sum())
    n_inner = int(is_full(around_vertices(kept)).sum())
    euler += n_inner if kept.ndim == 2 else -n_inner
    around = _around(kept, connects).astype(bool).reshape(-1, *(2,) * kept.ndim)
    return euler + len(around) - int(_euler_of_links(around).sum())


def effective_betti(kept: BoolArray, connects: BoolArray, separates: BoolArray) -> BettiNumbers:
    """Return the Betti numbers of kept cells whose pinches have been decided.

    Parameters
    ----------
    kept
        Kept cells, shape n, in 2D or 3D.
    connects, separates
        Pinches decided to connect and to separate, shape ``n + 1`` each.

    Examples
    --------
    >>> import numpy as np
    >>> ring = np.ones((3, 3), dtype=bool)
    >>> ring[1, 1] = False
    >>> none = np.zeros((4, 4), dtype=bool)
    >>> str(effective_betti(ring, none, none))
    '(1, 1, 0)'
    """
    _, n_components = label_components(kept, connects)
    # A further layer of empty cells joins everything outside the grid into one component.
    _, n_empty = label_components(~np.pad(kept, 1), np.pad(separates, 1))
    if kept.ndim == 2:
        return BettiNumbers(n_components, n_empty - 1)
    euler = count_euler_characteristic(kept, connects)
    return BettiNumbers(n_components, n_components + n_empty - 1 - euler, n_empty - 1)


def _around(cells: np.ndarray[Any, Any], at_vertex: BoolArray) -> IntArray:
    """Return the values of the cells around marked vertices, shape (m, 2**dim)."""
    around = [values[at_vertex] for values in around_vertices(cells)]
    return np.stack(around, axis=1).astype(np.int64)


def _euler_of_links(around: BoolArray) -> IntArray:
    """Return the Euler characteristic of the links of connected pinches, shape (m,).

    The link holds the kept cells, their shared faces and, in 3D, the edges with four kept cells
    (a disk) or a diagonal of two (an arc between them).
    """
    euler = around.sum(axis=tuple(range(1, around.ndim)))
    for axis in range(1, around.ndim):
        low, high = np.moveaxis(around, axis, 0)
        euler -= (low & high).sum(axis=tuple(range(1, low.ndim)))
        if around.ndim == 4:
            for half in (low, high):
                four = [half[:, x, y] for x in range(2) for y in range(2)]
                euler += is_full(four).astype(np.int64) - is_diagonal(four)
    return np.asarray(euler, dtype=np.int64)
