"""How far the topology depends on where the grid lies, and how much anti-aliasing mitigates it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from studies.placements import lay_grids, random_placements
from studies.raw_cells import closed_betti
from tusqh.antialias.cells import CellSets
from tusqh.antialias.pinches import find_pinches
from tusqh.grid import BoolArray, FloatArray
from tusqh.sampling.field import Geometry
from tusqh.settings.goal import Target
from tusqh.settings.policy import MixedPinches, Policy
from tusqh.threshold.goals import matches
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.effective import effective_betti

BETTI = ["betti_0", "betti_1", "betti_2"]

#: Kept cells as they are, taken to hang together where they touch, or only where they share a
#: facet; pinches and archipelagos decided by sub-cells, by what happens to mixed clusters of
#: pinches; and the model's own policy, which may remove small features too.
TOUCHING, BY_FACETS = "raw cells", "raw cells, by facets"
MIXED: tuple[MixedPinches, ...] = ("separate", "majority", "connect")
SEPARATE, MAJORITY, CONNECT = (f"sub-cells, {mixed}" for mixed in MIXED)
POLICY = "tusqh, as configured"
SCHEMES = (TOUCHING, BY_FACETS, SEPARATE, MAJORITY, CONNECT, POLICY)

#: Thresholds that are looked at besides the model's own.
THRESHOLDS = (0.1, 0.3, 0.5, 0.7, 0.9)

#: A topology is robust where so many placements have it at one threshold, and an accident of the
#: grid where nowhere more than so few do.
ROBUST, ACCIDENT = 0.9, 0.1

_N_BOOTSTRAP = 2000

#: Columns that are rounded: they hold sums of floating-point numbers.
_ROUNDED = ("raw_spread", "spread", "shrinks", "low", "high")


def vary_placement(
    geometry: Geometry,
    policy: Policy,
    thresholds: Sequence[float],
    sizes: Sequence[int],
    *,
    count: int = 50,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
    **sampling: Any,
) -> pd.DataFrame:
    """Return the Betti numbers of a model over random placements, grid sizes and thresholds.

    Parameters
    ----------
    geometry
        The model.
    policy
        What to do about pinches, archipelagos and small features.
    thresholds
        Volume-fraction thresholds.
    sizes
        Cells along the longest side, see `studies.placements.lay_grids`.
    count, seed
        How many placements, and the seed of their random numbers.
    progress
        Called with (placements done, placements in all).
    **sampling
        `window`, `domain`, `rule` and `orientation`.

    Returns
    -------
    table
        One row per `placement`, `cells`, `threshold` and `scheme`: `betti_0`, `betti_1`,
        `betti_2` as predicted for the mesh.
    """
    placements = random_placements(len(geometry.bounding_box()[0]), count, seed=seed)
    rows: list[tuple[Any, ...]] = []
    for number, placement in enumerate(placements):
        for size, fractions in lay_grids(geometry, placement, sizes, **sampling):
            sets = {m: CellSets(fractions, Policy(m, policy.bridges)) for m in MIXED}
            configured = CellSets(fractions, policy)
            for threshold in thresholds:
                found = _predict(sets, configured, threshold)
                rows += [(number, size, threshold, s, *found[s]) for s in SCHEMES]
        if progress is not None:
            progress(number + 1, count)
    return pd.DataFrame(rows, columns=["placement", "cells", "threshold", "scheme", *BETTI])


def _predict(
    sets: Mapping[MixedPinches, CellSets], configured: CellSets, threshold: float
) -> dict[str, BettiNumbers]:
    """Return the Betti numbers of every scheme; what cannot differ is not counted again."""
    kept = configured.fractions.cells >= threshold
    pinches = find_pinches(kept)
    separated = sets["separate"].at(threshold)
    decided = {"separate": separated.predicted}
    for mixed in MIXED[1:]:
        is_same = separated.decisions.clusters_overruled == 0
        decided[mixed] = decided["separate"] if is_same else sets[mixed].at(threshold).predicted
    policy = configured.policy
    is_plain = keeps_all(policy)
    return {
        TOUCHING: closed_betti(kept),
        BY_FACETS: effective_betti(kept, np.zeros_like(pinches), pinches),
        **{f"sub-cells, {mixed}": decided[mixed] for mixed in MIXED},
        POLICY: decided[policy.mixed_pinches] if is_plain else configured.at(threshold).predicted,
    }


def keeps_all(policy: Policy) -> bool:
    """Return whether a policy removes and fills nothing.

    >>> some = Policy.from_dict({"components": {"min_cells": 2}})
    >>> keeps_all(Policy()), keeps_all(some)
    (True, False)
    """
    return all(c.keeps_all for c in (policy.components, policy.holes, policy.voids))


def measure_spread(
    table: pd.DataFrame, *, name: str, target: Target | None = None, seed: int = 0
) -> pd.DataFrame:
    """Return how far Betti numbers spread over placements, raw and anti-aliased.

    The spread is the root of the summed variances of the three Betti numbers: the typical
    distance of a placement's numbers from their mean.

    Parameters
    ----------
    table
        See `vary_placement`.
    name
        The model.
    target
        Betti numbers that are wanted.
    seed
        Of the random numbers of the bootstrap, which draws placements with replacement, the same
        ones for all schemes.

    Returns
    -------
    spread
        One row per `cells`, `threshold` and `scheme` but the first: `raw_spread`, `spread`,
        `shrinks`, the share by which it is smaller than the raw one, with the ends `low` and
        `high` of its 95 % interval (missing where nothing spreads); and for the raw cells and
        the scheme the number of different `topologies`, the share of placements that have the
        most frequent one (`agreement`) and that have what is `wanted`.
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
    """Return by which share the spread at the models' thresholds shrinks, summed over the models.

    Parameters
    ----------
    tables
        Placements by model, see `vary_placement`.
    thresholds
        The threshold to look at, by model.
    seed
        Of the random numbers of the bootstrap.

    Returns
    -------
    pooled
        One row per rank of the grid size (1 is the finest) and scheme but the first: over how
        many `models`, the spreads summed over them, raw and of the scheme (`raw_spread`,
        `spread`), by which share the sum `shrinks`, and the ends `low` and `high` of its 95 %
        interval, drawn over the placements of every model.
    """
    rng = np.random.default_rng(seed)
    found: dict[int, list[dict[str, FloatArray]]] = {}
    for name, table in tables.items():
        at = table[table["threshold"] == thresholds[name]]
        for rank, group in enumerate(_from_finest(at), start=1):
            numbers = _by_scheme(group)
            n = len(numbers[TOUCHING])
            # The first row is the placements themselves, the others are drawn from them.
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
    """Return the root of the summed variances of Betti numbers, shape (..., placements, 3).

    >>> float(spread_of(np.array([[1.0, 3.0, 0.0], [1.0, 5.0, 0.0]])))
    1.0
    """
    return np.asarray(np.sqrt(numbers.var(axis=-2).sum(axis=-1)))


def map_stability(table: pd.DataFrame, *, name: str, target: Target | None = None) -> pd.DataFrame:
    """Return what most placements have at every grid size and threshold, and how many do.

    Parameters
    ----------
    table
        See `vary_placement`.
    name
        The model.
    target
        Betti numbers that are wanted.

    Returns
    -------
    stability
        One row per `cells`, `threshold` and `scheme`: the most frequent `betti_*`, the share of
        placements with them (`agreement`), how many different `topologies` there are, and the
        share that is as `wanted` (missing without a target).
    """
    rows = []
    for (cells, threshold, scheme), group in table.groupby(
        ["cells", "threshold", "scheme"], sort=True
    ):
        topologies, agreement, betti = _modal(group[BETTI].to_numpy(float))
        share = float(matches(group, target).mean()) if target is not None else float("nan")
        rows.append(
            {
                "model": name,
                "cells": cells,
                "threshold": threshold,
                "scheme": scheme,
                **betti._asdict(),
                "agreement": agreement,
                "topologies": topologies,
                "wanted": share,
            }
        )
    return pd.DataFrame(rows)


def recommend_grid(stability: pd.DataFrame, table: pd.DataFrame) -> pd.DataFrame:
    """Return the coarsest grid on which a topology is robust, and what else was seen there.

    Parameters
    ----------
    stability
        Of one model, see `map_stability`.
    table
        The placements it was made of.

    Returns
    -------
    recommended
        One row per scheme: the `cells` along the longest side of the coarsest grid on which at
        least nine of ten placements have one topology (the wanted one, where one is wanted) at
        one `threshold`, the middle of the longest run of such thresholds; where there is no such
        grid, the one that comes nearest; the `share` of placements; whether that is `robust`;
        the `betti_*`; over all thresholds of that grid the number of `topologies`, of those that
        are robust at some threshold (`robust_topologies`) and of `accidents`, which no threshold
        gives more than one of ten placements.
    """
    rows = []
    for scheme in SCHEMES:
        of_scheme = stability[stability["scheme"] == scheme]
        of_scheme = of_scheme.sort_values(["cells", "threshold"])
        # That no cell is kept is robust too, but nobody wants it.
        agreement = of_scheme["agreement"].where(of_scheme["betti_0"] > 0, 0.0)
        share = of_scheme["wanted"].fillna(agreement)
        is_robust = share >= ROBUST
        cells = of_scheme["cells"][is_robust].min() if is_robust.any() else None
        if cells is None:
            place = int(share.to_numpy().argmax())
        else:
            on_grid = (of_scheme["cells"] == cells).to_numpy()
            place = _middle_of_longest_run(on_grid & is_robust.to_numpy())
        row = of_scheme.iloc[place]
        found = float(share.iloc[place])
        placed = table[(table["scheme"] == scheme) & (table["cells"] == row["cells"])]
        counts = placed.groupby(["threshold", *BETTI]).size() / placed["placement"].nunique()
        largest = counts.groupby(BETTI).max()
        rows.append(
            {
                "model": row["model"],
                "scheme": scheme,
                "cells": row["cells"],
                "threshold": row["threshold"],
                "share": found,
                "robust": found >= ROBUST,
                **{key: row[key] for key in BETTI},
                "topologies": len(largest),
                "robust_topologies": int((largest >= ROBUST).sum()),
                "accidents": int((largest <= ACCIDENT).sum()),
            }
        )
    return pd.DataFrame(rows)


def _from_finest(table: pd.DataFrame) -> list[pd.DataFrame]:
    """Return the rows of every grid size, the finest first."""
    return [group for _, group in table.groupby("cells", sort=True)][::-1]


def _by_scheme(group: pd.DataFrame) -> dict[str, FloatArray]:
    """Return the Betti numbers of every scheme, a row per placement."""
    return {
        scheme: group.loc[group["scheme"] == scheme, BETTI].to_numpy(dtype=np.float64)
        for scheme in SCHEMES
    }


def _shrinkage(
    raw: FloatArray, other: FloatArray, rng: np.random.Generator
) -> tuple[float, FloatArray]:
    """Return by which share the spread shrinks, and the same for resampled placements.

    Missing where the raw numbers do not spread.
    """
    drawn = rng.integers(0, len(raw), (_N_BOOTSTRAP, len(raw)))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = spread_of(other[drawn]) / spread_of(raw[drawn])
        ratio = float(np.divide(spread_of(other), spread_of(raw)))
    ratios[~np.isfinite(ratios)] = np.nan
    return 1 - ratio if np.isfinite(ratio) else float("nan"), 1 - ratios


def _interval(drawn: FloatArray) -> tuple[float, float]:
    """Return the ends of the 95 % interval of bootstrap values, missing ones left out."""
    there = drawn[~np.isnan(drawn)]
    if len(there) == 0:
        return float("nan"), float("nan")
    low, high = np.quantile(there, [0.025, 0.975]).tolist()
    return low, high


def _describe(numbers: FloatArray, target: Target | None) -> dict[str, float]:
    topologies, agreement, _ = _modal(numbers)
    wanted = float("nan")
    if target is not None:
        wanted = float(matches(pd.DataFrame(numbers, columns=BETTI), target).mean())
    return {"topologies": topologies, "agreement": agreement, "wanted": wanted}


def _modal(numbers: FloatArray) -> tuple[int, float, BettiNumbers]:
    """Return how many different rows there are, the share of the most frequent one, and it."""
    rows, counts = np.unique(numbers.astype(np.int64), axis=0, return_counts=True)
    most = int(counts.argmax())
    return len(rows), float(counts[most] / counts.sum()), BettiNumbers(*rows[most].tolist())


def _middle_of_longest_run(flags: BoolArray) -> int:
    """Return the index in the middle of the longest run of true flags.

    >>> _middle_of_longest_run(np.array([True, False, True, True, True]))
    3
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    starts, stops = edges[::2], edges[1::2]
    longest = int((stops - starts).argmax())
    return int((starts[longest] + stops[longest] - 1) // 2)
