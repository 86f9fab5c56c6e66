"""Choose the threshold at which only persistent features are present."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.local_topology.move import approach
from tusqh.settings.policy import Policy
from tusqh.threshold.by_volume import choose_by_volume
from tusqh.threshold.candidates import CHOSEN, DISAGREES, list_plateaus, rank_candidates, try_cells
from tusqh.threshold.describe_choice import describe_choice, describe_rank
from tusqh.threshold.errors import no_threshold_alone, unreachable_persistence
from tusqh.threshold.first_verified import find_first_verified
from tusqh.threshold.plateaus import BETTI, Plateaus
from tusqh.threshold.selection import Selection
from tusqh.topology.persistence import count_alive

#: Largest number of thresholds that are meshed to remove and fill short-lived features.
REMOVAL_TRIALS = 10


def choose_by_persistence(
    plateaus: Plateaus,
    persistence: float,
    *,
    matches_volume: bool = False,
    base: float | None = None,
    name: str,
) -> tuple[Selection, pd.DataFrame]:
    """Return a threshold at which only long-lived features remain.

    If there is a threshold without short-lived features, it is chosen; otherwise exactly the
    short-lived features are removed and filled, at the threshold where they are fewest.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold.
    persistence
        Smallest persistence that a feature must have.
    matches_volume
        Whether to choose, among all thresholds without short-lived features, the one whose mesh has
        the volume nearest to that of the geometry.
    base
        The threshold whose cells are kept except where the topology needs others, see
        `tusqh.local_topology.move`; None: the chosen threshold keeps its own cells.
    name
        The model, for messages.

    Returns
    -------
    selection, candidates
        See `tusqh.threshold.choose.choose_threshold`.

    Raises
    ------
    TopologyError
        Neither way succeeds, or the volume is to be matched and no threshold alone suffices.
    """
    topology = plateaus.cell_sets.topology
    wanted = f"only features with persistence >= {persistence:g}"
    is_short = topology.pairs["persistence"] < persistence
    thresholds = plateaus.table["threshold"].to_numpy()
    short = count_alive(topology.pairs[is_short], thresholds)
    long = count_alive(topology.pairs[~is_short], thresholds)
    is_free = (short.sum(axis=1) == 0) & (plateaus.table["cells"] > 0).to_numpy()
    if matches_volume:
        if not is_free.any():
            raise no_threshold_alone(wanted, name)
        return choose_by_volume(plateaus, is_free, also=wanted, base=base, name=name)
    chosen = _without_short_features(plateaus, is_free, wanted, base, name)
    if chosen is not None:
        return chosen
    counted = plateaus.table.assign(n_short=short.sum(axis=1), n_short_holes=short[:, 1])
    counted[[f"long_{betti}" for betti in BETTI]] = long
    chosen = _by_removing_them(plateaus, counted, persistence, wanted, base, name)
    if chosen is None:
        raise unreachable_persistence(plateaus.table, wanted, name)
    return chosen


def _without_short_features(
    plateaus: Plateaus, is_free: np.ndarray, wanted: str, base: float | None, name: str
) -> tuple[Selection, pd.DataFrame] | None:
    """Return the choice of a threshold without short-lived features."""
    candidates = rank_candidates(plateaus.table, pd.Series(is_free), base=base)
    found = find_first_verified(approach(plateaus.cell_sets, base), candidates, name=name)
    if found is None:
        return None
    row, trial = found
    selection = describe_choice(
        plateaus,
        row,
        trial.cells,
        wanted=wanted,
        reason=describe_rank(row, candidates, "nothing shorter-lived", base),
        resolved=trial.resolved,
    )
    return selection, candidates


def _by_removing_them(
    plateaus: Plateaus,
    counted: pd.DataFrame,
    persistence: float,
    wanted: str,
    base: float | None,
    name: str,
) -> tuple[Selection, pd.DataFrame] | None:
    """Return the choice of a threshold at which exactly the short-lived features are removed."""
    cell_sets = plateaus.cell_sets
    in_plane = cell_sets.fractions.grid.dim == 2
    policy = _removing_policy(cell_sets.policy, persistence, in_plane=in_plane)
    cut_sets = approach(CellSets(cell_sets.fractions, policy, topology=cell_sets.topology), base)
    # Holes in 3D cannot be filled, so none of them may be short-lived.
    is_usable = (counted["cells"] > 0) & (in_plane | (counted["n_short_holes"] == 0))
    tried = counted[is_usable].sort_values(["n_short", "width"], ascending=[True, False])
    tried = tried.head(REMOVAL_TRIALS).reset_index(drop=True)
    candidates = list_plateaus(tried[plateaus.table.columns])
    expected = tried[[f"long_{betti}" for betti in BETTI]].to_numpy()
    for index, threshold in enumerate(tried["threshold"].to_numpy()):
        cells = cut_sets.at(threshold)
        if cells.kept.any() and tuple(cells.predicted) == tuple(expected[index]):
            trial = try_cells(cells, cell_sets.fractions.grid, name=name)
            if trial.is_verified:
                candidates.loc[index, "status"] = CHOSEN
                selection = describe_choice(
                    plateaus,
                    candidates.iloc[index],
                    cells,
                    wanted=wanted,
                    reason=f"no threshold does it alone; here {cells.n_removed} components were "
                    f"removed and {cells.n_filled} holes or voids filled",
                    policy=policy,
                    resolved=trial.resolved,
                )
                return selection, candidates
        candidates.loc[index, "status"] = DISAGREES
    return None


def _removing_policy(policy: Policy, persistence: float, *, in_plane: bool) -> Policy:
    """Return a policy that also removes and fills features with less persistence."""
    return replace(
        policy,
        components=replace(policy.components, min_persistence=persistence),
        holes=replace(policy.holes, min_persistence=persistence if in_plane else 0.0),
        voids=replace(policy.voids, min_persistence=0.0 if in_plane else persistence),
    )
