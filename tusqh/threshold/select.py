"""The choice of a threshold: a fixed one, or one whose mesh has the wanted Betti numbers.

Algorithm notes 3: the plateaus whose predicted, effective Betti numbers match are ranked; the
mesh of the best one is made and measured, and the next one tried should the two ever differ.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from tusqh.antialias.clusters import MixedPinches
from tusqh.antialias.resolve import keep_cells, resolve
from tusqh.errors import TopologyError
from tusqh.mesh.betti import betti_by_euler
from tusqh.sampling.fractions import VolumeFractions
from tusqh.topology.betti_numbers import BettiNumbers

Target = dict[str, int]

#: Fields of open outlines have tens of thousands of plateaus, nearly all too narrow to be a
#: robust choice; only this many of the widest are looked at.
MAX_PLATEAUS = 1000


@dataclass(frozen=True)
class Selection:
    """A threshold and why it was chosen.

    Parameters
    ----------
    threshold
        Dimensionless, in (0, 1].
    margin
        Distance to the nearest fraction of a cell or sub-cell, where the cells may change.
    predicted
        Betti numbers that the mesh will have.
    reason
        One sentence for people.
    """

    threshold: float
    margin: float
    predicted: BettiNumbers
    reason: str


def predict_plateaus(
    fractions: VolumeFractions,
    plateaus: pd.DataFrame,
    *,
    min_cells: int = 1,
    mixed_pinches: MixedPinches = "separate",
    progress: Callable[[int, int], None] | None = None,
) -> pd.DataFrame:
    """Return the plateaus with the Betti numbers that their meshes will have.

    Parameters
    ----------
    fractions
        Volume fractions.
    plateaus
        Plateaus with raw Betti numbers, see `tusqh.topology.persistence.list_plateaus`.
    min_cells, mixed_pinches
        As for `tusqh.antialias.resolve.keep_cells`.
    progress
        Called with (plateaus done, plateaus in all).

    Returns
    -------
    predicted
        The `MAX_PLATEAUS` widest plateaus, the raw Betti numbers renamed ``raw_*``, with `cells`
        kept, `clusters` of pinches, `overruled` ones, components `removed`, and
        `betti_0`, `betti_1`, `betti_2` of the mesh.
    """
    widest = plateaus["width"].nlargest(MAX_PLATEAUS).index.sort_values()
    wide = plateaus.loc[widest].reset_index(drop=True)
    rows = []
    for done, threshold in enumerate((wide["upper"] + wide["lower"]) / 2, start=1):
        cells = keep_cells(
            fractions, threshold=threshold, min_cells=min_cells, mixed_pinches=mixed_pinches
        )
        rows.append(
            {
                "cells": int(cells.kept.sum()),
                "clusters": cells.decisions.n_clusters,
                "overruled": cells.decisions.n_overruled_clusters,
                "removed": len(cells.removed),
                **cells.predicted._asdict(),
            }
        )
        if progress is not None:
            progress(done, len(wide))
    raw = wide.rename(columns={f"betti_{k}": f"raw_betti_{k}" for k in range(3)})
    return pd.concat([raw, pd.DataFrame(rows)], axis=1)


def rank_candidates(predicted: pd.DataFrame, target: Target) -> pd.DataFrame:
    """Return the plateaus that match a target, the widest first, then the closest to 1/2.

    Examples
    --------
    >>> import pandas as pd
    >>> predicted = pd.DataFrame({"upper": [1.0, 0.5, 0.4], "lower": [0.5, 0.4, 0.0],
    ...                           "width": [0.5, 0.1, 0.4], "cells": 1,
    ...                           "betti_0": [2, 1, 1], "betti_1": 0, "betti_2": 0})
    >>> rank_candidates(predicted, {"betti_0": 1})["threshold"].tolist()
    [0.2, 0.45]
    """
    matches = predicted["cells"] > 0
    for name, wanted in target.items():
        matches &= predicted[name] == wanted
    candidates = predicted[matches].copy()
    candidates["threshold"] = (candidates["upper"] + candidates["lower"]) / 2
    candidates["distance"] = (candidates["threshold"] - 0.5).abs()
    order = ["width", "distance", "threshold"]
    ranked = candidates.sort_values(order, ascending=[False, True, False])
    return ranked.drop(columns="distance").reset_index(drop=True)


def select_threshold(
    fractions: VolumeFractions,
    predicted: pd.DataFrame,
    target: Target,
    *,
    min_cells: int = 1,
    mixed_pinches: MixedPinches = "separate",
    name: str = "model",
) -> tuple[Selection, pd.DataFrame]:
    """Return the best threshold whose mesh is measured to have the wanted Betti numbers.

    Parameters
    ----------
    fractions
        Volume fractions.
    predicted
        Plateaus with predicted Betti numbers, see `predict_plateaus`.
    target
        Wanted Betti numbers; those left out may have any value.
    min_cells, mixed_pinches
        As for `tusqh.antialias.resolve.keep_cells`.
    name
        The model, for messages.

    Returns
    -------
    selection
        The choice.
    candidates
        All matching plateaus in the order they are tried.

    Raises
    ------
    TopologyError
        No plateau has the wanted numbers; the message lists what is reachable.
    """
    candidates = rank_candidates(predicted, target)
    for rank, row in candidates.iterrows():
        cells = keep_cells(
            fractions, threshold=row["threshold"], min_cells=min_cells, mixed_pinches=mixed_pinches
        )
        mesh, _ = resolve(cells.kept, cells.decisions, fractions.grid, name=name)
        if betti_by_euler(mesh) == cells.predicted:
            selection = Selection(
                threshold=float(row["threshold"]),
                margin=float(row["width"]) / 2,
                predicted=cells.predicted,
                reason=f"number {int(str(rank)) + 1} of {len(candidates)} plateaus with "
                f"{_describe(target)}: {row['lower']:.4g} < t <= {row['upper']:.4g}",
            )
            return selection, candidates
    raise TopologyError(
        f"no threshold gives {_describe(target)}",
        where=name,
        expected="Betti numbers that some threshold reaches:\n" + list_reachable(predicted),
        remedy=_suggest(predicted, target),
    )


def fix_threshold(
    fractions: VolumeFractions,
    threshold: float,
    *,
    min_cells: int = 1,
    mixed_pinches: MixedPinches = "separate",
    name: str = "model",
) -> Selection:
    """Return a threshold that the user fixed, with its margin and prediction.

    Raises
    ------
    TopologyError
        The threshold is not in (0, 1], or no cell reaches it.
    """
    if not 0 < threshold <= 1:
        raise TopologyError(
            f"the threshold is {threshold}",
            where=name,
            expected="a volume fraction in (0, 1]",
            remedy="use 0.5, or ask for Betti numbers with `target`",
        )
    cells = keep_cells(
        fractions, threshold=threshold, min_cells=min_cells, mixed_pinches=mixed_pinches
    )
    if not cells.kept.any():
        raise TopologyError(
            f"no cell is left at threshold {threshold}",
            where=name,
            expected=f"a threshold of at most {fractions.cells.max():.4g}, the largest fraction, "
            f"and components of at least min_cells = {min_cells} cells",
            remedy="lower `threshold` or `min_cells`, or use a finer grid",
        )
    margin = float(np.abs(fractions.values - threshold).min())
    return Selection(threshold, margin, cells.predicted, "fixed by the configuration")


def choose_threshold(
    fractions: VolumeFractions,
    predicted: pd.DataFrame,
    *,
    threshold: float | None = None,
    target: Target | None = None,
    min_cells: int = 1,
    mixed_pinches: MixedPinches = "separate",
    name: str = "model",
) -> tuple[Selection, pd.DataFrame]:
    """Return the threshold that a configuration asks for: a fixed one, or one by Betti numbers.

    See `fix_threshold` and `select_threshold`; a fixed threshold has no other candidates.
    """
    how: Any = {"min_cells": min_cells, "mixed_pinches": mixed_pinches, "name": name}
    if target is not None:
        return select_threshold(fractions, predicted, target, **how)
    selection = fix_threshold(fractions, 0.5 if threshold is None else threshold, **how)
    return selection, rank_candidates(predicted, selection.predicted._asdict()).iloc[:0]


def list_reachable(predicted: pd.DataFrame) -> str:
    """Return the reachable Betti numbers as lines of text, one per plateau, from high to low."""
    shown = predicted[predicted["cells"] > 0]
    return "\n".join(
        f"    {row.lower:.4f} < t <= {row.upper:.4f}: betti_0 = {row.betti_0}, "
        f"betti_1 = {row.betti_1}, betti_2 = {row.betti_2}"
        for row in shown.itertuples()
    )


def _describe(target: Target) -> str:
    return ", ".join(f"{name} = {wanted}" for name, wanted in sorted(target.items()))


def _suggest(predicted: pd.DataFrame, target: Target) -> str:
    """Return the reachable numbers that differ least from the target."""
    shown = predicted[predicted["cells"] > 0]
    names = sorted(target)
    distance = (shown[names] - [target[name] for name in names]).abs().sum(axis=1)
    nearest = shown.iloc[int(distance.to_numpy().argmin())]
    numbers = ", ".join(f"{name} = {nearest[name]:.0f}" for name in names)
    return f"ask for one of these (nearest: {numbers}), or change the grid or `min_cells`"
