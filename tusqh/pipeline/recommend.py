"""Find the coarsest grid that robustly has the wanted topology, without making a mesh."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from tusqh.errors import ConfigError, SamplingError
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry
from tusqh.pipeline.sample import sample
from tusqh.pipeline.select import find_plateaus
from tusqh.progress import Progress, log_progress
from tusqh.quality.thickness import measure_thickness
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.orient import orient
from tusqh.sampling.reference import find_reference
from tusqh.settings.arguments import to_words
from tusqh.settings.goal import Goal, Target
from tusqh.settings.model import Settings
from tusqh.threshold.goals import matches
from tusqh.threshold.plateaus import merge_intervals
from tusqh.threshold.within_interval import SAFE_DISTANCE

#: Numbers of cells along the longest side that are tried, from coarse to fine.
CELLS = (6, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 128)

#: Finest grid that is tried if the settings do not say, by dimension.
FINEST = {2: 128, 3: 64}

#: Positions of the grid that are tried, in cells from the corner of the box, along x, y and z.
OFFSETS = ((0.0, 0.0, 0.0), (0.5, 0.5, 0.5), (0.25, 0.75, 0.5), (0.75, 0.5, 0.25))

Interval = tuple[float, float]


@dataclass(frozen=True)
class Recommendation:
    """The grids that were tried, and the coarsest robust one.

    Parameters
    ----------
    table
        One row per grid: `cells`, `cell_size`, `have_it` (positions with the topology at some
        threshold), `positions`, `lower` and `upper` (the thresholds with which all of them have
        it), `margin` (distance of `threshold` to the nearer end), `threshold`, `volume_from` and
        `volume_to` (volumes at the threshold over that of the geometry), and `is_robust`.
    cells
        Cells along the longest side of the recommended grid; None if no grid is robust.
    words
        Words of the command line that make its mesh, after the name of the geometry.
    two_cells
        Cell size that puts two cells across all but the thinnest 5 % of the walls; None if it is
        unknown.
    """

    table: pd.DataFrame
    cells: int | None
    words: tuple[str, ...]
    two_cells: float | None


@dataclass(frozen=True)
class _Tried:
    """One position of a grid: the offset, its thresholds with the topology, and its plateaus."""

    offset: tuple[float, ...]
    intervals: tuple[Interval, ...]
    plateaus: pd.DataFrame

    def volume_at(self, threshold: float) -> float:
        """Return the volume of the cells at a threshold over that of the geometry."""
        is_below = (self.plateaus["lower"] < threshold).to_numpy()
        row = int(is_below.argmax()) if is_below.any() else -1
        return float(self.plateaus["volume_ratio"].iloc[row])


def recommend(
    geometry: Geometry,
    target: Target | None,
    settings: Settings | None = None,
    *,
    finest: int | None = None,
    progress: Progress = log_progress,
) -> Recommendation:
    """Return the coarsest grid that has the wanted topology at four positions and one threshold.

    A grid is robust if there is a threshold such that all positions in `OFFSETS` have the topology
    at it, and at all others at most `SAFE_DISTANCE` away.  It is recommended if the next finer grid
    is robust too.  Positions are those of the study of stability: one at the corner of the box, the
    others moved by fractions of a cell.

    Parameters
    ----------
    geometry
        The geometry.
    target
        The wanted Betti numbers.
    settings
        Everything but the size and the position of the grid and the goal; None: the defaults.
    finest
        Largest number of cells along the longest side; None: that of `FINEST`.
    progress
        Shows which grid is tried.

    Raises
    ------
    ConfigError
        There is no target.
    SamplingError
        Geometry and settings do not match.

    Examples
    --------
    >>> from tusqh.pipeline.ingest import ingest
    >>> points = [[0, 0], [3, 0], [3, 3], [0, 3], [1, 1], [1, 2], [2, 2], [2, 1]]
    >>> lines = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4]]
    >>> found = recommend(ingest((points, lines)), Target(betti_0=1, betti_1=1))
    >>> found.cells, " ".join(found.words)
    (6, '--cells 6 --placement corner --betti 1,1,*')
    """
    settings = settings or Settings()
    if target is None:
        raise ConfigError(
            "no topology",
            where="tusqh recommend",
            expected="the wanted numbers of components, holes and voids",
            remedy="add for instance `--betti 1,2,0`; `tusqh inspect` lists what can be reached",
        )
    dim = len(geometry.bounding_box()[0])
    rows, tried, before = [], {}, None
    for n in (n for n in CELLS if n <= (finest or FINEST[dim])):
        progress(f"{n} cells along the longest side")
        places = list(_try(geometry, settings, target, n))
        row = _describe(n, places)
        rows.append(row)
        tried[n] = places
        if row["is_robust"] and before is not None:
            break
        before = n if row["is_robust"] else None
    table = pd.DataFrame(rows)
    if before is None:
        return Recommendation(table, None, (), _two_cells(geometry, settings))
    chosen = next(row for row in rows if row["cells"] == before)
    words = _words(settings, target, chosen, tried[before])
    return Recommendation(table, before, words, _two_cells(geometry, settings))


def _try(geometry: Geometry, settings: Settings, target: Target, n: int) -> Iterator[_Tried]:
    """Yield what is found at every position of a grid; one without material has no topology."""
    dim = len(geometry.bounding_box()[0])
    is_fixed = settings.grid.snap or isinstance(geometry, Image)
    for place in OFFSETS[:1] if is_fixed else OFFSETS:
        offset = place[:dim]
        grid = replace(settings.grid, cells=n, offset=offset if any(offset) else None)
        grid = replace(grid, placement="corner")
        try:  # Thin walls may have no sample on a coarse grid.
            fractions = sample(
                geometry, grid=grid, sampling=settings.sampling, window=settings.window
            )
        except SamplingError:
            yield _Tried(offset, (), pd.DataFrame())
            continue
        plateaus = _plateaus(geometry, fractions, settings)
        intervals = merge_intervals(plateaus, pd.Series(matches(plateaus, target)))
        pairs = zip(intervals["lower"].tolist(), intervals["upper"].tolist(), strict=True)
        yield _Tried(offset, tuple(pairs), plateaus)


def _plateaus(geometry: Geometry, fractions: VolumeFractions, settings: Settings) -> pd.DataFrame:
    box = None if settings.window is None else settings.window.box
    reference = find_reference(geometry, fractions, sampling=settings.sampling, window=box)
    return find_plateaus(fractions, policy=settings.policy, reference=reference).table


def _describe(n: int, places: Sequence[_Tried]) -> dict[str, float | int | bool]:
    """Return the row of a grid."""
    lower, upper = _common([place.intervals for place in places])
    threshold = float("nan")
    if upper > lower:
        middle, safe = (lower + upper) / 2, min(SAFE_DISTANCE, (upper - lower) / 2)
        threshold = 0.5 if lower + safe <= 0.5 <= upper - safe else round(middle, 3)
    margin = min(threshold - lower, upper - threshold)
    volumes = [place.volume_at(threshold) for place in places if upper > lower]
    return {
        "cells": n,
        "have_it": sum(bool(place.intervals) for place in places),
        "positions": len(places),
        "lower": lower,
        "upper": upper,
        "threshold": threshold,
        "margin": margin,
        "volume_from": min(volumes, default=float("nan")),
        "volume_to": max(volumes, default=float("nan")),
        "is_robust": bool(margin >= SAFE_DISTANCE * (1 - 1e-9)),
    }


def _common(all_intervals: Sequence[Sequence[Interval]]) -> Interval:
    """Return the widest interval that lies in an interval of each position; NaN if none does.

    Intervals in which 1/2 is at least `SAFE_DISTANCE` from the ends come before the others.
    """
    common: list[Interval] = [(0.0, 1.0)] if all_intervals else []
    for intervals in all_intervals:
        both = [
            (max(low, other_low), min(high, other_high))
            for low, high in common
            for other_low, other_high in intervals
        ]
        common = [(low, high) for low, high in both if high > low]
    if not common:
        return float("nan"), float("nan")

    def preference(interval: Interval) -> tuple[bool, float]:
        low, high = interval
        return low + SAFE_DISTANCE <= 0.5 <= high - SAFE_DISTANCE, high - low

    return max(common, key=preference)


def _words(
    settings: Settings, target: Target, row: dict[str, float | int | bool], places: Sequence[_Tried]
) -> tuple[str, ...]:
    """Return the words of the command that makes the mesh at the position with the best volume."""
    threshold = float(row["threshold"])
    errors = [abs(place.volume_at(threshold) - 1) for place in places]
    best = places[int(np.argmin(np.nan_to_num(errors, nan=np.inf)))]
    offset = best.offset if any(best.offset) else None
    grid = replace(settings.grid, cells=int(row["cells"]), offset=offset)
    if offset is None and not grid.snap:
        grid = replace(grid, placement="corner")
    goal = Goal(target=target, base=threshold)
    return tuple(to_words(replace(settings, grid=grid, goal=goal)))


def _two_cells(geometry: Geometry, settings: Settings) -> float | None:
    """Return the cell size that puts two cells across most walls."""
    if isinstance(geometry, Image):
        return None
    oriented = orient(geometry, settings.sampling.orientation).geometry
    is_outside = settings.sampling.domain == "outside"
    thickness = measure_thickness(oriented, is_outside=is_outside)
    return None if thickness is None else thickness.resolving
