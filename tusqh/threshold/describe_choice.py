"""Make the selection that describes a choice."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSet, CellSets
from tusqh.antialias.resolve import Resolved
from tusqh.local_topology.move import LocalCells
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.fractions import to_level
from tusqh.settings.goal import Target
from tusqh.settings.policy import Policy
from tusqh.threshold.candidates import rank_candidates
from tusqh.threshold.goals import matches
from tusqh.threshold.plateaus import BETTI, Plateaus
from tusqh.threshold.selection import Interval, Selection
from tusqh.threshold.within_interval import describe_place, margin_of
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.clamping import FULL


def describe_choice(
    plateaus: Plateaus,
    row: Mapping[str, float] | pd.Series,
    cells: CellSet,
    *,
    wanted: str,
    reason: str,
    find_interval: Callable[[], Interval] | None = None,
    policy: Policy | None = None,
    resolved: Resolved | None = None,
) -> Selection:
    """Return the selection of a candidate.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold.
    row
        The candidate: `threshold`, `lower`, `upper`, `margin`, `unexamined`.
    cells
        The cells of the candidate.
    wanted, reason
        The request, and why this candidate was chosen, in words.
    find_interval
        Computes `lower`, `upper`, `margin` and `unexamined` for a candidate without them.
    policy
        The settings for small features, if they differ from those of the plateaus.
    resolved
        The mesh, if one was made.
    """
    threshold = float(row["threshold"])
    base = cells.base if isinstance(cells, LocalCells) else None
    cells_lower, cells_upper = same_cells_around(plateaus.cell_sets, threshold)
    return Selection(
        threshold=threshold,
        cells_lower=cells_lower,
        cells_upper=cells_upper,
        wanted=wanted,
        raw=plateaus.cell_sets.topology.betti_at(threshold),
        predicted=cells.predicted,
        reason=reason if base in (None, threshold) else f"as the seed for local changes: {reason}",
        policy=policy or plateaus.cell_sets.policy,
        find_interval=find_interval or partial(_interval_of, row),
        find_without_features=(
            partial(_list_without_features, plateaus, cells.predicted)
            if len(cells.features)
            else str
        ),
        base=base,
        wishes=cells.wishes if isinstance(cells, LocalCells) else (),
        cells=cells,
        resolved=resolved,
    )


def describe_rank(row: pd.Series, candidates: pd.DataFrame, what: str, base: float | None) -> str:
    """Return why a candidate was chosen, in words.

    Parameters
    ----------
    row
        The candidate.
    candidates
        All of them.
    what
        What they have in common.
    base
        The threshold of the base; None with the global scope.
    """
    if row["threshold"] == base:
        return "the base has the wanted topology, so no cell differs from it"
    ranked = f"number {row['rank']} of {len(candidates)} intervals with {what}, the widest first"
    return f"{ranked}; {describe_place(row)}"


def same_cells_around(cell_sets: CellSets, threshold: float) -> tuple[float, float]:
    """Return the two neighbouring fractions between which all thresholds give the same cells.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    threshold
        Volume fraction in (0, 1].

    Returns
    -------
    lower, upper
        Neighbouring fractions with ``lower < threshold <= upper``; 0 and 1 at the ends.
    """
    lower, level, upper = 0, to_level(threshold), FULL
    for layer in cell_sets.fractions.cell_multiples:
        multiples = layer.clip(0, FULL)
        lower = multiples.max(where=multiples < level, initial=lower)
        upper = multiples.min(where=multiples >= level, initial=upper)
    return float(lower * RESOLUTION), float(upper * RESOLUTION)


def find_interval_around(plateaus: Plateaus, threshold: float, betti: BettiNumbers) -> Interval:
    """Return the interval in which a threshold can move with the same Betti numbers.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold; those in the interval are examined.
    threshold
        Volume fraction in (0, 1].
    betti
        The Betti numbers at the threshold.
    """
    same_cells = same_cells_around(plateaus.cell_sets, threshold)
    row = plateaus.find_interval(threshold)
    if row is None or tuple(row[BETTI]) != tuple(betti):
        row = _plateau_around(plateaus.cell_sets, threshold)
    ends = float(row["lower"]), float(row["upper"])
    within = max(ends[0], same_cells[0]), min(ends[1], same_cells[1])
    return Interval(*ends, margin=margin_of(within, ends), unexamined=float(row["unexamined"]))


def _plateau_around(cell_sets: CellSets, threshold: float) -> pd.Series:
    """Return the extent of an unexamined plateau around a threshold."""
    levels = np.concatenate([[1.0], cell_sets.distinct_fractions, [0.0]])
    upper, lower = levels[levels >= threshold].min(), levels[levels < threshold].max()
    return pd.Series({"lower": lower, "upper": upper, "unexamined": 0.0})


def _interval_of(row: Mapping[str, float] | pd.Series) -> Interval:
    return Interval(**{key: float(row[key]) for key in Interval._fields})


def _list_without_features(plateaus: Plateaus, betti: BettiNumbers) -> str:
    """Return the intervals with these Betti numbers in which nothing is removed or filled."""
    predicted = plateaus.table
    is_untouched = predicted["removed"] + predicted["filled"] == 0
    is_wanted = is_untouched & matches(predicted, Target(**betti._asdict()))
    return "; ".join(
        f"{interval.lower:.4g} < t <= {interval.upper:.4g}"
        for interval in rank_candidates(predicted, is_wanted).head(3).itertuples()
    )
