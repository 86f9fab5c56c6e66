"""Compute the topology of a model over random grid placements, for several ways to join cells."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import pandas as pd

from studies.methods.digital_topology import closed_betti, open_betti
from studies.placements import lay_grids, random_placements
from tusqh.antialias.cells import CellSets
from tusqh.geometry.canonical import load_geometry
from tusqh.geometry.kinds import Surface
from tusqh.progress import log_progress
from tusqh.settings.grid import Window
from tusqh.settings.policy import Policy
from tusqh.settings.sampling import Sampling
from tusqh.threshold.selection import load_selection
from tusqh.topology.betti_numbers import BettiNumbers

BETTI = ["betti_0", "betti_1", "betti_2"]

#: Schemes without sub-cells: kept cells are joined where they touch, or only by shared facets.
TOUCHING, BY_FACETS = "raw cells", "raw cells, by facets"
#: Scheme in which every contact follows the vote of its sub-cell.
SUB_CELLS = "sub-cells"
#: The same with the policy of the model, which can also remove small features.
AS_CONFIGURED = "tusqh, as configured"
SCHEMES = (TOUCHING, BY_FACETS, SUB_CELLS, AS_CONFIGURED)

#: Thresholds of the study in addition to that of the model.
STUDY_THRESHOLDS = (0.1, 0.3, 0.5, 0.7, 0.9)


def vary_placement(
    geometry: Surface,
    policy: Policy,
    thresholds: Sequence[float],
    sizes: Sequence[int],
    *,
    count: int = 50,
    seed: int = 0,
    part: tuple[int, int] = (0, 1),
    progress: Callable[[int, int], None] | None = None,
    **how: Any,
) -> pd.DataFrame:
    """Return the Betti numbers of a model over random placements, grid sizes and thresholds.

    Parameters
    ----------
    geometry
        The model.
    policy
        The policy of the model for bridges and small features.
    thresholds
        Volume-fraction thresholds.
    sizes
        Numbers of cells along the longest side, see `studies.placements.lay_grids`.
    count, seed
        Number of placements, and the seed of their random numbers.
    part
        Which of how many parts of the placements are examined; the tables of all parts, one below
        the other, are that of one part.
    progress
        Called with (placements done, all placements).
    **how
        `window` and `sampling`, see `studies.placements.lay_grids`.

    Returns
    -------
    table
        One row per `placement`, `cells`, `threshold` and `scheme`, with the predicted `betti_0`,
        `betti_1`, `betti_2` of the mesh.
    """
    placements = random_placements(len(geometry.bounding_box()[0]), count, seed=seed)
    begin, end = (count * k // part[1] for k in (part[0], part[0] + 1))
    rows: list[tuple[Any, ...]] = []
    for number, placement in enumerate(placements[begin:end], start=begin):
        for size, fractions in lay_grids(geometry, placement, sizes, **how):
            plain = CellSets(fractions, Policy(bridges=policy.bridges))
            configured = CellSets(fractions, policy)
            for threshold in thresholds:
                found = _predict(plain, configured, threshold)
                rows += [(number, size, threshold, s, *found[s]) for s in SCHEMES]
        if progress is not None:
            progress(number + 1 - begin, end - begin)
    return pd.DataFrame(rows, columns=["placement", "cells", "threshold", "scheme", *BETTI])


def vary_model(
    geometry: Path,
    selection: Path,
    sizes: Sequence[int],
    *,
    count: int,
    part: tuple[int, int] = (0, 1),
    window: Mapping[str, Any] | None = None,
    sampling: Mapping[str, Any] | None = None,
) -> pd.DataFrame:
    """Return the table of `vary_placement` for a model of the workflow.

    Parameters
    ----------
    geometry, selection
        Files of the model; its threshold is examined beside `STUDY_THRESHOLDS`.
    sizes, count, part
        See `vary_placement`.
    window, sampling
        Settings of the model, as plain values.

    Returns
    -------
    table
        See `vary_placement`.
    """
    chosen = load_selection(selection)
    return vary_placement(
        cast(Surface, load_geometry(geometry)),
        chosen.policy,
        sorted({*STUDY_THRESHOLDS, chosen.threshold}),
        sizes,
        count=count,
        part=part,
        progress=log_progress("placements"),
        window=window and Window.from_dict(window).box,
        sampling=Sampling.from_dict(sampling or {}),
    )


def _predict(plain: CellSets, configured: CellSets, threshold: float) -> dict[str, BettiNumbers]:
    """Return the Betti numbers of each scheme."""
    kept = plain.fractions.cells >= threshold
    decided = plain.at(threshold).predicted
    is_plain = keeps_all(configured.policy)
    return {
        TOUCHING: closed_betti(kept),
        BY_FACETS: open_betti(kept),
        SUB_CELLS: decided,
        AS_CONFIGURED: decided if is_plain else configured.at(threshold).predicted,
    }


def keeps_all(policy: Policy) -> bool:
    """Return whether a policy removes and fills no features.

    Parameters
    ----------
    policy
        The policy.

    Examples
    --------
    >>> some = Policy.from_dict({"components": {"min_cells": 2}})
    >>> keeps_all(Policy()), keeps_all(some)
    (True, False)
    """
    return all(c.keeps_all for c in (policy.components, policy.holes, policy.voids))
