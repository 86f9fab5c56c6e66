"""One of several materials as a field of volume fractions: its share against the best other one.

The field is that of `tusqh.contacts.score_field`, except that ties and rounding are resolved: its
level of the base is reached exactly where the material wins.
"""

from __future__ import annotations

import numpy as np

from tusqh.antialias.cells import CellSets
from tusqh.contacts.decided import Contacts, Labels
from tusqh.contacts.material_fractions import FULL, MaterialFractions
from tusqh.contacts.score_field import score_field
from tusqh.contacts.surround import LAYERS_OF
from tusqh.grid import IntArray
from tusqh.local_topology.features import Features
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Policy


class OneOfMany:
    """The classes of one of several materials at given thresholds.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    material
        Number of the material.
    thresholds
        Threshold of every material, in multiples of 2**-20, shape (m,).
    """

    def __init__(self, fractions: MaterialFractions, material: int, thresholds: IntArray) -> None:
        self.material = material
        field = score_field(fractions, material, thresholds / FULL)
        own = int(thresholds[material])
        level = -(-own * FULL // (own + FULL))
        wins = np.zeros(field.shape, dtype=bool)
        places = np.flatnonzero(np.diff(fractions.start)).astype(np.int64)
        wins.flat[places] = fractions.label_places(places, thresholds) == material
        field = np.where(wins, np.maximum(field, level), np.minimum(field, level - 1))
        multiples = field.astype(np.int32)
        cell_sets = CellSets(VolumeFractions(fractions.grid, 1, multiples), Policy(bridges="none"))
        self._wins = wins
        #: The classes, at the cells that the material wins.
        self.features = Features(cell_sets, level * RESOLUTION)

    def on(self, labels: Labels, contacts: Contacts) -> Features:
        """Return the classes for other cells of the material.

        Parameters
        ----------
        labels
            Material of every cell, shape n.
        contacts
            The contacts of all materials with their votes.  A place without a contact votes as if
            all materials were candidates.
        """
        votes = self._wins.copy()
        for cells, winner in (
            (contacts.edge_cells, contacts.edge_material),
            (contacts.vertex_cells, contacts.ball),
        ):
            votes[tuple(_places_of(cells, labels.shape))] = winner == self.material
        return self.features.on(labels == self.material, votes)


def _places_of(cells: IntArray, shape: tuple[int, ...]) -> IntArray:
    """Return the places of contacts on the doubled grid, given the cells around them, by axis."""
    layers = LAYERS_OF[len(shape)]
    index = np.stack(np.unravel_index(cells, [n + 2 * layers for n in shape])) - layers
    return np.asarray(2 * index.sum(axis=2) // cells.shape[1] + 1)
