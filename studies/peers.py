"""Tusqh beside other programs on the same dirty surfaces, each in a process with a time limit."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import tusqh
from studies.peer_meshers import NOT_INSTALLED
from studies.solids import describe_solid, measure_fit
from tusqh.geometry.soup import Soup
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Policy

FINISHED, MISSING = "finished", "not installed"

#: Significant digits that are kept: fTetWild makes another mesh every time, so more would be noise.
_DIGITS = {"pytetwild": 1}

#: Where the process looks for modules: a folder for tests to put a peer in, and this package.
_FIRST_ON_PATH = ""
_PROJECT = str(Path(tusqh.__file__).parent.parent)

_TIMES = ("seconds", "processor_seconds")

#: Time on the clock per processor time that a process may take: a hang uses none of the latter.
_PATIENCE = 10

#: Columns of the table of peers, in their order.
COLUMNS = ["model", "peer", "status", "kind", "manifold", "betti_0", "betti_1", "betti_2"]
COLUMNS += ["volume_error", "worst_scaled_jacobian"]
COLUMNS += ["boundary_mean", "boundary_max", "surface_mean", "surface_max"]


def run_peer(
    peer: str,
    soup: Soup,
    fractions: VolumeFractions,
    policy: Policy,
    *,
    threshold: float,
    is_clamped: bool,
    seconds: int,
    name: str,
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what a peer makes of a surface, and how long it took.

    Parameters
    ----------
    peer
        One of `studies.peer_meshers.PEERS`.
    soup
        The surface, as it is.
    fractions
        Our fractions of it: grid, kept cells and volume.
    policy
        The model's policy.
    threshold
        Its threshold.
    is_clamped
        Whether its samples are clipped to [0, 1].
    seconds
        Limit on processor time; on the clock it is `_PATIENCE` times as long.
    name
        The model.

    Returns
    -------
    row
        `COLUMNS`: status (finished, not installed, not finished in time, or how it failed), what
        `studies.solids.describe_solid` finds, the volume over the winding-number
        volume less one, and distances in cells of our grid.
    timing
        `model`, `peer`, `status`, `elements`, `seconds` and `processor_seconds` in the call
        alone.  Not the same twice.
    """
    grid = fractions.grid
    given = {
        "points": soup.points,
        "triangles": soup.triangles,
        "cell_size": grid.cell_size,
        "origin": np.array(grid.origin),
        "kept": fractions.cells >= threshold,
        "threshold": threshold,
        "samples": fractions.samples,
        "is_clamped": is_clamped,
        "min_cells": policy.components.min_cells,
    }
    status, made = _run_apart(peer, given, seconds)
    row: dict[str, Any] = {"model": name, "peer": peer, "status": status}
    timing = {**row, "elements": pd.NA, **dict.fromkeys(_TIMES, float("nan"))}
    if made is not None:
        points, cells = made["points"], made["cells"]
        found = describe_solid(points, cells, cell_size=grid.cell_size)
        timing["elements"] = found.pop("elements")
        timing |= {key: round(float(made[key]), 3) for key in _TIMES}
        fit = measure_fit(points, cells, soup)
        measures = {
            **found,
            "volume_error": found.pop("volume") / fractions.volume() - 1,
            **{key: distance / grid.cell_size for key, distance in fit.items()},
        }
        digits = _DIGITS.get(peer, 4)
        row |= {key: _to_digits(value, digits) for key, value in measures.items()}
    return {key: row.get(key) for key in COLUMNS}, timing


def _run_apart(
    peer: str, given: dict[str, Any], seconds: int
) -> tuple[str, dict[str, np.ndarray] | None]:
    """Return how a peer ended in a process of its own, and what it made."""
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "given.npz", Path(folder) / "made.npz"
        np.savez(source, **given)
        command = [sys.executable, "-m", "studies.peer_meshers", peer]
        try:
            done = subprocess.run(
                [*command, str(source), str(target), str(seconds)],
                capture_output=True,
                text=True,
                timeout=_PATIENCE * seconds,
                cwd=folder,  # fTetWild leaves files where it runs.
                env={**os.environ, "PYTHONPATH": f"{_FIRST_ON_PATH}{os.pathsep}{_PROJECT}"},
            )
        except subprocess.TimeoutExpired:
            return f"not finished in {seconds} s", None
        if done.returncode == -signal.SIGXCPU:
            return f"not finished in {seconds} s", None
        if done.returncode == NOT_INSTALLED:
            return MISSING, None
        if done.returncode < 0:
            return f"crashed with signal {-done.returncode}", None
        if done.returncode > 0:
            last = (done.stderr.strip().splitlines() or ["no message"])[-1]
            return f"failed: {last[:120]}", None
        with np.load(target) as content:
            made = {key: content[key] for key in content.files}
    return (FINISHED, made) if len(made["cells"]) else ("failed: no element", None)


def compare_with_peers(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row per peer: how often it does as well as we do, and where it is better.

    Parameters
    ----------
    table
        Rows of `run_peer`.

    Returns
    -------
    summary
        `peer`; `models`, `finished`; of the finished ones how many are `manifold` and have the
        `same_topology` as our mesh; in how many the boundary lies nearer to the surface than
        ours (`nearer_boundary`), the surface nearer to the boundary (`nearer_surface`), the
        volume nearer to the winding-number volume (`nearer_volume`), and the worst element is
        better (`better_worst_element`); the medians of the distances, in cells.
    """
    betti = ["betti_0", "betti_1", "betti_2"]
    ours = table[table["peer"] == "tusqh"].set_index("model")
    rows = []
    for peer, of_peer in table.groupby("peer", sort=False):
        done = of_peer[of_peer["status"] == FINISHED].set_index("model")
        beside = ours.loc[done.index]
        rows.append(
            {
                "peer": peer,
                "models": len(of_peer),
                "finished": len(done),
                "manifold": int(done["manifold"].astype(bool).sum()),
                "same_topology": int((done[betti] == beside[betti]).all(axis=1).sum()),
                "nearer_boundary": int((done["boundary_mean"] < beside["boundary_mean"]).sum()),
                "nearer_surface": int((done["surface_mean"] < beside["surface_mean"]).sum()),
                "nearer_volume": int(
                    (done["volume_error"].abs() < beside["volume_error"].abs()).sum()
                ),
                "better_worst_element": int(
                    (done["worst_scaled_jacobian"] > beside["worst_scaled_jacobian"]).sum()
                ),
                "median_boundary_mean": done["boundary_mean"].median(),
                "median_surface_mean": done["surface_mean"].median(),
            }
        )
    return pd.DataFrame(rows)


def _to_digits(value: Any, digits: int) -> Any:
    """Return a number with so many significant digits, anything else as it is.

    >>> _to_digits(0.123456, 2), _to_digits("hexes", 1), _to_digits(12, 1)
    (0.12, 'hexes', 12)
    """
    return float(f"{value:.{digits}g}") if isinstance(value, float) else value
