"""Cells that can be changed one by one, with the votes of their contacts and their topology."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tusqh.antialias.cells import CellSet
from tusqh.contacts.one_material_contacts import find_contacts
from tusqh.grid import BoolArray, IntArray
from tusqh.local_topology.link import link_in
from tusqh.local_topology.move import touch_bridges, votes_of
from tusqh.local_topology.simple_cells import change_simple, count_pieces


class Workspace:
    """The cells of a set on a flat grid with one layer of empty cells, and what decides about them.

    Parameters
    ----------
    start
        The cells to begin with.
    votes
        Which places of the doubled grid vote to connect, shape ``2 n + 1``; None: those of the
        threshold of the cells.
    """

    def __init__(self, start: CellSet, votes: BoolArray | None = None) -> None:
        self.start = start
        self.votes = votes_of(start) if votes is None else votes
        self.shape = tuple(n + 2 for n in start.kept.shape)
        self.dim = len(self.shape)
        self._flat_votes = np.pad(self.votes, 2).ravel()
        self._place_shape = tuple(2 * n + 1 for n in self.shape)
        self._link = link_in(self.shape, self._place_shape)
        self.fraction = np.pad(start.fractions.cells, 1).ravel()
        #: Cells that never change: the layer around the grid, and cells beside bridges.
        self.is_fixed = np.pad(touch_bridges(start), 1, constant_values=True).ravel()

    def flatten(self, kept: BoolArray) -> BoolArray:
        """Return cells of the grid on the flat grid.

        Parameters
        ----------
        kept
            Cells of the grid, shape n.
        """
        return np.pad(kept, 1).ravel()

    def unflatten(self, kept: BoolArray) -> BoolArray:
        """Return cells of the flat grid as cells of the grid, shape n.

        Parameters
        ----------
        kept
            Cells of the flat grid.
        """
        return np.asarray(kept.reshape(self.shape)[(slice(1, -1),) * self.dim])

    def cells_at(self, place: int) -> IntArray:
        """Return the flat cells around a flat place of the doubled grid of `start`.

        Parameters
        ----------
        place
            Flat index into the doubled grid, shape ``2 n + 1``.
        """
        inner = tuple(2 * (n - 2) + 1 for n in self.shape)
        index = np.array(np.unravel_index(place, inner))
        ranges = [[i // 2 + 1] if i % 2 else [i // 2, i // 2 + 1] for i in index.tolist()]
        cells = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, self.dim)
        return self._to_flat(tuple(cells.T))

    def cells_near(self, cell: int, radius: int) -> IntArray:
        """Return the flat cells of the grid within a distance along each axis, shape (r,).

        Parameters
        ----------
        cell
            Flat index of the cell.
        radius
            Largest difference of the indices.
        """
        at = [int(i) for i in np.unravel_index(cell, self.shape)]
        ranges = [
            np.arange(max(1, i - radius), min(n - 1, i + radius + 1))
            for i, n in zip(at, self.shape, strict=True)
        ]
        return self._to_flat(tuple(np.meshgrid(*ranges, indexing="ij"))).ravel()

    def squared_distance(self, cells: IntArray, cell: int) -> IntArray:
        """Return the squared distances of flat cells to one of them, in cells, shape (r,).

        Parameters
        ----------
        cells
            Flat indices, shape (r,).
        cell
            Flat index of the other cell.
        """
        steps = np.stack(np.unravel_index(cells, self.shape)) - np.array(
            np.unravel_index(cell, self.shape)
        ).reshape(-1, 1)
        return np.asarray((steps**2).sum(axis=0), dtype=np.int64)

    def change_simple(self, kept: BoolArray, cells: IntArray) -> None:
        """Add or remove cells while they are simple, in place, see `simple_cells.change_simple`.

        Parameters
        ----------
        kept
            Cells of the flat grid; they change.
        cells
            Flat indices, first the most urgent, shape (r,).
        """
        change_simple(cells, self._places(cells), kept, self._flat_votes, self._link)

    def count_pieces(self, kept: BoolArray, cell: int) -> tuple[int, int]:
        """Return the numbers of pieces of a cell's neighbours, see `simple_cells.count_pieces`.

        Parameters
        ----------
        kept
            Cells of the flat grid.
        cell
            Flat index of the cell.

        Returns
        -------
        present, absent
            The two numbers.
        """
        place = self._places(np.array([cell]))[0]
        found = count_pieces(cell, place, kept, self._flat_votes, self._link)
        return int(found[0]), int(found[1])

    def cell_set(self, kept: BoolArray) -> CellSet:
        """Return the cells of the flat grid with their contacts.

        Parameters
        ----------
        kept
            Cells of the flat grid.
        """
        cells = self.unflatten(kept)
        return replace(self.start, kept=cells, contacts=find_contacts(cells, self.votes))

    def _to_flat(self, index: tuple[IntArray, ...]) -> IntArray:
        """Return the flat cells of indices along each axis."""
        return np.asarray(np.ravel_multi_index(index, self.shape), dtype=np.int64)

    def _places(self, cells: IntArray) -> IntArray:
        """Return the places of flat cells on the doubled grid of the flat grid."""
        index = np.unravel_index(cells, self.shape)
        at = tuple(2 * axis + 1 for axis in index)
        return np.ravel_multi_index(at, self._place_shape).astype(np.int64)
