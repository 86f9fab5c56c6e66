"""The kept cells of a grid in slabs, with the decisions at their contacts.

They are held as a whole, since a cell and a sub-cell take one byte and one bit: one vote is one
comparison with the threshold, so no fractions are needed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from tusqh.antialias.bridges import bridge_columns
from tusqh.antialias.cells import CellSet
from tusqh.antialias.components import FEATURE_COLUMNS
from tusqh.contacts.material_fractions import FULL
from tusqh.contacts.one_material import MATERIAL, VOID, thresholds_of
from tusqh.contacts.one_material_contacts import find_contacts
from tusqh.contacts.spatial import SpatialDecision, decide_sticks
from tusqh.errors import TopologyError
from tusqh.grid import BackgroundGrid, IntArray
from tusqh.grid.slabs import PackedBits
from tusqh.pipeline.slabs.fractions import Survey
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.clamping import clamp_present
from tusqh.topology.one_level import count_at_level


@dataclass(frozen=True)
class AtThreshold:
    """Fractions that are 1 where those of a grid are at least the threshold, otherwise 0.

    They decide every vote as the fractions themselves do.

    Parameters
    ----------
    grid
        The background grid.
    is_interior
        Whether each place of the doubled grid is at least the threshold.
    """

    grid: BackgroundGrid
    is_interior: PackedBits

    @property
    def void(self) -> int:
        """The label of the void."""
        return VOID

    def multiples_at(self, places: IntArray, labels: NDArray[np.int32]) -> IntArray:
        """Return fractions as `tusqh.contacts.votes.Fractions.multiples_at` does.

        Parameters
        ----------
        places
            Flat places of the doubled grid, shape (r,).
        labels
            `MATERIAL` or `VOID`, shape (r, c).
        """
        is_material = self.is_interior.flat(places)[:, None]
        return np.where((labels == MATERIAL) == is_material, FULL, 0)


@dataclass(frozen=True)
class SlabCells(CellSet):
    """The cells of a threshold in slabs.

    Parameters
    ----------
    survey
        What a pass over the fractions found.
    """

    survey: Survey | None = None

    @classmethod
    def of(cls, survey: Survey, name: str) -> SlabCells:
        """Return the kept cells of a survey with the votes at their contacts.

        Parameters
        ----------
        survey
            What a pass over the fractions found.
        name
            The model, for messages.

        Raises
        ------
        TopologyError
            No cell is kept.
        """
        if not survey.kept.any():
            raise TopologyError(
                f"no cell has a fraction of at least {survey.threshold:g}",
                where=name,
                expected="some cells to keep",
                remedy="lower the threshold, or use smaller cells",
            )
        return cls(
            threshold=survey.threshold,
            kept=survey.kept,
            contacts=find_contacts(survey.kept, survey.is_interior),
            fractions=None,  # type: ignore[arg-type]
            bridges=[],
            bridge_table=pd.DataFrame(columns=bridge_columns(3)),
            features=pd.DataFrame(columns=[*FEATURE_COLUMNS, *"xyz"]),
            survey=survey,
        )

    @cached_property
    def decision(self) -> SpatialDecision:
        """The templates that realise the votes of all contacts."""
        assert self.survey is not None
        fractions = AtThreshold(self.survey.grid, self.survey.is_interior)
        return decide_sticks(fractions, self.labels, thresholds_of(self.threshold))

    @cached_property
    def raw(self) -> BettiNumbers:
        """Betti numbers of the filtration at the threshold, counted without the contacts."""
        assert self.survey is not None
        bits = self.survey.is_interior
        return count_at_level(clamp_present(bits.rows(0, bits.shape[0])), 1)
