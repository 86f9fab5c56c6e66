"""Local changes of the topology on smooth noise: ``python -m benchmarks.local_topology``.

The field is white noise, smoothed over two cells, whose cells at 1/2 fill half of the grid and have
hundreds of tunnels.  `local scope` moves the cells of 0.6 towards those of 1/2; `classes` lists the
classes of the diagram with their places (the diagram itself is part of the selection, and is not
counted); `prices` lists what `tusqh mesh --results` does;
`solver` reaches a target with one component fewer and two tunnels fewer than at 1/2.  Processor
seconds add up those of all cores, which other programs disturb less than those of a clock.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy import ndimage

from tusqh.antialias.cells import CellSets
from tusqh.grid import BackgroundGrid
from tusqh.local_topology.features import Features
from tusqh.local_topology.move import move_to_base
from tusqh.local_topology.prices import affordable_rows, tabulate_prices
from tusqh.local_topology.solver import solve
from tusqh.sampling.fractions import VolumeFractions, round_fractions
from tusqh.settings.goal import Target
from tusqh.settings.policy import Policy
from tusqh.tables import write_csv
from tusqh.threshold.goals import distance_to

RESULT = Path("results/benchmarks/local_topology.csv")
BASE, SEED = 0.5, 0.6


def smooth_noise(n: int, sigma: float = 4.0) -> CellSets:
    """Return the cell sets of a smooth random field on n^3 cells."""
    values = np.random.default_rng(0).standard_normal((2 * n + 1,) * 3)
    values = ndimage.gaussian_filter(values, sigma)
    values = np.clip(0.5 + 0.25 * values / values.std(), 0, 1)
    grid = BackgroundGrid((n,) * 3, 1.0, (0.0,) * 3)
    fractions = VolumeFractions.from_values(grid, 4, round_fractions(values))
    return CellSets(fractions, Policy(bridges="none"))


def run_case(n: int) -> list[dict[str, Any]]:
    """Return the rows of one grid."""
    sets, rows = smooth_noise(n), []

    def timed(what: str, call: Callable[[], Any], about: Callable[[Any], str]) -> Any:
        start, of_processor = time.perf_counter(), time.process_time()
        found = call()
        spent = time.process_time() - of_processor
        row = {"case": what, "cells": n**3, "seconds": round(time.perf_counter() - start, 3)}
        rows.append(row | {"processor_seconds": round(spent, 3), "about": about(found)})
        print(rows[-1], flush=True)
        return found

    seed, base = sets.at(SEED), sets.at(BASE)
    differ = int((seed.kept != base.kept).sum())
    timed(
        "local scope",
        lambda: move_to_base(seed, base),
        lambda found: f"{differ:,} cells between seed and base, {found.n_changes:,} differ",
    )
    _ = sets.topology.pairs
    features = timed(
        "classes",
        lambda: Features(sets, BASE),
        lambda found: f"{len(found.classes):,} classes, {found.classes['is_there'].sum():,} there",
    )
    prices = timed(
        "prices",
        lambda: tabulate_prices(features, affordable_rows(features)),
        lambda found: f"{len(found):,} ways, {found['possible'].sum():,} possible",
    )
    betti = features.start().betti
    target = Target(max(1, betti.betti_0 - 1), betti.betti_1 - 2, betti.betti_2)
    timed(
        "solver",
        lambda: solve(features, features.start(), distance_to(target)),
        lambda found: f"from {betti} to {found.done.betti}, distance {found.distance:g}",
    )
    assert len(prices)
    return rows


def main() -> None:
    """Measure, print and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--largest", type=int, default=128, help="cells along a side (128)")
    largest = parser.parse_args().largest
    run_case(12)
    rows = [row for n in (32, 64, 128) if n <= largest for row in run_case(n)]
    write_csv(RESULT, pd.DataFrame(rows))


if __name__ == "__main__":
    main()
