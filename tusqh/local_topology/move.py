"""Move the cells of one threshold towards those of another without a change of topology.

The *seed* is the set of cells, with all decisions about its contacts, at a threshold with the
wanted topology.  The *base* is the set of cells at a threshold where the geometry is as it should
be.  Cells in which the two differ are added or removed while they are simple, first those whose
fraction is nearest to the threshold of the seed.  What then still differs from the base is what the
topology costs.  Every contact of the result votes at the threshold of the seed.

Cells that touch a bridge stay as they are in the seed, because bridges run through
empty cells.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSet, CellSets
from tusqh.contacts.one_material import MATERIAL
from tusqh.contacts.one_material_contacts import find_contacts
from tusqh.contacts.surround import LAYERS_OF
from tusqh.errors import TopologyError
from tusqh.grid import BoolArray
from tusqh.grid.neighbourhoods import at_corners
from tusqh.local_topology.changes import CHANGE_COLUMNS, tabulate_changes
from tusqh.local_topology.link import link_in
from tusqh.local_topology.simple_cells import change_simple
from tusqh.local_topology.wishes import Wish


@dataclass(frozen=True)
class LocalCells(CellSet):
    """Cells with the topology of a seed that differ from a base only where topology needs it.

    Threshold, bridges and features are those of the seed.

    Parameters
    ----------
    base
        The threshold of the base, in (0, 1].
    in_base
        Kept cells of the base, shape n.
    changes
        One row per group of cells that differ from the base, see
        `tusqh.local_topology.changes.tabulate_changes`.
    n_held
        Number of cells that were not tried because they touch a bridge.
    n_other_contacts
        Number of contacts that would vote otherwise at the threshold of the base.
    wishes
        What was done about single features of the base.
    """

    base: float
    in_base: BoolArray
    changes: pd.DataFrame
    n_held: int
    n_other_contacts: int
    wishes: tuple[Wish, ...] = ()

    @property
    def threshold_of_cells(self) -> float:
        """The threshold of the base, whose cells are kept except for the changes."""
        return self.base

    @property
    def n_changes(self) -> int:
        """Number of cells that differ from the base."""
        return int((self.kept != self.in_base).sum())


class LocalCellSets(CellSets):
    """The cell set of every threshold as a seed, moved to one base.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    base
        The threshold to approach, in (0, 1].
    """

    def __init__(self, cell_sets: CellSets, base: float) -> None:
        super().__init__(cell_sets.fractions, cell_sets.policy, topology=cell_sets.topology)
        self._base_threshold = base

    def at(self, threshold: float) -> LocalCells:
        """Return the cells with the topology of a threshold and the geometry of the base.

        Parameters
        ----------
        threshold
            Volume-fraction threshold of the seed in (0, 1], dimensionless.
        """
        if threshold == self._base_threshold:
            return move_to_base(self._base, self._base)
        return move_to_base(super().at(threshold), self._base)

    @cached_property
    def _base(self) -> CellSet:
        """The cells of the base."""
        return super().at(self._base_threshold)


def approach(cell_sets: CellSets, base: float | None) -> CellSets:
    """Return the cell sets that are moved to a base, or the given ones without a base.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    base
        The threshold to approach, in (0, 1]; None: every threshold keeps its own cells.
    """
    return cell_sets if base is None else LocalCellSets(cell_sets, base)


def changes_of(cells: CellSet) -> pd.DataFrame:
    """Return the table of changes of cells; those without a base have no rows.

    Parameters
    ----------
    cells
        The cells of a mesh.
    """
    if isinstance(cells, LocalCells):
        return cells.changes
    return pd.DataFrame(columns=[*CHANGE_COLUMNS, *"xyz"[: cells.kept.ndim]])


def move_to_base(seed: CellSet, base: CellSet) -> LocalCells:
    """Return cells with the topology of a seed, as near to those of a base as possible.

    Parameters
    ----------
    seed, base
        The cells of two thresholds.

    Raises
    ------
    TopologyError
        The topology changed, which is a fault of Tusqh.

    Examples
    --------
    A gap between two bars is open at 0.75 and closed at 0.5.  Its emptiest cell stays open:

    >>> from tusqh.grid import BackgroundGrid
    >>> from tusqh.sampling.fractions import VolumeFractions
    >>> values = np.zeros((3, 13))
    >>> values[1, 1::2] = [1, 1, 0.7, 0.6, 1, 1]
    >>> grid = BackgroundGrid(shape=(1, 6), cell_size=1.0, origin=(0.0, 0.0))
    >>> cell_sets = CellSets(VolumeFractions.from_values(grid, 4, values))
    >>> found = move_to_base(cell_sets.at(0.75), cell_sets.at(0.5))
    >>> found.kept.astype(int).tolist(), str(found.predicted), found.n_changes
    ([[1, 1, 1, 0, 1, 1]], '(2, 0, 0)', 1)
    """
    votes, fractions = votes_of(seed), seed.fractions
    differs = seed.kept != base.kept
    is_held = differs & touch_bridges(seed)
    kept = _change(seed, differs & ~is_held, votes)
    contacts = find_contacts(kept, votes)
    others = find_contacts(kept, fractions.at_least(base.threshold))
    n_other_contacts = (contacts.ball != others.ball).sum()
    n_other_contacts += (contacts.edge_material != others.edge_material).sum()
    found = LocalCells(
        threshold=seed.threshold,
        kept=kept,
        contacts=contacts,
        fractions=fractions,
        bridges=seed.bridges,
        bridge_table=seed.bridge_table,
        features=seed.features,
        base=base.threshold,
        in_base=base.kept,
        changes=tabulate_changes(kept, base.kept, fractions),
        n_held=int(is_held.sum()),
        n_other_contacts=int(n_other_contacts),
    )
    if found.predicted != seed.predicted:
        raise TopologyError(
            f"Betti numbers {found.predicted} after changes of simple cells",
            where=f"cells of the threshold {seed.threshold:g} moved to {base.threshold:g}",
            expected=f"the Betti numbers {seed.predicted} of the start",
            remedy="this is a fault of tusqh: please report it with fractions.npz",
        )
    return found


def votes_of(seed: CellSet) -> BoolArray:
    """Return which places of the doubled grid vote to connect, shape ``2 n + 1``.

    Parameters
    ----------
    seed
        The cells, with their threshold and bridges.
    """
    votes = seed.fractions.at_least(seed.threshold)
    if votes.ndim == 2:
        # Pinches that are joined as bridges connect against their vote; the third of the cells
        # around a vertex is the one above it, and has its numbers.
        shape = seed.labels.shape
        joined = seed.contacts.vertex_cells[seed.contacts.ball == MATERIAL, 2]
        votes[tuple(2 * (axis - LAYERS_OF[2]) for axis in np.unravel_index(joined, shape))] = True
    return votes


def touch_bridges(seed: CellSet) -> BoolArray:
    """Return the cells that touch a bridge, shape n.

    Parameters
    ----------
    seed
        The cells, with their bridges.
    """
    on_bridge = np.zeros(np.add(seed.kept.shape, 1), dtype=bool)
    for bridge in seed.bridges:
        on_bridge[tuple(bridge.vertices.T)] = True
    return np.asarray(np.logical_or.reduce(at_corners(on_bridge)))


def _change(seed: CellSet, may_change: BoolArray, votes: BoolArray) -> BoolArray:
    """Return the seed's cells after all changes of simple cells among some cells, shape n."""
    kept, votes = np.pad(seed.kept, 1), np.pad(votes, 2)
    cells = np.argwhere(may_change)
    distance = np.abs(seed.fractions.cells[tuple(cells.T)] - seed.threshold)
    cells = cells[np.argsort(distance, kind="stable")] + 1
    flat = np.ravel_multi_index(tuple(cells.T), kept.shape)
    places = np.ravel_multi_index(tuple(2 * cells.T + 1), votes.shape)
    changed = kept.ravel()
    rank = np.full(changed.size, -1, dtype=np.int32)
    change_simple(flat, places, changed, votes.ravel(), link_in(kept.shape, votes.shape), rank)
    return np.asarray(changed.reshape(kept.shape)[(slice(1, -1),) * kept.ndim])
