"""The cells kept at a threshold, all decisions about them, and the topology they must have."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd

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
from tusqh.contacts.decide import Decision
from tusqh.contacts.decided import Contacts, Labels
from tusqh.contacts.one_material import MATERIAL, OneMaterial, thresholds_of
from tusqh.contacts.one_material_contacts import find_contacts, label_cells
from tusqh.contacts.planar import PlanarDecision
from tusqh.contacts.predict import predict_betti
from tusqh.contacts.spatial import decide_sticks
from tusqh.errors import TopologyError
from tusqh.grid import BoolArray, FloatArray, IntArray, doubled
from tusqh.grid.components import label_components
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import BridgeMode, Policy
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.clamping import distinct_levels
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
    contacts
        The contacts of `kept` with the votes that decide them; those that bridges join connect.
    fractions
        Volume fractions of cells and sub-cells.
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
    contacts: Contacts
    fractions: VolumeFractions
    bridges: list[Bridge]
    bridge_table: pd.DataFrame
    features: pd.DataFrame

    @property
    def labels(self) -> Labels:
        """The labels of all cells, see `tusqh.contacts.one_material_contacts.label_cells`."""
        return label_cells(self.kept)

    @cached_property
    def decision(self) -> Decision:
        """The templates that realise the votes of all contacts, and the bridges."""
        if self.kept.ndim == 3:
            t = thresholds_of(self.threshold)
            paths = [bridge.vertices for bridge in self.bridges]
            material = OneMaterial(self.fractions)
            return decide_sticks(material, self.labels, t, paths=paths, material=MATERIAL)
        return lay_bridges(PlanarDecision.of(self.labels, self.contacts), self.bridges)

    @cached_property
    def predicted(self) -> BettiNumbers:
        """Betti numbers that the mesh of these cells must have.

        A bridge that joins two components lowers ``betti_0`` by one; a bridge within a component
        makes a hole.
        """
        without = predict_betti(self.labels, self.contacts, 2)[MATERIAL]
        if not self.bridges:
            return without
        betti_0 = int(label_with_bridges(self.labels, self.contacts, self.bridges).max())
        n_more_holes = len(self.bridges) - (without.betti_0 - betti_0)
        return BettiNumbers(betti_0, without.betti_1 + n_more_holes, without.betti_2)

    @property
    def threshold_of_cells(self) -> float:
        """The threshold of the kept cells; that of the contacts, `threshold`, may be another."""
        return self.threshold

    @property
    def n_contacts(self) -> int:
        """Number of pinched vertices, and in 3D edges, each of which has one vote."""
        return len(self.contacts)

    @cached_property
    def n_overruled(self) -> int:
        """Number of contacts that the templates do not decide as they vote, which should be 0."""
        found, wanted = self.decision.contacts, self.contacts
        n_vertices = int((found.ball != wanted.ball).sum())
        return n_vertices + int((found.edge_material != wanted.edge_material).sum())

    def forget_decision(self) -> None:
        """Free the memory of `decision`, which is made again if needed; `n_overruled` stays."""
        _ = self.n_overruled
        self.__dict__.pop("decision", None)

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
    """Kept cells between two steps of `CellSets.at`.

    Parameters
    ----------
    threshold
        The threshold.
    kept
        Kept cells, shape n.
    is_interior
        Whether the sub-cells on the doubled grid connect, shape ``2 n + 1``.
    bridges
        Paths of grid edges that join components.
    features
        Tables of the features removed and filled so far.
    """

    threshold: float
    kept: BoolArray
    is_interior: BoolArray
    bridges: list[Bridge]
    features: tuple[pd.DataFrame, ...] = ()

    @cached_property
    def labels(self) -> Labels:
        """The labels of all cells."""
        return label_cells(self.kept)

    @cached_property
    def contacts(self) -> Contacts:
        """The contacts of the cells with their votes."""
        return find_contacts(self.kept, self.is_interior)

    def change(self, kept: BoolArray, table: pd.DataFrame) -> _State:
        """Return the state with other cells, after features were removed or filled."""
        if len(table) == 0:
            return self
        return replace(self, kept=kept, features=(*self.features, table))


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

    @property
    def _bridges(self) -> BridgeMode:
        """Which bridges are built."""
        return self.policy.bridges_in(self.fractions.grid.dim)

    @cached_property
    def distinct_fractions(self) -> FloatArray:
        """Distinct fractions at which the cell set may change, in (0, 1], from high to low."""
        multiples = self.fractions.multiples
        parts = [multiples]
        if self._bridges == "none" and multiples.ndim == 2:  # Edges play no part.
            parts = [multiples[doubled.cells(2)], multiples[doubled.vertices(2)]]
        return np.asarray(distinct_levels(parts)[::-1] * RESOLUTION, dtype=np.float64)

    def follows_filtration(self, raw_betti_0: int) -> bool:
        """Return whether the cells at a threshold have the Betti numbers of the filtration.

        Since every contact follows its vote, they do unless features are changed or bridges built.

        Parameters
        ----------
        raw_betti_0
            Number of components of the filtration at the threshold.
        """
        policy = self.policy
        if not (policy.components.keeps_all and policy.holes.keeps_all and policy.voids.keeps_all):
            return False
        return self._bridges == "none" or raw_betti_0 < 2

    def at(self, threshold: float) -> CellSet:
        """Return the cells at a threshold, their decisions and their predicted topology.

        Every contact is decided by its vote; then archipelagos are joined, small components are
        removed, and small holes (in 3D voids) are filled.

        Parameters
        ----------
        threshold
            Volume-fraction threshold in (0, 1], dimensionless.
        """
        joined, bridge_table = self._join_components(threshold)
        done = self._fill_holes(self._remove_components(joined))
        return CellSet(
            threshold=threshold,
            kept=done.kept,
            contacts=done.contacts,
            fractions=self.fractions,
            bridges=[b for b in done.bridges if b.is_needed(done.kept)],
            bridge_table=bridge_table,
            features=pd.concat(done.features) if done.features else self._no_features,
        )

    def _join_components(self, threshold: float) -> tuple[_State, pd.DataFrame]:
        """Return all cells at a threshold with their archipelagos joined, and the bridges."""
        kept = self.fractions.cells_at_least(threshold)
        is_interior = self.fractions.at_least(threshold)
        is_joined, bridges, table = join_components(
            kept, is_interior, self.fractions.grid, mode=self._bridges
        )
        is_interior[doubled.vertices(kept.ndim)] |= is_joined
        return _State(threshold, kept, is_interior, bridges), table

    def _remove_components(self, state: _State) -> _State:
        """Return the cells without the components that do not meet the criteria."""
        if self.policy.components.keeps_all:
            return state
        is_small, table = find_small_features(
            label_with_bridges(state.labels, state.contacts, state.bridges),
            self.policy.components,
            self.fractions,
            self.topology.persistence_by_cell[0],
            threshold=state.threshold,
            feature=COMPONENT,
        )
        return state.change(state.kept & ~is_small, table)

    def _fill_holes(self, state: _State) -> _State:
        """Return the cells after filling the holes (in 3D voids) that do not meet the criteria."""
        in_plane = state.kept.ndim == 2
        criteria = self.policy.holes if in_plane else self.policy.voids
        if criteria.keeps_all:
            return state
        is_small, table = find_small_features(
            label_holes(state.labels, state.contacts),
            criteria,
            self.fractions,
            self.topology.persistence_by_cell[1],
            threshold=state.threshold,
            feature=HOLE if in_plane else VOID,
        )
        return state.change(state.kept | is_small, table)

    @property
    def _no_features(self) -> pd.DataFrame:
        """The empty table of features."""
        return pd.DataFrame(columns=[*FEATURE_COLUMNS, *"xyz"[: self.fractions.grid.dim]])


def label_with_bridges(labels: Labels, contacts: Contacts, bridges: list[Bridge]) -> IntArray:
    """Return the component of every kept cell, numbered from 1, joined by bridges; shape n.

    Parameters
    ----------
    labels, contacts
        See `tusqh.antialias.components.label_kept`.
    bridges
        Paths of grid edges that join components.
    """
    component = label_kept(labels, contacts)
    if not bridges:
        return component
    pairs = component.ravel()[np.stack([bridge.cells for bridge in bridges])]
    size = int(component.max()) + 1
    joined, _ = label_components(pairs[:, 0], pairs[:, 1], size)
    return joined[component]  # Label 0 stays separate and first.
