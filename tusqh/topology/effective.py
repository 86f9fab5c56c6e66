"""The Betti numbers that a mesh will have, from kept cells and pinch decisions alone.

With the decisions made, the paper's complex is small enough to count: two kept cells are joined
when they share a side, or are the diagonal of a connected pinch; two empty cells when they share
a side, or are the diagonal of a separated pinch.  Components of the first graph are the mesh's
components, components of the second (with everything outside the grid as one) are its holes plus
the outside, because the complement of a full subcomplex retracts onto the full subcomplex of the
other nodes (algorithm notes 2).
"""

from __future__ import annotations

import numpy as np
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.grid import BoolArray, IntArray
from tusqh.topology.betti_numbers import BettiNumbers


def label_components(cells: BoolArray, joins_diagonal: BoolArray) -> tuple[IntArray, int]:
    """Return the component of every cell (from 1; 0 elsewhere) and how many there are.

    Parameters
    ----------
    cells
        Cells of a 2D grid, shape n.
    joins_diagonal
        Grid vertices at which the cells of a diagonal count as joined, shape ``n + 1``.

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
    around = np.pad(labels, 1)
    at = joins_diagonal
    low, high = slice(None, -1), slice(1, None)
    links = [
        np.column_stack([around[low, low][at], around[high, high][at]]),
        np.column_stack([around[high, low][at], around[low, high][at]]),
    ]
    pairs = np.concatenate(links)
    pairs = pairs[(pairs > 0).all(axis=1)] - 1
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n_parts,) * 2)
    n_components, of_part = connected_components(graph, directed=False)
    return np.concatenate([[0], of_part + 1])[labels].astype(np.int64), int(n_components)


def effective_betti(kept: BoolArray, connects: BoolArray, separates: BoolArray) -> BettiNumbers:
    """Return the Betti numbers of kept cells whose pinches have been decided.

    Parameters
    ----------
    kept
        Kept cells of a 2D grid, shape n.
    connects, separates
        Grid vertices decided to connect and to separate, shape ``n + 1`` each.

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
    # One more layer of empty cells joins everything outside the grid into one component.
    _, n_empty = label_components(~np.pad(kept, 1), np.pad(separates, 1))
    return BettiNumbers(n_components, n_empty - 1)
