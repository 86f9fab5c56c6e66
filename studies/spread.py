"""Measure the spread of Betti numbers over grid placements, and its reduction by anti-aliasing."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from studies.orientation import BETTI, SCHEMES, TOUCHING
from studies.stability import most_frequent
from tusqh.grid import FloatArray
from tusqh.settings.goal import Target
from tusqh.threshold.goals import matches

_N_BOOTSTRAP = 2000

#: Columns that are rounded, because they are sums of floating-point numbers.
_ROUNDED = ("raw_spread", "spread", "shrinks", "low", "high")


def measure_spread(
    table: pd.DataFrame, *, name: str, target: Target | None = None, seed: int = 0
) -> pd.DataFrame:
    """Return the spread of Betti numbers over placements, raw and anti-aliased.

    The spread is the square root of the sum of the variances of the three Betti numbers, which is
    the typical distance of a placement's numbers from their mean.

    Parameters
    ----------
    table
        See `vary_placement`.
    name
        The model.
    target
        The Betti numbers that the model must have.
    seed
        Seed of the bootstrap, which draws placements with replacement.

    Returns
    -------
    spread
        One row per `cells`, `threshold` and `scheme` except the first: `raw_spread`, `spread`,
        `shrinks` (the relative reduction), the ends `low` and `high` of its 95 % interval
        (missing if the raw spread is zero); and, for the raw cells and for the scheme, the
        number of distinct `topologies`, the share of placements with the most frequent one
        (`agreement`) and with the `wanted` one.
    """
    rng = np.random.default_rng(seed)
    rows = []
    for (cells, threshold), group in table.groupby(["cells", "threshold"], sort=True):
        numbers = _by_scheme(group)
        described = {scheme: _describe(numbers[scheme], target) for scheme in SCHEMES}
        for scheme in SCHEMES[1:]:
            shrinks, drawn = _shrinkage(numbers[TOUCHING], numbers[scheme], rng)
            low, high = _interval(drawn)
            rows.append(
                {
                    "model": name,
                    "cells": cells,
                    "threshold": threshold,
                    "scheme": scheme,
                    "raw_spread": float(spread_of(numbers[TOUCHING])),
                    "spread": float(spread_of(numbers[scheme])),
                    "shrinks": shrinks,
                    "low": low,
                    "high": high,
                    **{f"raw_{key}": found for key, found in described[TOUCHING].items()},
                    **described[scheme],
                }
            )
    return pd.DataFrame(rows).round(dict.fromkeys(_ROUNDED, 6))


def pool_spreads(
    tables: Mapping[str, pd.DataFrame], thresholds: Mapping[str, float], *, seed: int = 0
) -> pd.DataFrame:
    """Return the relative reduction of the spread at the models' thresholds, over all models.

    Parameters
    ----------
    tables
        Placements by model, see `vary_placement`.
    thresholds
        The threshold of each model.
    seed
        Seed of the bootstrap.

    Returns
    -------
    pooled
        One row per rank of the grid size (1 is the finest) and scheme except the first: the
        number of `models`, the sums of their spreads (`raw_spread`, `spread`), the relative
        reduction of the sum (`shrinks`), and the ends `low` and `high` of its 95 % interval,
        drawn over the placements of each model.
    """
    rng = np.random.default_rng(seed)
    found: dict[int, list[dict[str, FloatArray]]] = {}
    for name, table in tables.items():
        at = table[table["threshold"] == thresholds[name]]
        for rank, group in enumerate(_from_finest(at), start=1):
            numbers = _by_scheme(group)
            n = len(numbers[TOUCHING])
            # The first row is the placements themselves; the others are drawn from them.
            drawn = np.concatenate([np.arange(n)[None], rng.integers(0, n, (_N_BOOTSTRAP, n))])
            found.setdefault(rank, []).append({s: spread_of(numbers[s][drawn]) for s in SCHEMES})
    rows = []
    for rank, of_models in sorted(found.items()):
        sums = {
            scheme: np.sum([model[scheme] for model in of_models], axis=0) for scheme in SCHEMES
        }
        for scheme in SCHEMES[1:]:
            with np.errstate(divide="ignore", invalid="ignore"):
                shrinks = 1 - sums[scheme] / sums[TOUCHING]
            shrinks[~np.isfinite(shrinks)] = np.nan
            low, high = _interval(shrinks[1:])
            rows.append(
                {
                    "grid_rank": rank,
                    "scheme": scheme,
                    "models": len(of_models),
                    "raw_spread": float(sums[TOUCHING][0]),
                    "spread": float(sums[scheme][0]),
                    "shrinks": float(shrinks[0]),
                    "low": low,
                    "high": high,
                }
            )
    return pd.DataFrame(rows).round(dict.fromkeys(_ROUNDED, 6))


def spread_of(numbers: FloatArray) -> FloatArray:
    """Return the square root of the sum of the variances of Betti numbers.

    Parameters
    ----------
    numbers
        Betti numbers, shape (..., placements, 3).

    Examples
    --------
    >>> float(spread_of(np.array([[1.0, 3.0, 0.0], [1.0, 5.0, 0.0]])))
    1.0
    """
    return np.asarray(np.sqrt(numbers.var(axis=-2).sum(axis=-1)))


def _from_finest(table: pd.DataFrame) -> list[pd.DataFrame]:
    """Return the rows of each grid size, with the finest first."""
    return [group for _, group in table.groupby("cells", sort=True)][::-1]


def _by_scheme(group: pd.DataFrame) -> dict[str, FloatArray]:
    """Return the Betti numbers of each scheme, one row per placement."""
    return {
        scheme: group.loc[group["scheme"] == scheme, BETTI].to_numpy(dtype=np.float64)
        for scheme in SCHEMES
    }


def _shrinkage(
    raw: FloatArray, other: FloatArray, rng: np.random.Generator
) -> tuple[float, FloatArray]:
    """Return the relative reduction of the spread, and the same for resampled placements.

    Both are missing (NaN) if the raw spread is zero.
    """
    drawn = rng.integers(0, len(raw), (_N_BOOTSTRAP, len(raw)))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = spread_of(other[drawn]) / spread_of(raw[drawn])
        ratio = float(np.divide(spread_of(other), spread_of(raw)))
    ratios[~np.isfinite(ratios)] = np.nan
    return 1 - ratio if np.isfinite(ratio) else float("nan"), 1 - ratios


def _interval(drawn: FloatArray) -> tuple[float, float]:
    """Return the ends of the 95 % interval of bootstrap values, ignoring missing ones."""
    there = drawn[~np.isnan(drawn)]
    if len(there) == 0:
        return float("nan"), float("nan")
    low, high = np.quantile(there, [0.025, 0.975]).tolist()
    return low, high


def _describe(numbers: FloatArray, target: Target | None) -> dict[str, float]:
    topologies, agreement, _ = most_frequent(numbers)
    wanted = float("nan")
    if target is not None:
        wanted = float(matches(pd.DataFrame(numbers, columns=BETTI), target).mean())
    return {"topologies": topologies, "agreement": agreement, "wanted": wanted}
