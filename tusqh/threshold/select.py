"""The choice of a threshold, and the loop that proves it: predict, mesh, measure, or go on.

Algorithm 3.  A user fixes the threshold, or asks for Betti numbers, for features that live
long, or for the volume of the geometry.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSet, CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.errors import TopologyError
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.jacobians import element_volumes
from tusqh.settings.goal import Goal, Target
from tusqh.threshold.goals import distances, is_met, matches
from tusqh.threshold.plateaus import BETTI, list_reachable, merge_intervals
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.curves import betti_curves
from tusqh.topology.persistence import DIAGRAM_CELLS, betti_at, count_alive, paired_dimensions

CHOSEN, NOT_TRIED, DISAGREES = "chosen", "not tried", "measurement disagrees"

#: So many thresholds, nearest by the volume of their cells, are meshed to match a volume.
VOLUME_TRIALS = 10


@dataclass(frozen=True)
class Selection:
    """A threshold, why it was chosen, and how robust the choice is.

    Parameters
    ----------
    threshold
        Dimensionless, in (0, 1].
    lower, upper
        Every examined threshold ``t`` with ``lower < t <= upper`` has the same Betti numbers.
    margin
        Distance of the threshold to the nearer end of that interval.
    cell_margin
        Distance to the nearest fraction of a cell or sub-cell, where the cells may change.
    unexamined
        Width within the interval that no examined plateau covers.
    wanted
        What was asked for, in words.
    raw
        Betti numbers of the filtration, where every pinch follows its own sub-cell.
    predicted
        Betti numbers that the mesh will have.
    reason
        One sentence for people.
    without_features
        The thresholds that give the same Betti numbers with no feature removed or filled, in
        words; empty where none does, or where the choice needs none of it.
    policy
        What to do about pinches and small features, for `Policy.from_dict`.
    """

    threshold: float
    lower: float
    upper: float
    margin: float
    cell_margin: float
    unexamined: float
    wanted: str
    raw: BettiNumbers
    predicted: BettiNumbers
    reason: str
    without_features: str
    policy: dict[str, Any]

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Selection:
        """Return the selection that `dataclasses.asdict` described, for instance from JSON."""
        numbers = {key: BettiNumbers(*values[key]) for key in ("raw", "predicted")}
        return cls(**{**values, **numbers})


def choose_threshold(
    cell_sets: CellSets,
    predicted: pd.DataFrame,
    *,
    pairs: pd.DataFrame | None = None,
    goal: Goal | None = None,
    name: str = "model",
) -> tuple[Selection, pd.DataFrame]:
    """Return the threshold that a configuration asks for, and all candidates.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    predicted
        Plateaus with predicted Betti numbers, see `tusqh.threshold.plateaus.predict_plateaus`.
    pairs
        Persistence pairs; needed where the goal is a persistence.
    goal
        How the threshold is chosen; None: 1/2.
    name
        The model, for messages.

    Returns
    -------
    selection
        The choice.
    candidates
        Intervals in the order in which they are tried, with width, margin and `status`.

    Raises
    ------
    TopologyError
        Nothing gives what is wanted; the message lists what is reachable.
    """
    goal = goal or Goal()
    if goal.target is not None:
        return _by_target(cell_sets, predicted, goal.target, name)
    if goal.persistence is not None:
        if pairs is None:
            raise ValueError("a goal of persistence needs the persistence pairs")
        return _by_persistence(cell_sets, predicted, pairs, goal.persistence, name)
    if goal.volume is not None:
        return _by_volume(cell_sets, predicted, name)
    assert goal.threshold is not None  # `Goal` fills it in.
    return _fixed(cell_sets, predicted, goal.threshold, name)


def rank_candidates(predicted: pd.DataFrame, is_wanted: pd.Series) -> pd.DataFrame:
    """Return the intervals of wanted plateaus, the widest first, then the closest to 1/2.

    Examples
    --------
    >>> predicted = pd.DataFrame({
    ...     "upper": [1.0, 0.5, 0.4], "lower": [0.5, 0.4, 0.0], "width": [0.5, 0.1, 0.4],
    ...     "threshold": [0.75, 0.45, 0.2], "cells": 1,
    ...     "betti_0": [1, 2, 1], "betti_1": 0, "betti_2": 0})
    >>> ranked = rank_candidates(predicted, predicted["betti_0"] == 1)
    >>> ranked[["rank", "threshold", "status"]].values.tolist()
    [[1, 0.75, 'not tried'], [2, 0.2, 'not tried']]
    """
    intervals = merge_intervals(predicted, is_wanted)
    order = np.lexsort([(intervals["threshold"] - 0.5).abs(), -intervals["width"]])
    ranked = intervals.iloc[order].reset_index(drop=True)
    ranked.insert(0, "rank", np.arange(1, len(ranked) + 1))
    ranked["status"] = NOT_TRIED
    return ranked


def _by_target(
    cell_sets: CellSets, predicted: pd.DataFrame, target: Target, name: str
) -> tuple[Selection, pd.DataFrame]:
    candidates = rank_candidates(predicted, pd.Series(matches(predicted, target)))
    chosen = _first_verified(cell_sets, candidates, target, name)
    if chosen is not None:
        row, cells = chosen
        reason = (
            f"number {row['rank']} of {len(candidates)} intervals with {target}: "
            f"{row['lower']:.4g} < t <= {row['upper']:.4g}"
        )
        return _selection(cell_sets, predicted, row, cells, str(target), reason), candidates
    shown = predicted[predicted["cells"] > 0]
    nearest = "none"
    if len(shown):
        row = shown.iloc[int(distances(shown, target).argmin())]
        nearest = ", ".join(f"{key} = {row[key]:.0f}" for key in target.given())
    raise TopologyError(
        f"no threshold gives {target}",
        where=name,
        expected="Betti numbers that some threshold reaches:\n" + list_reachable(predicted),
        remedy=f"ask for one of these (nearest: {nearest}), or change the grid, or the criteria "
        "for `components` and `holes`",
    )


def _by_persistence(
    cell_sets: CellSets,
    predicted: pd.DataFrame,
    pairs: pd.DataFrame,
    persistence: float,
    name: str,
) -> tuple[Selection, pd.DataFrame]:
    wanted = f"only features with persistence >= {persistence:g}"
    if 1 not in paired_dimensions(cell_sets.fractions.values.shape):
        raise TopologyError(
            "`persistence` on a 3D grid of that many cells",
            where=name,
            expected=f"at most {DIAGRAM_CELLS} cells, for which the persistence of holes is known",
            remedy="use a coarser grid, or ask for Betti numbers with `target`",
        )
    thresholds = predicted["threshold"].to_numpy()
    short = count_alive(pairs[pairs["persistence"] < persistence], thresholds)
    is_wanted = (short.sum(axis=1) == 0) & (predicted["cells"] > 0).to_numpy()
    candidates = rank_candidates(predicted, pd.Series(is_wanted))
    chosen = _first_verified(cell_sets, candidates, Target(), name)
    if chosen is not None:
        row, cells = chosen
        reason = (
            f"nothing shorter-lived is there for {row['lower']:.4g} < t <= {row['upper']:.4g}, "
            f"number {row['rank']} of {len(candidates)} such intervals"
        )
        return _selection(cell_sets, predicted, row, cells, wanted, reason), candidates
    # No threshold does it: remove and fill exactly those features where they are fewest.
    in_plane = cell_sets.fractions.grid.dim == 2
    policy = replace(
        cell_sets.policy,
        components=replace(cell_sets.policy.components, min_persistence=persistence),
        holes=replace(cell_sets.policy.holes, min_persistence=persistence if in_plane else 0.0),
        voids=replace(cell_sets.policy.voids, min_persistence=0.0 if in_plane else persistence),
    )
    cut_sets = CellSets(cell_sets.fractions, policy)
    longer = count_alive(pairs[pairs["persistence"] >= persistence], thresholds)
    usable = (predicted["cells"] > 0).to_numpy() & (in_plane | (short[:, 1] == 0))
    order = np.lexsort([-predicted["width"].to_numpy(), short.sum(axis=1)])
    tried = predicted.iloc[order[usable[order]]].reset_index(drop=True).head(VOLUME_TRIALS)
    candidates = _as_candidates(tried)
    for k, row in candidates.iterrows():
        cells = cut_sets.at(row["threshold"])
        expected = BettiNumbers(*longer[order[usable[order]][int(str(k))]].tolist())
        if (
            cells.kept.any()
            and cells.predicted == expected
            and _is_verified(cells, cut_sets, Target(), name)
        ):
            candidates.loc[[k], "status"] = CHOSEN
            n_removed = cells.n_removed
            reason = (
                f"no threshold does it alone; here {n_removed} components were removed and "
                f"{cells.n_filled} holes or voids filled"
            )
            return _selection(cut_sets, predicted, row, cells, wanted, reason), candidates
        candidates.loc[[k], "status"] = DISAGREES
    raise TopologyError(
        f"no threshold leaves {wanted}, and removing and filling does not either",
        where=name,
        expected="features that can be told apart by their persistence",
        remedy="lower `persistence`, or ask for Betti numbers with `target`:\n"
        + list_reachable(predicted),
    )


def _by_volume(
    cell_sets: CellSets, predicted: pd.DataFrame, name: str
) -> tuple[Selection, pd.DataFrame]:
    fractions = cell_sets.fractions
    wanted = fractions.volume()
    of_cells = predicted["cells"] * fractions.grid.cell_size**fractions.grid.dim
    shown = predicted.assign(error=(of_cells - wanted).abs())[predicted["cells"] > 0]
    if shown.empty:
        raise _nothing_kept(cell_sets, predicted["threshold"].min(), name)
    candidates = _as_candidates(shown.sort_values("error", kind="stable").head(VOLUME_TRIALS))
    errors = []
    for k, row in candidates.iterrows():
        cells = cell_sets.at(row["threshold"])
        mesh = build_mesh(cells, fractions.grid, name=name).mesh
        errors.append(float(element_volumes(mesh.points, mesh.cells).sum()) / wanted - 1)
        if not _is_verified(cells, cell_sets, Target(), name):
            candidates.loc[[k], "status"] = DISAGREES
    candidates["volume_error"] = errors
    best = int(np.where(candidates["status"] != DISAGREES, np.abs(errors), np.inf).argmin())
    candidates.loc[[best], "status"] = CHOSEN
    row = candidates.iloc[best]
    reason = (
        f"the mesh's volume differs from the winding-number volume by "
        f"{100 * row['volume_error']:+.3g} %, the least of {len(candidates)} thresholds"
    )
    cells = cell_sets.at(row["threshold"])
    words = "the winding-number volume"
    return _selection(cell_sets, predicted, row, cells, words, reason), candidates


def _fixed(
    cell_sets: CellSets, predicted: pd.DataFrame, threshold: float, name: str
) -> tuple[Selection, pd.DataFrame]:
    if not 0 < threshold <= 1:
        raise TopologyError(
            f"the threshold is {threshold}",
            where=name,
            expected="a volume fraction in (0, 1]",
            remedy="use 0.5, or ask for Betti numbers with `target`",
        )
    cells = cell_sets.at(threshold)
    if not cells.kept.any():
        raise _nothing_kept(cell_sets, threshold, name)
    intervals = merge_intervals(predicted)
    numbers = (intervals[BETTI].to_numpy() == cells.predicted).all(axis=1)
    holds = (intervals["lower"] < threshold) & (threshold <= intervals["upper"]) & numbers
    if holds.any():
        row = intervals[holds].iloc[0].copy()
        row["margin"] = min(threshold - row["lower"], row["upper"] - threshold)
    else:  # The plateau of this threshold was not looked at.
        levels = np.concatenate([[1.0], cell_sets.levels, [0.0]])
        upper, lower = levels[levels >= threshold].min(), levels[levels < threshold].max()
        margin = min(threshold - lower, upper - threshold)
        row = pd.Series({"lower": lower, "upper": upper, "margin": margin, "unexamined": 0.0})
    row["threshold"] = threshold
    row["cell_margin"] = float(np.abs(cell_sets.levels - threshold).min())
    candidates = rank_candidates(predicted, predicted["cells"] < 0)
    words = f"the threshold {threshold:g}"
    reason = "given"
    return _selection(cell_sets, predicted, row, cells, words, reason), candidates


def _first_verified(
    cell_sets: CellSets, candidates: pd.DataFrame, target: Target, name: str
) -> tuple[pd.Series, CellSet] | None:
    """Return the first candidate whose mesh measures as wanted; note the outcome in `status`."""
    for k, row in candidates.iterrows():
        cells = cell_sets.at(row["threshold"])
        if _is_verified(cells, cell_sets, target, name):
            candidates.loc[[k], "status"] = CHOSEN
            return row, cells
        candidates.loc[[k], "status"] = DISAGREES
    return None


def _is_verified(cells: CellSet, cell_sets: CellSets, target: Target, name: str) -> bool:
    """Return whether the mesh measures, by both methods, what was predicted and wanted."""
    resolved = build_mesh(cells, cell_sets.fractions.grid, name=name)
    measured = betti_by_euler(resolved.mesh)
    return (
        measured == betti_by_boundary(resolved.mesh) == resolved.cells.predicted
        and resolved.cells.predicted == cells.predicted
        and is_met(measured, target)
    )


def _selection(
    cell_sets: CellSets,
    predicted: pd.DataFrame,
    row: pd.Series,
    cells: CellSet,
    wanted: str,
    reason: str,
) -> Selection:
    threshold = float(row["threshold"])
    raw = betti_at(betti_curves(cell_sets.fractions.values), threshold)
    without = ""
    if len(cells.features):
        untouched = (predicted["removed"] + predicted["filled"] == 0) & matches(
            predicted, Target(**cells.predicted._asdict())
        )
        without = "; ".join(
            f"{interval.lower:.4g} < t <= {interval.upper:.4g}"
            for interval in rank_candidates(predicted, untouched).head(3).itertuples()
        )
    return Selection(
        threshold=threshold,
        lower=float(row["lower"]),
        upper=float(row["upper"]),
        margin=float(row["margin"]),
        cell_margin=float(row["cell_margin"]),
        unexamined=float(row["unexamined"]),
        wanted=wanted,
        raw=raw,
        predicted=cells.predicted,
        reason=reason,
        without_features=without,
        policy=asdict(cell_sets.policy),
    )


def _as_candidates(plateaus: pd.DataFrame) -> pd.DataFrame:
    """Return single plateaus as candidates, in the order given."""
    ranked = plateaus.reset_index(drop=True)
    ranked.insert(0, "rank", np.arange(1, len(ranked) + 1))
    ranked["margin"] = ranked["cell_margin"] = ranked["width"] / 2
    ranked["unexamined"] = 0.0
    ranked["status"] = NOT_TRIED
    return ranked


def _nothing_kept(cell_sets: CellSets, threshold: float, name: str) -> TopologyError:
    largest = cell_sets.fractions.cells.max()
    return TopologyError(
        f"no cell is left at threshold {threshold:g}",
        where=name,
        expected=f"a threshold of at most {largest:.4g}, the largest fraction, and components "
        "that meet the criteria",
        remedy="lower `threshold` or the criteria for `components`, or use a finer grid",
    )
