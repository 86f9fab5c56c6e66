"""Slabs of a grid in space: ranges of its cells along x.

The cells are numbered with x slowest, so a slab is a range of cell numbers, and the elements in it
are a range of the elements of the whole mesh.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tusqh.grid.arrays import BoolArray, IntArray
from tusqh.grid.background import BackgroundGrid

#: Fewest cells along x in a slab, so that only neighbouring slabs share points.
LEAST = 4


class Slab(NamedTuple):
    """The cells ``begin <= i < end`` along x.

    Parameters
    ----------
    number
        Number of the slab, from 0.
    begin, end
        Range of cells along x.
    """

    number: int
    begin: int
    end: int

    @property
    def rows(self) -> slice:
        """The rows of the doubled grid from the lowest to the highest vertices of the slab."""
        return slice(2 * self.begin, 2 * self.end + 1)

    def grid(self, whole: BackgroundGrid) -> BackgroundGrid:
        """Return the grid of the slab alone.

        Parameters
        ----------
        whole
            The whole grid.
        """
        origin = whole.origin[0] + self.begin * whole.cell_size
        shape = (self.end - self.begin, *whole.shape[1:])
        return replace(whole, shape=shape, origin=(origin, *whole.origin[1:]))


def cut(grid: BackgroundGrid, n_slabs: int) -> list[Slab]:
    """Return slabs of about equal thickness, fewer where they would be thinner than `LEAST` cells.

    Parameters
    ----------
    grid
        The whole grid.
    n_slabs
        How many slabs are wanted.

    Examples
    --------
    >>> grid = BackgroundGrid((9, 4, 4), 1.0, (0.0, 0.0, 0.0))
    >>> [(slab.begin, slab.end) for slab in cut(grid, 5)]
    [(0, 4), (4, 9)]
    """
    n = grid.shape[0]
    count = max(1, min(n_slabs, n // LEAST))
    bounds = [k * n // count for k in range(count + 1)]
    return [Slab(k, bounds[k], bounds[k + 1]) for k in range(count)]


class PackedBits:
    """An array of truth values in space that takes one bit for each.

    Parameters
    ----------
    shape
        Its shape; all values are False at first.

    Examples
    --------
    >>> bits = PackedBits((2, 2, 9))
    >>> bits.set_rows(1, np.ones((1, 2, 9), dtype=bool))
    >>> bits[np.array([0, 1]), np.array([1, 1]), np.array([8, 8])].tolist()
    [False, True]
    """

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.shape = shape
        self._bytes = np.zeros((*shape[:2], -(-shape[2] // 8)), dtype=np.uint8)

    def set_rows(self, first: int, rows: BoolArray) -> None:
        """Set some rows along x.

        Parameters
        ----------
        first
            The first of them.
        rows
            Their values, shape (m, n_y, n_z).
        """
        self._bytes[first : first + len(rows)] = np.packbits(rows, axis=2)

    def rows(self, first: int, last: int) -> BoolArray:
        """Return the rows ``first <= i < last`` along x, shape (m, n_y, n_z).

        Parameters
        ----------
        first, last
            The range.
        """
        found = np.unpackbits(self._bytes[first:last], axis=2, count=self.shape[2])
        return np.asarray(found.view(np.bool_))

    def __getitem__(self, places: tuple[NDArray[Any], ...]) -> BoolArray:
        """Return the values at some places, given by one array of indices for each axis."""
        x, y, z = places
        return np.asarray(self._bytes[x, y, z >> 3] >> (7 - (z & 7)) & 1, dtype=np.bool_)

    def flat(self, places: IntArray) -> BoolArray:
        """Return the values at flat places (C order), shape of `places`.

        Parameters
        ----------
        places
            Flat places.
        """
        return self[np.unravel_index(places, self.shape)]
