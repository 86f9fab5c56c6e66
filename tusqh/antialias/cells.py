"""The cells kept at a threshold, with every decision made, and the topology they must have."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.antialias.bridges import ACCEPTED, Bridge, join_components
from tusqh.antialias.clusters import CONNECT, NONE, SEPARATE, Decisions, decide_by_fraction
from tusqh.antialias.components import COLUMNS, drop_features
from tusqh.antialias.pinches import find_pinches
from tusqh.errors import TopologyError
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Policy
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.curves import persistence_by_cell
from tusqh.topology.effective import effective_betti, label_components


@dataclass(frozen=True)
class CellSet:
    """The cells kept at a threshold, with all decisions made and small features gone.

    Parameters
    ----------
    threshold
        Volume-fraction threshold, dimensionless.
    kept
        Kept cells, shape n.
    decisions
        Decisions at the pinches of `kept`; the counts are those before features went.
    bridges
        Paths along which strips join components.
    bridge_table
        One row per bridge, accepted or not, see `tusqh.antialias.bridges.join_components`.
    dropped
        One row per removed component and filled hole, see
        `tusqh.antialias.components.drop_features`.
    predicted
        Betti numbers that the mesh of these cells must have.
    """

    threshold: float
    kept: BoolArray
    decisions: Decisions
    bridges: list[Bridge]
    bridge_table: pd.DataFrame
    dropped: pd.DataFrame
    predicted: BettiNumbers

    @property
    def n_bridges(self) -> int:
        """Number of bridges in the mesh, pinches among them."""
        return int((self.bridge_table["status"] == ACCEPTED).sum())

    def count_dropped(self, feature: str) -> int:
        """Return how many components were removed, or holes or voids filled."""
        return int((self.dropped["feature"] == feature).sum())

    def with_bridges(self, bridges: list[Bridge], table: pd.DataFrame) -> CellSet:
        """Return the cells with other bridges, predicted anew."""
        predicted = predict(self.kept, self.decisions, bridges)
        return replace(self, bridges=bridges, bridge_table=table, predicted=predicted)


class CellSets:
    """The cell set of every threshold.

    Parameters
    ----------
    fractions
        Volume fractions of cells and sub-cells.
    policy
        What to do about pinches, archipelagos and small features.

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

    def __init__(self, fractions: VolumeFractions, policy: Policy | None = None) -> None:
        self.fractions = fractions
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
    def levels(self) -> FloatArray:
        """Distinct fractions at which the cell set may change, in (0, 1], from high to low."""
        fractions = self.fractions
        if self.policy.bridges == "none" and fractions.grid.dim == 2:  # Edges play no part.
            values = np.concatenate([fractions.cells.ravel(), fractions.vertices.ravel()])
        else:
            values = fractions.values.ravel()
        levels = np.unique(values)
        return np.asarray(levels[(levels > 0) & (levels <= 1)][::-1])

    def at(self, threshold: float) -> CellSet:
        """Return the cells at a threshold in (0, 1], their decisions and predicted topology.

        Pinches are decided once, on all cells; then archipelagos are joined, small components
        removed and small holes filled.
        """
        fractions, policy = self.fractions, self.policy
        kept = fractions.cells >= threshold
        decisions = decide_by_fraction(
            kept, fractions.values, threshold=threshold, mixed_pinches=policy.mixed_pinches
        )
        at_vertex, bridges, table = join_components(
            kept,
            decisions.at_vertex,
            fractions.values,
            fractions.grid,
            threshold=threshold,
            mode=policy.bridges,
        )
        dropped = []
        if not policy.components.keeps_all:
            labels = _label_with_bridges(kept, at_vertex == CONNECT, bridges)
            lives = self._persistence[0]
            is_gone, rows = drop_features(
                labels,
                policy.components,
                fractions,
                lives,
                threshold=threshold,
                feature="component",
            )
            kept = kept & ~is_gone
            dropped.append(rows)
        enclosed = policy.holes if kept.ndim == 2 else policy.voids
        if not enclosed.keeps_all:
            at_vertex = _at_pinches_of(kept, at_vertex)
            labels, _ = label_components(~np.pad(kept, 1), np.pad(at_vertex == SEPARATE, 1))
            labels[labels == labels.flat[0]] = 0  # Everything outside is no hole.
            is_gone, rows = drop_features(
                labels[(slice(1, -1),) * kept.ndim],
                enclosed,
                fractions,
                self._persistence[1],
                threshold=threshold,
                feature="hole" if kept.ndim == 2 else "void",
            )
            kept = kept | is_gone
            dropped.append(rows)
        if dropped:
            bridges = [b for b in bridges if _is_there(b, kept)]
        decisions = replace(decisions, at_vertex=_at_pinches_of(kept, at_vertex))
        return CellSet(
            threshold=threshold,
            kept=kept,
            decisions=decisions,
            bridges=bridges,
            bridge_table=table,
            dropped=pd.concat(dropped) if dropped else _no_rows(fractions),
            predicted=predict(kept, decisions, bridges),
        )

    @cached_property
    def _persistence(self) -> tuple[FloatArray, FloatArray]:
        """Persistence of the components and of the holes or voids of every cell."""
        return persistence_by_cell(self.fractions.values)


def predict(kept: BoolArray, decisions: Decisions, bridges: list[Bridge]) -> BettiNumbers:
    """Return the Betti numbers of kept cells with decided pinches and bridges.

    A bridge that joins two components lowers ``betti_0`` by one; one between parts that are
    joined already makes a hole.
    """
    at_vertex = decisions.at_vertex
    without = effective_betti(kept, at_vertex == CONNECT, at_vertex == SEPARATE)
    if not bridges:
        return without
    labels = _label_with_bridges(kept, at_vertex == CONNECT, bridges)
    betti_0 = len(np.unique(labels[labels > 0]))
    n_more_holes = len(bridges) - (without.betti_0 - betti_0)
    return BettiNumbers(betti_0, without.betti_1 + n_more_holes, without.betti_2)


def _label_with_bridges(kept: BoolArray, connects: BoolArray, bridges: list[Bridge]) -> IntArray:
    """Return the component of every cell, from 1, those that bridges join as one."""
    labels, n_components = label_components(kept, connects)
    if not bridges:
        return labels
    pairs = labels.ravel()[np.stack([bridge.cells for bridge in bridges])]
    graph = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(n_components + 1,) * 2)
    _, joined = connected_components(graph, directed=False)
    return np.asarray(joined[labels], dtype=np.int64)  # Label 0 stays alone and first.


def _at_pinches_of(
    kept: BoolArray, at_vertex: np.ndarray[tuple[int, ...], np.dtype[np.int8]]
) -> np.ndarray[tuple[int, ...], np.dtype[np.int8]]:
    """Return the decisions at those vertices that still are pinches."""
    return np.where(find_pinches(kept), at_vertex, NONE).astype(np.int8)


def _is_there(bridge: Bridge, kept: BoolArray) -> bool:
    """Return whether both ends of a bridge are kept and the way between them is empty."""
    if not kept.ravel()[bridge.cells].all():
        return False
    steps = np.diff(bridge.vertices, axis=0)
    left = np.stack([-steps[:, 1], steps[:, 0]], axis=1)
    beside = bridge.vertices[:-1] + (steps + left - 1) // 2
    return not kept[tuple(beside.T)].any()


def _no_rows(fractions: VolumeFractions) -> pd.DataFrame:
    """Return the empty table of dropped features."""
    return pd.DataFrame(columns=[*COLUMNS, *"xyz"[: fractions.grid.dim]])
