"""Find the facets of a mesh (sides of quads, faces of hexes) and those on the boundary."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid import BoolArray, IndexArray, IntArray
from tusqh.meshes.numbering import count_pairs, number_rows

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
    cells
        Corners of every element, shape (m, 4) or (m, 8).
    local
        Local corners of every facet, shape (sides, 2**(dim - 1)).
    unique
        Number of each facet, equal for rows with the same points, shape (m * sides,).
    n_cells_of
        Number of rows that share each unique facet, at most 255, shape (n_unique,).
    """

    cells: IndexArray
    local: IntArray
    unique: IndexArray
    n_cells_of: NDArray[np.uint8]

    @property
    def n_unique(self) -> int:
        """Number of distinct facets."""
        return len(self.n_cells_of)

    @cached_property
    def corners(self) -> IndexArray:
        """Points of every row in the order of its element, shape (m * sides, 2**(dim - 1))."""
        return self.cells[:, self.local].reshape(-1, self.local.shape[1])

    @cached_property
    def cell(self) -> IntArray:
        """Element of every row, shape (m * sides,)."""
        return np.repeat(np.arange(len(self.cells), dtype=np.int64), len(self.local))

    @cached_property
    def on_boundary(self) -> BoolArray:
        """Whether the facet of each row belongs to no other element."""
        return np.asarray((self.n_cells_of == 1)[self.unique])

    @cached_property
    def boundary(self) -> IndexArray:
        """Points of the boundary facets, facing outwards, shape (n_boundary, 2**(dim - 1))."""
        cell, side = np.divmod(np.flatnonzero(self.on_boundary), len(self.local))
        return np.asarray(self.cells[cell[:, None], self.local[side]])

    @cached_property
    def boundary_edges(self) -> Facets:
        """The edges of the boundary faces of hexes, one row for each edge of each face."""
        return find_facets(self.boundary)


class ClosedSurface(Protocol):
    """The boundary faces of a mesh of hexes, and the edges of these faces."""

    @property
    def boundary(self) -> IndexArray:
        """Points of the boundary faces, facing outwards, shape (n, 4)."""

    @property
    def boundary_edges(self) -> Facets:
        """The edges of these faces, one row for each edge of each face."""


def find_facets(cells: IndexArray) -> Facets:
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
    unique, n_unique = number_rows(cells, local)
    counts = np.zeros(n_unique, dtype=np.uint8)
    _count(unique, counts)
    return Facets(cells=cells, local=local, unique=unique, n_cells_of=counts)


def count_edges(cells: IndexArray) -> int:
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
    return count_pairs(cells, HEX_EDGES)


@numba.njit(cache=True)
def _count(numbers, counts):  # type: ignore[no-untyped-def]
    """Add how often each number occurs, up to 255."""
    for number in numbers:
        counts[number] += counts[number] < 255
