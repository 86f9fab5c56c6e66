"""The cells kept at a threshold, all decisions about them, and the topology they must have."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.antialias.bridges import ACCEPTED, Bridge, join_components, lay_bridges
from tusqh.antialias.components import (
    COMPONENT,
    FEATURE_COLUMNS,
    HOLE,
    VOID,
    find_small_features,
    label_holes,
    label_kept,
)
from tusqh.contacts.decide import Decision, decide_contacts, surround
from tusqh.contacts.one_material import MATERIAL, OneMaterial, thresholds_of
from tusqh.contacts.one_material import VOID as EMPTY
from tusqh.contacts.planar import PlanarDecision, find_pinched
from tusqh.contacts.predict import predict_betti
from tusqh.errors import TopologyError
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Policy
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.topology import Topology


@dataclass(frozen=True)
class CellSet:
    """The cells kept at a threshold, with all decisions made and small features removed or filled.

    Parameters
    ----------
    threshold
        Volume-fraction threshold, dimensionless.
    kept
        Kept cells, shape n.
    decision
        The decisions at the contacts of `kept`, and in 2D the bridges.
    bridges
        Paths of grid edges that join components.
    bridge_table
        One row per bridge, accepted or not, see `tusqh.antialias.bridges.join_components`.
    features
        One row per removed component and filled hole or void, see
        `tusqh.antialias.components.find_small_features`.
    """

    threshold: float
    kept: BoolArray
    decision: Decision
    bridges: list[Bridge]
    bridge_table: pd.DataFrame
    features: pd.DataFrame

    @cached_property
    def predicted(self) -> BettiNumbers:
        """Betti numbers that the mesh of these cells must have.

        A bridge that joins two components lowers ``betti_0`` by one; a bridge within a component
        makes a hole.
        """
        contacts = self.decision.contacts
        without = predict_betti(self.decision.labels, contacts, 2)[MATERIAL]
        if not self.bridges:
            return without
        betti_0 = int(_label_with_bridges(self.decision, self.bridges).max())
        n_more_holes = len(self.bridges) - (without.betti_0 - betti_0)
        return BettiNumbers(betti_0, without.betti_1 + n_more_holes, without.betti_2)

    @property
    def follows_all_votes(self) -> bool:
        """Whether every contact follows its vote, and no feature was changed and no bridge built.

        The mesh then has the Betti numbers of the filtration.
        """
        return self.n_overruled + self.n_bridges + len(self.features) == 0

    @property
    def n_contacts(self) -> int:
        """Number of pinched vertices, and in 3D edges, each of which has one vote."""
        return len(self.decision.contacts)

    @property
    def n_overruled(self) -> int:
        """Number of contacts that do not follow their vote."""
        return self.decision.n_overruled

    @property
    def n_bridges(self) -> int:
        """Number of bridges in the mesh, including pinches."""
        return int((self.bridge_table["status"] == ACCEPTED).sum())

    @property
    def n_removed(self) -> int:
        """Number of components removed."""
        return int((self.features["feature"] == COMPONENT).sum())

    @property
    def n_filled(self) -> int:
        """Number of holes or voids filled."""
        return len(self.features) - self.n_removed


@dataclass(frozen=True)
class _State:
    """Kept cells and decisions between two steps of `CellSets.at`.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    decision
        The decisions at their contacts.
    bridges
        Paths of grid edges that join components.
    features
        Tables of the features removed and filled so far.
    """

    kept: BoolArray
    decision: Decision
    bridges: list[Bridge]
    features: tuple[pd.DataFrame, ...] = ()


class CellSets:
    """The cell set of every threshold.

    Parameters
    ----------
    fractions
        Volume fractions of cells and sub-cells.
    policy
        How to treat archipelagos and small features.
    topology
        The topology of the fractions, if it has already been computed.

    Raises
    ------
    TopologyError
        The policy asks to fill holes in 3D or voids in 2D.

    Examples
    --------
    >>> from tusqh.grid import BackgroundGrid
    >>> values = np.zeros((5, 5))
    >>> values[1, 1] = values[3, 3] = 1.0
    >>> grid = BackgroundGrid(shape=(2, 2), cell_size=1.0, origin=(0.0, 0.0))
    >>> str(CellSets(VolumeFractions.from_values(grid, 4, values)).at(0.5).predicted)
    '(2, 0, 0)'
    """

    def __init__(
        self,
        fractions: VolumeFractions,
        policy: Policy | None = None,
        *,
        topology: Topology | None = None,
    ) -> None:
        self.fractions = fractions
        self.topology = topology or Topology(fractions.multiples)
        self.policy = policy or Policy()
        in_plane = fractions.grid.dim == 2
        wrong = self.policy.voids if in_plane else self.policy.holes
        if not wrong.keeps_all:
            raise TopologyError(
                "`voids` of a 2D model" if in_plane else "`holes` of a 3D model",
                where="criteria for features",
                expected="`holes` in 2D, `voids` in 3D: only these are regions of empty cells",
                remedy="use the other key, or ask for Betti numbers with `target`",
            )

    @cached_property
    def distinct_fractions(self) -> FloatArray:
        """Distinct fractions at which the cell set may change, in (0, 1], from high to low."""
        fractions = self.fractions
        if self.policy.bridges == "none" and fractions.grid.dim == 2:  # Edges play no part.
            values = np.concatenate([fractions.cells.ravel(), fractions.vertices.ravel()])
        else:
            values = fractions.values.ravel()
        levels = np.unique(values)
        return np.asarray(levels[(levels > 0) & (levels <= 1)][::-1])

    def at(self, threshold: float) -> CellSet:
        """Return the cells at a threshold, their decisions and their predicted topology.

        Every contact is decided by its vote; then archipelagos are joined, small components are
        removed, and small holes (in 3D voids) are filled.

        Parameters
        ----------
        threshold
            Volume-fraction threshold in (0, 1], dimensionless.
        """
        kept = self.fractions.cells >= threshold
        joined, bridge_table = self._join_components(kept, threshold)
        done = self._change_features(joined, threshold)
        bridges = [b for b in done.bridges if b.is_needed(done.kept)]
        decision = done.decision
        if isinstance(decision, PlanarDecision) and bridges:
            decision = lay_bridges(decision, bridges)
        return CellSet(
            threshold=threshold,
            kept=done.kept,
            decision=decision,
            bridges=bridges,
            bridge_table=bridge_table,
            features=pd.concat(done.features) if done.features else self._no_features,
        )

    def _decide(self, kept: BoolArray, threshold: float) -> Decision:
        """Return the decisions at all contacts of kept cells, each by its own vote."""
        labels = np.where(kept, MATERIAL, EMPTY).astype(np.int32)
        return decide_contacts(OneMaterial(self.fractions), labels, thresholds_of(threshold))

    def _join_components(self, kept: BoolArray, threshold: float) -> tuple[_State, pd.DataFrame]:
        """Return all cells at a threshold with their archipelagos joined, and the bridges."""
        decision, bridges, table = join_components(
            self._decide(kept, threshold),
            self.fractions.values >= threshold,
            self.fractions.grid,
            mode=self.policy.bridges,
        )
        return _State(kept, decision, bridges), table

    def _change_features(self, state: _State, threshold: float) -> _State:
        """Return the cells without the features that do not meet the criteria.

        In 3D, contacts near a changed feature are decided again, which may in rare cases change
        components, so the steps are repeated until nothing changes.
        """
        while True:
            n_before = len(state.features)
            state = self._remove_components(state, threshold)
            state = self._fill_holes(state, threshold)
            if len(state.features) == n_before or state.kept.ndim == 2:
                return state

    def _remove_components(self, state: _State, threshold: float) -> _State:
        """Return the cells without the components that do not meet the criteria."""
        if self.policy.components.keeps_all:
            return state
        is_small, table = find_small_features(
            _label_with_bridges(state.decision, state.bridges),
            self.policy.components,
            self.fractions,
            self.topology.persistence_by_cell[0],
            threshold=threshold,
            feature=COMPONENT,
        )
        return self._change(state, state.kept & ~is_small, table, threshold)

    def _fill_holes(self, state: _State, threshold: float) -> _State:
        """Return the cells after filling the holes (in 3D voids) that do not meet the criteria."""
        in_plane = state.kept.ndim == 2
        criteria = self.policy.holes if in_plane else self.policy.voids
        if criteria.keeps_all:
            return state
        is_small, table = find_small_features(
            label_holes(state.decision),
            criteria,
            self.fractions,
            self.topology.persistence_by_cell[1],
            threshold=threshold,
            feature=HOLE if in_plane else VOID,
        )
        return self._change(state, state.kept | is_small, table, threshold)

    def _change(
        self, state: _State, kept: BoolArray, table: pd.DataFrame, threshold: float
    ) -> _State:
        """Return a state with other cells and the decisions at the contacts that are left."""
        if len(table) == 0:
            return state
        decision = state.decision
        if isinstance(decision, PlanarDecision):
            labels = surround(np.where(kept, MATERIAL, EMPTY).astype(np.int32), EMPTY)
            ball = np.where(find_pinched(labels), decision.ball, -1).astype(np.int32)
            decision = PlanarDecision(labels, ball)
        else:
            decision = self._decide(kept, threshold)
        return replace(state, kept=kept, decision=decision, features=(*state.features, table))

    @property
    def _no_features(self) -> pd.DataFrame:
        """The empty table of features."""
        return pd.DataFrame(columns=[*FEATURE_COLUMNS, *"xyz"[: self.fractions.grid.dim]])


def _label_with_bridges(decision: Decision, bridges: list[Bridge]) -> IntArray:
    """Return the component of every kept cell, numbered from 1, joined by bridges; shape n."""
    labels = label_kept(decision)
    if not bridges:
        return labels
    pairs = labels.ravel()[np.stack([bridge.cells for bridge in bridges])]
    size = int(labels.max()) + 1
    graph = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(size, size))
    _, joined = connected_components(graph, directed=False)
    return np.asarray(joined[labels], dtype=np.int64)  # Label 0 stays separate and first.
