"""The topology of volume fractions at every threshold, computed from the exact multiples."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Self

import numpy as np
import pandas as pd

from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.doubled_grid import RESOLUTION, Multiples
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.clamping import MARGIN, clamp_at_level, clamp_multiples, complement
from tusqh.topology.curves import persistence_by_cell, tabulate_curves
from tusqh.topology.one_level import count_at_level
from tusqh.topology.pairs import count_on_diagonal, find_enclosed, tabulate_pairs
from tusqh.topology.persistence import betti_at, require_agreement
from tusqh.topology.union_find import Merges, merge_components


class Topology:
    """The topology of the filtration; each property is computed once, when first needed.

    Two passes of union-find give everything except the pairs of dimension 1 in 3D, which
    `tusqh.topology.loops` finds.

    Parameters
    ----------
    multiples
        Fractions on the doubled grid as multiples of `RESOLUTION`, shape ``2 n + 1``, int32;
        they are clamped to the range from 0 to 1 / `RESOLUTION`.

    Examples
    --------
    Only a vertex joins the two cells, so the younger component dies when the vertex enters.

    >>> fractions = np.zeros((5, 5))
    >>> fractions[1, 1], fractions[3, 3], fractions[2, 2] = 1.0, 0.75, 0.5
    >>> topology = Topology.from_fractions(fractions)
    >>> topology.curves[["upper", "lower", "betti_0"]].values
    array([[1.  , 0.75, 1.  ],
           [0.75, 0.5 , 2.  ],
           [0.5 , 0.  , 1.  ]])
    >>> topology.pairs[["dimension", "birth", "death", "death_place"]].values
    array([[ 0.  ,  1.  ,  0.  , -1.  ],
           [ 0.  ,  0.75,  0.5 , 12.  ]])
    """

    def __init__(self, multiples: Multiples) -> None:
        self.multiples = multiples

    @classmethod
    def from_fractions(cls, fractions: FloatArray) -> Self:
        """Return the topology of fractions on the doubled grid, rounded to `RESOLUTION`.

        Parameters
        ----------
        fractions
            Shape ``2 n + 1``, dimensionless.
        """
        return cls(np.rint(fractions / RESOLUTION).astype(np.int32))

    @classmethod
    def from_tables(cls, multiples: Multiples, curves: pd.DataFrame, pairs: pd.DataFrame) -> Self:
        """Return a topology whose curves and pairs were computed before.

        Parameters
        ----------
        multiples
            See `Topology`.
        curves, pairs
            Tables of the properties with these names, read from files for instance.
        """
        topology = cls(multiples)
        topology.__dict__.update(curves=curves, pairs=pairs)
        return topology

    @cached_property
    def curves(self) -> pd.DataFrame:
        """Betti numbers of every plateau, see `tusqh.topology.curves.tabulate_curves`."""
        return tabulate_curves(self._nodes, self._kept, self._empty)

    @cached_property
    def pairs(self) -> pd.DataFrame:
        """Pairs with positive persistence, including classes that never die.

        There is one row per pair, sorted: `dimension`; `birth` and `death`, the fractions at which
        the class appears and disappears as the threshold falls (death is 0 for classes that remain
        at every threshold above 0, and `essential` is then True); `persistence` = birth - death;
        `birth_place` and `death_place`, the flat indices into the doubled grid of the cells, edges
        or vertices that create and destroy the class (-1 if nothing does).
        """
        return tabulate_pairs(self._nodes, self._kept, self._empty)

    def innermost_places(self, birth_places: IntArray) -> IntArray:
        """Return a cell in each region of empty cells that is never filled, shape (r,).

        Parameters
        ----------
        birth_places
            Places where the classes of the highest dimension begin, see `pairs`, shape (r,).
        """
        pairs = find_enclosed(self._nodes, self._empty)
        cell_of = dict(
            zip(*(pairs[f"{e}_place"].tolist() for e in ("birth", "death")), strict=True)
        )
        return np.array([cell_of[place] for place in birth_places.tolist()], dtype=np.int64)

    def values_at_places(self) -> Multiples:
        """Return the clamped multiples of the places of `pairs`, shape ``2 n + 1``."""
        return self._nodes[(slice(MARGIN, -MARGIN),) * self._nodes.ndim]

    @cached_property
    def diagonal(self) -> pd.DataFrame:
        """Number of pairs with persistence 0, by `dimension` and `birth`."""
        return count_on_diagonal(self._nodes, self.pairs)

    @cached_property
    def persistence_by_cell(self) -> tuple[FloatArray, FloatArray]:
        """Persistence of the classes that every cell creates and destroys, shape n each.

        See `tusqh.topology.curves.persistence_by_cell`.
        """
        return persistence_by_cell(self._nodes, self._kept, self._empty)

    def betti_at(self, threshold: float) -> BettiNumbers:
        """Return the Betti numbers of the filtration at a threshold in (0, 1].

        They are read off the curves if these are known, and are counted at this level alone if not.

        Parameters
        ----------
        threshold
            Volume fraction, dimensionless.
        """
        if "curves" in self.__dict__:
            return betti_at(self.curves, threshold)
        nodes = clamp_at_level(self.multiples, math.ceil(threshold / RESOLUTION))
        return count_at_level(nodes, 1)

    def require_agreement(self, *, name: str) -> None:
        """Raise an error if pairs and curves, two independent counts, differ.

        Parameters
        ----------
        name
            The model, for the message.

        Raises
        ------
        TopologyError
            They differ at a threshold, which is a fault of tusqh.
        """
        require_agreement(self.pairs, self.curves, name=name)

    @cached_property
    def _nodes(self) -> Multiples:
        return clamp_multiples(self.multiples)

    @cached_property
    def _kept(self) -> Merges:
        """Components of the kept nodes."""
        return merge_components(self._nodes)

    @cached_property
    def _empty(self) -> Merges:
        """Components of the other nodes, which are the holes or voids and the outside."""
        return merge_components(complement(self._nodes))
