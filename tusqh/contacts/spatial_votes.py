"""Count the votes of the vertices and edges of a padded grid in 3D."""

from __future__ import annotations

import numpy as np

from tusqh.contacts.decided import Labels
from tusqh.contacts.octants import BITS, octants
from tusqh.contacts.votes import Fractions, count_votes
from tusqh.grid import IntArray

#: Layers of void around the grid: sticks reach into the first and are judged from the second.
LAYERS = 2


class SpatialVotes:
    """The votes of vertices and edges of a padded grid.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    labels
        Material of every cell, with two layers of void around them, shape ``n + 4``.
    thresholds
        Threshold of every material, in multiples of 2**-20, shape (m,).
    """

    def __init__(self, fractions: Fractions, labels: Labels, thresholds: IntArray) -> None:
        self.fractions, self.thresholds = fractions, thresholds
        self.shape = tuple(n + 1 for n in labels.shape)
        small = labels.astype(np.int8 if fractions.void < 2**7 else np.int32)
        self.labels = np.pad(small, ((0, 1),) * 3, constant_values=fractions.void).ravel()
        inside = np.zeros(self.shape, dtype=bool)
        inside[(slice(LAYERS, -LAYERS - 1),) * 3] = True
        self.inside = inside.ravel()
        self.steps = np.array([self.shape[1] * self.shape[2], self.shape[2], 1], dtype=np.int64)
        self.octant = (BITS - 1) @ self.steps

    @property
    def void(self) -> int:
        """Index of the void."""
        return self.fractions.void

    def of_vertices(self, vertices: IntArray) -> Labels:
        """Return the materials for which some vertices vote, shape (p,).

        Parameters
        ----------
        vertices
            Numbers of vertices, shape (p,).
        """
        candidates = self.labels[vertices[:, None] + self.octant].astype(np.int32)
        return self._count(2 * self._index(vertices), candidates)

    def of_edges(self, axis: int, edges: IntArray) -> tuple[Labels, Labels]:
        """Return the materials around some edges and their votes.

        Parameters
        ----------
        axis
            Direction of the edges.
        edges
            Numbers of the vertices where they start, shape (e,).

        Returns
        -------
        materials
            Materials of the cells around them, shape (e, 4).
        winners
            The materials for which they vote, shape (e,).
        """
        cells = edges[:, None] + self.octant[octants().around[2 * axis + 1]]
        candidates = self.labels[cells].astype(np.int32)
        place = 2 * self._index(edges)
        place[:, axis] += 1
        return candidates, self._count(place, candidates)

    def _index(self, vertices: IntArray) -> IntArray:
        """Return the indices of vertices in the grid without layers, shape (p, 3)."""
        return np.stack(np.unravel_index(vertices, self.shape), axis=1) - LAYERS

    def _count(self, place: IntArray, candidates: Labels) -> Labels:
        """Return the materials for which places of the doubled grid vote."""
        shape = tuple(2 * n + 1 for n in self.fractions.grid.shape)
        is_inside = np.all((place >= 0) & (place < shape), axis=1)
        flat = np.ravel_multi_index(tuple((place * is_inside[:, None]).T), shape)
        return count_votes(
            self.fractions, np.where(is_inside, flat, -1), candidates, self.thresholds
        ).winner
