"""Stage 4: select the threshold that reaches the goal."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.local_topology.features import Features
from tusqh.local_topology.prices import affordable_rows, no_prices, tabulate_prices
from tusqh.progress import Progress, log_progress
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.reference import Reference
from tusqh.settings.goal import Goal
from tusqh.settings.policy import Policy
from tusqh.threshold.choose import choose_threshold
from tusqh.threshold.plateaus import Plateaus
from tusqh.threshold.selection import Selection
from tusqh.topology.topology import Topology

#: Largest number of cells of a grid on which `Choice.prices` lists prices.
MOST_CELLS = 2_500_000


@dataclass(frozen=True)
class Choice:
    """A threshold and everything from which it was chosen.

    Parameters
    ----------
    selection
        The threshold, the reason for its choice, and the robustness of the choice.
    plateaus
        The plateaus of the threshold.
    candidates
        The intervals that reach the goal, ranked.
    """

    selection: Selection
    plateaus: Plateaus
    candidates: pd.DataFrame

    @cached_property
    def prices(self) -> pd.DataFrame:
        """What it costs to change each class of the diagram at the base, by itself.

        The base is that of the local scope or of the features, else the chosen threshold.  On large
        grids only some classes have a price, see `tusqh.local_topology.prices.affordable_rows`, and
        on grids of more than `MOST_CELLS` cells none has.
        """
        chosen = self.selection
        if self.plateaus.cell_sets.fractions.grid.n_cells > MOST_CELLS:
            return no_prices(self.plateaus.cell_sets.fractions.grid.dim)
        base = chosen.threshold if chosen.base is None else chosen.base
        features = Features(self.plateaus.cell_sets, base)
        return tabulate_prices(features, affordable_rows(features))

    @property
    def topologies(self) -> pd.DataFrame:
        """The predicted Betti numbers of the meshes, by plateau of the threshold.

        See `tusqh.threshold.plateaus.Plateaus.table`, which examines all plateaus.
        """
        return self.plateaus.table

    def with_one_threshold(self, goal: Goal, *, name: str) -> Selection:
        """Return what the global scope selects for the same goal, as in the paper.

        Parameters
        ----------
        goal
            How the threshold was chosen.
        name
            The model, for messages.
        """
        if self.selection.base is None:
            return self.selection
        one = replace(goal, scope="global", features=None)
        if self.selection.wishes:  # No threshold needs to give what they do.
            one = Goal(threshold=self.selection.base)
        return choose_threshold(self.plateaus, one, name=name)[0]


def find_plateaus(
    fractions: VolumeFractions,
    topology: Topology | None = None,
    *,
    policy: Policy | None = None,
    reference: Reference | None = None,
    progress: Progress = log_progress,
) -> Plateaus:
    """Return the plateaus of the threshold, whose topologies are predicted when needed.

    Parameters
    ----------
    fractions
        Volume fractions.
    topology
        Their topology, if it has already been computed.
    policy
        How to treat archipelagos and small features; None: with the defaults.
    reference
        The volume that a mesh should have; None: that of the fractions.
    progress
        Shows how many plateaus have been examined.
    """
    cell_sets = CellSets(fractions, policy, topology=topology)
    return Plateaus(cell_sets, reference=reference, progress=progress)


def select(
    fractions: VolumeFractions,
    topology: Topology | None = None,
    *,
    policy: Policy | None = None,
    goal: Goal | None = None,
    reference: Reference | None = None,
    name: str = "model",
    progress: Progress = log_progress,
) -> Choice:
    """Return the threshold that reaches the goal, verified by meshing and measuring.

    Parameters
    ----------
    fractions
        Volume fractions.
    topology
        Their topology, if it has already been computed.
    policy
        How to treat archipelagos and small features; None: with the defaults.
    goal
        How the threshold is chosen; None: 1/2.
    reference
        The volume that the mesh should have; None: that of the fractions.
    name
        The model, for messages.
    progress
        Shows how many plateaus have been examined.

    Raises
    ------
    TopologyError
        No threshold reaches the goal; the message lists the reachable Betti numbers.
    """
    plateaus = find_plateaus(
        fractions, topology, policy=policy, reference=reference, progress=progress
    )
    selection, candidates = choose_threshold(plateaus, goal, name=name)
    return Choice(selection, plateaus, candidates)
