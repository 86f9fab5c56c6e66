"""The cells kept at a threshold, all decisions about them, and the topology they must have."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.antialias.bridges import ACCEPTED, Bridge, join_components
from tusqh.antialias.clusters import CONNECT, NONE, SEPARATE, Decisions, decide_by_fraction
from tusqh.antialias.components import (
    COMPONENT,
    FEATURE_COLUMNS,
    HOLE,
    VOID,
    find_small_features,
)
from tusqh.antialias.pinches import find_pinches
from tusqh.antialias.strips import Strip
from tusqh.errors import TopologyError
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Policy
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.effective import effective_betti, label_components
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
    decisions
        Decisions at the pinches of `kept`; their counts precede the removal and filling of
        features.
    bridges
        Paths along which strips join components.
    bridge_table
        One row per bridge, accepted or not, see `tusqh.antialias.bridges.join_components`.
    features
        One row per removed component and filled hole or void, see
        `tusqh.antialias.components.find_small_features`.
    predicted
        Betti numbers that the mesh of these cells must have.
    """

    threshold: float
    kept: BoolArray
    decisions: Decisions
    bridges: list[Bridge]
    bridge_table: pd.DataFrame
    features: pd.DataFrame
    predicted: BettiNumbers

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

    def with_bridges(self, bridges: list[Bridge], table: pd.DataFrame) -> CellSet:
        """Return the cells with other bridges, and their predicted Betti numbers.

        Parameters
        ----------
        bridges
            Paths along which strips join components.
        table
            One row per bridge, accepted or not.
        """
        predicted = predict_betti(self.kept, self.decisions.at_vertex, bridges)
        return replace(self, bridges=bridges, bridge_table=table, predicted=predicted)


@dataclass(frozen=True)
class _State:
    """Kept cells and decisions between two steps of `CellSets.at`.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    at_vertex
        Decision at every vertex, shape ``n + 1``.
    bridges
        Paths along which strips join components.
    features
        Tables of the features removed and filled so far.
    """

    kept: BoolArray
    at_vertex: NDArray[np.int8]
    bridges: list[Bridge]
    features: tuple[pd.DataFrame, ...] = ()


class CellSets:
    """The cell set of every threshold.

    Parameters
    ----------
    fractions
        Volume fractions of cells and sub-cells.
    policy
        How to treat pinches, archipelagos and small features.
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

        Pinches are decided once, on all cells; then archipelagos are joined, small components are
        removed, and small holes (in 3D voids) are filled.

        Parameters
        ----------
        threshold
            Volume-fraction threshold in (0, 1], dimensionless.
        """
        decisions = self._decide_pinches(threshold)
        joined, bridge_table = self._join_components(decisions.at_vertex, threshold)
        done = self._fill_holes(self._remove_components(joined, threshold), threshold)
        at_vertex = _at_pinches_of(done.kept, done.at_vertex)
        bridges = [b for b in done.bridges if _is_still_needed(b, done.kept)]
        return CellSet(
            threshold=threshold,
            kept=done.kept,
            decisions=replace(decisions, at_vertex=at_vertex),
            bridges=bridges,
            bridge_table=bridge_table,
            features=pd.concat(done.features) if done.features else self._no_features(),
            predicted=predict_betti(done.kept, at_vertex, bridges),
        )

    def _decide_pinches(self, threshold: float) -> Decisions:
        """Return the decision at every pinch of all cells at a threshold."""
        return decide_by_fraction(
            self.fractions.cells >= threshold,
            self.fractions.values,
            threshold=threshold,
            mixed_pinches=self.policy.mixed_pinches,
        )

    def _join_components(
        self, at_vertex: NDArray[np.int8], threshold: float
    ) -> tuple[_State, pd.DataFrame]:
        """Return all cells at a threshold with their archipelagos joined, and the bridges."""
        kept = self.fractions.cells >= threshold
        at_vertex, bridges, table = join_components(
            kept,
            at_vertex,
            self.fractions.values,
            self.fractions.grid,
            threshold=threshold,
            mode=self.policy.bridges,
        )
        return _State(kept, at_vertex, bridges), table

    def _remove_components(self, state: _State, threshold: float) -> _State:
        """Return the cells without the components that do not meet the criteria."""
        if self.policy.components.keeps_all:
            return state
        labels = _label_with_bridges(state.kept, state.at_vertex == CONNECT, state.bridges)
        is_small, table = find_small_features(
            labels,
            self.policy.components,
            self.fractions,
            self.topology.persistence_by_cell[0],
            threshold=threshold,
            feature=COMPONENT,
        )
        kept = state.kept & ~is_small
        return replace(state, kept=kept, features=(*state.features, table))

    def _fill_holes(self, state: _State, threshold: float) -> _State:
        """Return the cells after filling the holes (in 3D voids) that do not meet the criteria."""
        in_plane = state.kept.ndim == 2
        criteria = self.policy.holes if in_plane else self.policy.voids
        if criteria.keeps_all:
            return state
        at_vertex = _at_pinches_of(state.kept, state.at_vertex)
        # A further layer of empty cells joins everything outside into one component, the first.
        labels, _ = label_components(~np.pad(state.kept, 1), np.pad(at_vertex == SEPARATE, 1))
        labels[labels == labels.flat[0]] = 0
        is_small, table = find_small_features(
            labels[(slice(1, -1),) * state.kept.ndim],
            criteria,
            self.fractions,
            self.topology.persistence_by_cell[1],
            threshold=threshold,
            feature=HOLE if in_plane else VOID,
        )
        kept = state.kept | is_small
        return replace(state, kept=kept, at_vertex=at_vertex, features=(*state.features, table))

    def _no_features(self) -> pd.DataFrame:
        """Return the empty table of features."""
        return pd.DataFrame(columns=[*FEATURE_COLUMNS, *"xyz"[: self.fractions.grid.dim]])


def predict_betti(
    kept: BoolArray, at_vertex: NDArray[np.int8], bridges: list[Bridge]
) -> BettiNumbers:
    """Return the Betti numbers of kept cells with decided pinches and bridges.

    A bridge that joins two components lowers ``betti_0`` by one; a bridge within a component
    makes a hole.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    at_vertex
        `SEPARATE`, `NONE` or `CONNECT` for every grid vertex, shape ``n + 1``.
    bridges
        Paths along which strips join components.
    """
    without = effective_betti(kept, at_vertex == CONNECT, at_vertex == SEPARATE)
    if not bridges:
        return without
    labels = _label_with_bridges(kept, at_vertex == CONNECT, bridges)
    betti_0 = len(np.unique(labels[labels > 0]))
    n_more_holes = len(bridges) - (without.betti_0 - betti_0)
    return BettiNumbers(betti_0, without.betti_1 + n_more_holes, without.betti_2)


def _label_with_bridges(kept: BoolArray, connects: BoolArray, bridges: list[Bridge]) -> IntArray:
    """Return the component of every cell, numbered from 1; bridges join components."""
    labels, n_components = label_components(kept, connects)
    if not bridges:
        return labels
    pairs = labels.ravel()[np.stack([bridge.cells for bridge in bridges])]
    graph = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(n_components + 1,) * 2)
    _, joined = connected_components(graph, directed=False)
    return np.asarray(joined[labels], dtype=np.int64)  # Label 0 stays separate and first.


def _at_pinches_of(kept: BoolArray, at_vertex: NDArray[np.int8]) -> NDArray[np.int8]:
    """Return the decisions at those vertices that are still pinches."""
    return np.where(find_pinches(kept), at_vertex, NONE).astype(np.int8)


def _is_still_needed(bridge: Bridge, kept: BoolArray) -> bool:
    """Return whether both ends of a bridge are kept and all cells along its path are empty."""
    if not kept.ravel()[bridge.cells].all():
        return False
    return not any(kept[tuple(cells.T)].any() for cells in Strip.along(bridge.vertices).beside)
