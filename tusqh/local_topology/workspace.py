"""Cells that can be changed one by one, with the votes of their contacts and their topology."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from tusqh.antialias.cells import CellSet
from tusqh.contacts.one_material import MATERIAL
from tusqh.contacts.one_material_contacts import find_contacts, label_cells
from tusqh.contacts.predict import predict_betti
from tusqh.grid import BoolArray, IntArray
from tusqh.local_topology.link import link_in
from tusqh.local_topology.move import touch_bridges, votes_of
from tusqh.local_topology.regions import Field, flood, split_around
from tusqh.local_topology.simple_cells import change_simple, find_events, find_pieces
from tusqh.topology.betti_numbers import BettiNumbers

#: Names of no cells, see `Workspace.split`.
NO_NAMES: IntArray = np.zeros(0, dtype=np.int64)


class Split(NamedTuple):
    """Whether two pieces of the neighbours of a cell are joined without it.

    Parameters
    ----------
    is_joined
        Whether they are.
    cells
        If not, all cells of one of the two sides, on the flat grid.
    names
        Names of that side and of the other one, 0 if unknown.
    """

    is_joined: bool
    cells: IntArray
    names: tuple[int, int]


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
        self._rank = np.full(len(self.is_fixed), -1, dtype=np.int32)
        self._field = Field(
            votes=self._flat_votes,
            link=self._link,
            shape=np.array(self.shape, dtype=np.int64),
            place_step=np.append(np.cumprod(self._place_shape[:0:-1])[::-1], 1).astype(np.int64),
            bridged=self._find_bridged(),
            side=np.full(len(self.is_fixed), -1, dtype=np.int8),
        )

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
        places = self._places(cells)
        change_simple(cells, places, kept, self._flat_votes, self._link, self._rank)

    def find_pieces(self, kept: BoolArray, cell: int) -> tuple[list[int], list[int]]:
        """Return the pieces of a cell's neighbours, see `simple_cells.find_pieces`.

        Parameters
        ----------
        kept
            Cells of the flat grid.
        cell
            Flat index of the cell.

        Returns
        -------
        present, absent
            The neighbours of each piece, as bits.
        """
        place = self._places(np.array([cell]))[0]
        present, absent = find_pieces(cell, place, kept, self._flat_votes, self._link)
        return present.tolist(), absent.tolist()

    def find_events(
        self, kept: BoolArray, cells: IntArray, pieces: tuple[int, int], most: int
    ) -> IntArray:
        """Return the first of some cells whose neighbours have given numbers of pieces.

        Parameters
        ----------
        kept
            Cells of the flat grid.
        cells
            Flat indices, shape (r,).
        pieces
            The numbers of present and of absent pieces.
        most
            Largest number of cells to return.
        """
        places = self._places(cells)
        found = find_events(cells, places, pieces, most, kept, self._flat_votes, self._link)
        return np.asarray(found)

    def split(
        self,
        kept: BoolArray,
        cell: int,
        pieces: list[int],
        *,
        follows_kept: bool,
        known: IntArray = NO_NAMES,
    ) -> Split:
        """Return whether two pieces of a cell's neighbours are joined without the cell.

        Parameters
        ----------
        kept
            Cells of the flat grid.
        cell
            Flat index of the cell.
        pieces
            The two pieces, as bits.
        follows_kept
            Whether the pieces are of kept cells, not of empty ones.
        known
            Names of some cells, see `tusqh.local_topology.regions.split_around`.
        """
        first, second = pieces
        is_joined, cells, names = split_around(
            cell, first, second, kept, follows_kept, known, self._field
        )
        return Split(bool(is_joined), cells, (int(names[0]), int(names[1])))

    def flood(
        self,
        kept: BoolArray,
        cells: IntArray,
        *,
        follows_kept: bool,
        known: IntArray = NO_NAMES,
    ) -> tuple[IntArray, bool]:
        """Return the cells that are joined to some cells, and whether they reach the outside.

        Parameters
        ----------
        kept
            Cells of the flat grid.
        cells
            Flat cells to begin with, shape (r,).
        follows_kept
            Whether kept cells are followed, not empty ones.
        known
            Names of cells that are not passed, see `tusqh.local_topology.regions.flood`.

        Returns
        -------
        cells, is_outside
            The cells, and whether the outside is among them.
        """
        found, is_outside = flood(cells, kept, follows_kept, known, self._field)
        return found, bool(is_outside)

    def betti_of(self, cells: IntArray, *, are_kept: bool) -> BettiNumbers:
        """Return the Betti numbers of some cells alone.

        Parameters
        ----------
        cells
            Flat cells, shape (r,).
        are_kept
            Whether they are joined as kept cells are, or as empty cells.
        """
        index = np.stack(np.unravel_index(cells, self.shape)) - 1
        low, high = index.min(axis=1), index.max(axis=1)
        part = np.zeros(high - low + 1, dtype=bool)
        part[tuple(index - low[:, None])] = True
        box = tuple(slice(2 * a, 2 * b + 3) for a, b in zip(low, high, strict=True))
        votes = self.votes[box] == are_kept
        return predict_betti(label_cells(part), find_contacts(part, votes), 2)[MATERIAL]

    def cell_set(self, kept: BoolArray) -> CellSet:
        """Return the cells of the flat grid with their contacts.

        Parameters
        ----------
        kept
            Cells of the flat grid.
        """
        cells = self.unflatten(kept)
        return replace(self.start, kept=cells, contacts=find_contacts(cells, self.votes))

    def _find_bridged(self) -> IntArray:
        """Return the flat cells that bridges join, shape (r, 2)."""
        pairs = np.array([bridge.cells for bridge in self.start.bridges], dtype=np.int64)
        index = np.unravel_index(pairs.reshape(-1, 2), self.start.kept.shape)
        return self._to_flat(tuple(axis + 1 for axis in index))

    def _to_flat(self, index: tuple[IntArray, ...]) -> IntArray:
        """Return the flat cells of indices along each axis."""
        return np.asarray(np.ravel_multi_index(index, self.shape), dtype=np.int64)

    def _places(self, cells: IntArray) -> IntArray:
        """Return the places of flat cells on the doubled grid of the flat grid."""
        index = np.unravel_index(cells, self.shape)
        at = tuple(2 * axis + 1 for axis in index)
        return np.ravel_multi_index(at, self._place_shape).astype(np.int64)
