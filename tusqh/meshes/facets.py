"""Find the facets of a mesh (sides of quads, faces of hexes) and those on the boundary."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tusqh.grid import BoolArray, IntArray

#: Local corners of every facet, facing outwards (VTK order).
QUAD_FACETS: IntArray = np.array([[0, 1], [1, 2], [2, 3], [3, 0]], dtype=np.int64)
HEX_FACETS: IntArray = np.array(
    [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]],
    dtype=np.int64,
)

#: Local corners of the edges of a hex.
HEX_EDGES: IntArray = np.array(
    [[a, (a + 1) % 4] for a in range(4)]
    + [[4 + a, 4 + (a + 1) % 4] for a in range(4)]
    + [[a, a + 4] for a in range(4)],
    dtype=np.int64,
)


@dataclass(frozen=True)
class Facets:
    """The facets of a mesh, with one row for each side of each element.

    Parameters
    ----------
    corners
        Points of every facet in the order of its element, shape (m * sides, 2**(dim - 1)).
    cell
        Element of every row, shape (m * sides,).
    unique
        Number of each facet, equal for rows with the same points, shape (m * sides,).
    n_cells_of
        Number of rows that share each unique facet, shape (n_unique,).
    """

    corners: IntArray
    cell: IntArray
    unique: IntArray
    n_cells_of: IntArray

    @property
    def n_unique(self) -> int:
        """Number of distinct facets."""
        return len(self.n_cells_of)

    @cached_property
    def on_boundary(self) -> BoolArray:
        """Whether the facet of each row belongs to no other element."""
        return np.asarray(self.n_cells_of[self.unique] == 1)

    @cached_property
    def boundary(self) -> IntArray:
        """Points of the boundary facets, facing outwards, shape (n_boundary, 2**(dim - 1))."""
        return self.corners[self.on_boundary]

    @cached_property
    def boundary_edges(self) -> Facets:
        """The edges of the boundary faces of hexes, one row for each edge of each face."""
        return find_facets(self.boundary)


def find_facets(cells: IntArray) -> Facets:
    """Return the facets of quads (shape (m, 4)) or hexes (shape (m, 8)).

    Parameters
    ----------
    cells
        Corners of every element in VTK order, shape (m, 4) or (m, 8).

    Examples
    --------
    >>> import numpy as np
    >>> two_quads = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
    >>> facets = find_facets(two_quads)
    >>> facets.n_unique, int(facets.on_boundary.sum())
    (7, 6)
    """
    local = QUAD_FACETS if cells.shape[1] == 4 else HEX_FACETS
    corners = cells[:, local].reshape(-1, local.shape[1])
    cell = np.repeat(np.arange(len(cells), dtype=np.int64), len(local))
    ordered = np.sort(corners, axis=1)
    # Two points identify a side, but a quad face needs all of its points: rank the pairs after
    # each packing step, so that the keys stay within int64.
    key = _rank_pairs(ordered[:, 0], ordered[:, 1])
    for column in range(2, ordered.shape[1]):
        key = _rank_pairs(key, ordered[:, column])
    counts = np.bincount(key, minlength=int(key.max()) + 1 if len(key) else 0)
    return Facets(corners=corners, cell=cell, unique=key, n_cells_of=counts.astype(np.int64))


def _rank_pairs(first: IntArray, second: IntArray) -> IntArray:
    """Return a number for each pair, equal for equal pairs and in lexicographic order."""
    if len(first) == 0:
        return np.empty(0, dtype=np.int64)
    packed = first * (int(second.max()) + 1) + second
    return np.asarray(np.unique(packed, return_inverse=True)[1], dtype=np.int64)


def count_edges(cells: IntArray) -> int:
    """Return the number of distinct edges of hexes, shape (m, 8).

    Parameters
    ----------
    cells
        Corners of every hex in VTK order, shape (m, 8).

    Examples
    --------
    >>> count_edges(np.arange(8)[None])
    12
    """
    if len(cells) == 0:
        return 0
    n = int(cells.max()) + 1
    ends = [(cells[:, a], cells[:, b]) for a, b in HEX_EDGES.tolist()]
    keys = np.concatenate([np.minimum(a, b) * n + np.maximum(a, b) for a, b in ends])
    keys.sort()
    return 1 + int(np.count_nonzero(keys[1:] != keys[:-1]))
