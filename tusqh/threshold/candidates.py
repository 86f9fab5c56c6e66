"""Rank candidates for the threshold, and mesh and measure them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSet
from tusqh.antialias.resolve import Resolved, build_mesh
from tusqh.grid import BackgroundGrid
from tusqh.threshold.plateaus import merge_intervals

#: Values of the column `status`.
CHOSEN, NOT_TRIED, DISAGREES = "chosen", "not tried", "measurement disagrees"


@dataclass(frozen=True)
class Trial:
    """A candidate that was meshed and measured.

    Parameters
    ----------
    cells
        The cells of the candidate, with the prediction.
    resolved
        The mesh of the candidate.
    """

    cells: CellSet
    resolved: Resolved

    @property
    def is_verified(self) -> bool:
        """Whether the mesh is sound and both measurements confirm the prediction."""
        measured = self.resolved.mesh.measurement
        return measured.has_topology(self.cells.predicted) and measured.is_sound


def try_cells(cells: CellSet, grid: BackgroundGrid, *, name: str) -> Trial:
    """Return the mesh of the cells at a candidate threshold.

    Parameters
    ----------
    cells
        The cells of the candidate.
    grid
        The background grid.
    name
        The model, for messages.
    """
    return Trial(cells, build_mesh(cells, grid, name=name))


def rank_candidates(
    predicted: pd.DataFrame, is_wanted: pd.Series, *, base: float | None = None
) -> pd.DataFrame:
    """Return the intervals of wanted plateaus, widest first; ties go to the closest to 1/2.

    With the local scope, the interval that holds the base comes before all others, because no cell
    has to differ from the base there.

    Parameters
    ----------
    predicted
        See `tusqh.threshold.plateaus.Plateaus.table`.
    is_wanted
        The plateaus to use.
    base
        The threshold of the base, which is taken in its interval; None with the global scope.

    Returns
    -------
    candidates
        The columns of `tusqh.threshold.plateaus.merge_intervals`, `rank` and `status`.

    Examples
    --------
    >>> predicted = pd.DataFrame({
    ...     "upper": [1.0, 0.5, 0.4], "lower": [0.5, 0.4, 0.0], "width": [0.5, 0.1, 0.4],
    ...     "threshold": [0.75, 0.45, 0.2], "cells": 1, "volume_ratio": 1.0,
    ...     "betti_0": [1, 2, 1], "betti_1": 0, "betti_2": 0})
    >>> ranked = rank_candidates(predicted, predicted["betti_0"] == 1)
    >>> ranked[["rank", "threshold", "status"]].values.tolist()
    [[1, 0.75, 'not tried'], [2, 0.2, 'not tried']]
    >>> rank_candidates(predicted, predicted["betti_0"] == 1, base=0.3)["threshold"].tolist()
    [0.3, 0.75]
    """
    intervals = merge_intervals(predicted, is_wanted, at=base)
    is_other = intervals["threshold"] != (np.nan if base is None else base)
    distance = (intervals["threshold"] - 0.5).abs()
    order = np.lexsort([distance, -intervals["width"], is_other])
    return _with_rank(intervals.iloc[order])


def rank_for_inspection(predicted: pd.DataFrame, base: float) -> pd.DataFrame:
    """Return all intervals; wide ones with the right volume come first.

    They are ranked by their width times the smaller of the volume ratio and its inverse, so a wide
    interval whose mesh has a hundredth of the volume comes after a narrow one with the right
    volume.  If the volume is unknown, only the width counts.

    Parameters
    ----------
    predicted
        See `tusqh.threshold.plateaus.Plateaus.table`.
    base
        The threshold whose interval is marked.

    Returns
    -------
    intervals
        The columns of `tusqh.threshold.plateaus.merge_intervals`, `rank`, and `at`, which holds the
        base threshold for its interval and is empty for the others.

    Examples
    --------
    >>> predicted = pd.DataFrame({
    ...     "upper": [1.0, 0.4], "lower": [0.4, 0.0], "width": [0.6, 0.4], "threshold": [0.7, 0.2],
    ...     "cells": [4, 400], "volume_ratio": [0.01, 1.0],
    ...     "betti_0": [4, 1], "betti_1": 0, "betti_2": 0})
    >>> rank_for_inspection(predicted, 0.5)[["rank", "volume_ratio", "at"]].values.tolist()
    [[1, 1.0, ''], [2, 0.01, '0.5']]
    """
    intervals = merge_intervals(predicted)
    ratio = intervals["volume_ratio"].fillna(1.0)
    nearness = np.minimum(ratio, 1 / ratio)
    order = np.lexsort([-intervals["width"], -(intervals["width"] * nearness)])
    ranked = intervals.iloc[order].reset_index(drop=True)
    ranked.insert(0, "rank", np.arange(1, len(ranked) + 1))
    is_base = (ranked["lower"] < base) & (base <= ranked["upper"])
    return ranked.assign(at=np.where(is_base, f"{base:g}", ""))


def list_plateaus(plateaus: pd.DataFrame) -> pd.DataFrame:
    """Return single plateaus as candidates, in the given order.

    Parameters
    ----------
    plateaus
        Rows of `tusqh.threshold.plateaus.Plateaus.table`.
    """
    return _with_rank(plateaus.assign(margin=plateaus["width"] / 2, unexamined=0.0))


def _with_rank(candidates: pd.DataFrame) -> pd.DataFrame:
    ranked = candidates.reset_index(drop=True)
    ranked.insert(0, "rank", np.arange(1, len(ranked) + 1))
    ranked["status"] = NOT_TRIED
    return ranked
