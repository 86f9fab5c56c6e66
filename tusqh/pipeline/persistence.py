"""Stage 3: find the topology at every threshold, before any mesh is made."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import pandas as pd

from tusqh.grid import BackgroundGrid
from tusqh.sampling.fractions import VolumeFractions
from tusqh.topology.persistence import locate_pairs
from tusqh.topology.topology import Topology


@dataclass(frozen=True)
class Persistence:
    """The topology of the filtration, counted in two independent ways.

    Each table is computed once, when it is first needed.

    Parameters
    ----------
    topology
        The topology of the fractions.
    grid
        The background grid, which locates the pairs.
    name
        The model, for messages.
    """

    topology: Topology
    grid: BackgroundGrid
    name: str

    @property
    def curves(self) -> pd.DataFrame:
        """Betti numbers of the filtration at every plateau of the threshold.

        See `tusqh.topology.curves.tabulate_curves`.
        """
        return self.topology.curves

    @cached_property
    def diagram(self) -> pd.DataFrame:
        """Persistence pairs with the places that create and destroy each class.

        See `tusqh.topology.persistence.locate_pairs`.

        Raises
        ------
        TopologyError
            Pairs and curves differ, which is a fault of tusqh, never of the geometry.
        """
        self.topology.require_agreement(name=self.name)
        return locate_pairs(self.topology.pairs, self.grid)

    @property
    def diagonal(self) -> pd.DataFrame:
        """Number of pairs with persistence 0, by `dimension` and `birth`."""
        return self.topology.diagonal


def find_persistence(fractions: VolumeFractions, *, name: str = "model") -> Persistence:
    """Return the Betti curves and the persistence diagram of volume fractions.

    Parameters
    ----------
    fractions
        Volume fractions.
    name
        The model, for messages.
    """
    return Persistence(Topology(fractions.multiples), fractions.grid, name)
