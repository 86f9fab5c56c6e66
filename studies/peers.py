"""Compare Tusqh with other programs on dirty surfaces, each in a process with a time limit."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import tusqh
from studies.methods.solids import describe_solid, measure_fit
from studies.peer_meshers import NOT_INSTALLED
from tusqh.geometry.soup import Soup
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.model import Settings
from tusqh.threshold.selection import Selection

FINISHED, MISSING = "finished", "not installed"

#: Number of significant digits for a peer, 4 by default.  fTetWild's meshes differ from run to run,
#: so further digits would be noise.
_DIGITS = {"pytetwild": 1}

#: The folder of the packages `tusqh` and `studies`.
_PROJECT = Path(tusqh.__file__).parent.parent

_TIMES = ("seconds", "processor_seconds")

#: Ratio of the limit on elapsed time to that on processor time, for processes that hang.
_PATIENCE = 10

#: Columns of the table of peers.
PEER_COLUMNS = [
    "model",
    "peer",
    "status",
    "kind",
    "manifold",
    "betti_0",
    "betti_1",
    "betti_2",
    "volume_error",
    "worst_scaled_jacobian",
    "boundary_mean",
    "boundary_max",
    "surface_mean",
    "surface_max",
]


def run_peer(
    peer: str,
    soup: Soup,
    fractions: VolumeFractions,
    selection: Selection,
    *,
    settings: Settings,
    seconds: int,
    name: str,
    python_path: Sequence[Path] = (),
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Mesh a surface with a peer in a separate process, and measure the mesh and the time.

    Parameters
    ----------
    peer
        One of `studies.peer_meshers.PEERS`.
    soup
        The surface.
    fractions
        Volume fractions of the surface, for the grid, the kept cells and the volume.
    selection
        The threshold and the policy of the model.
    settings
        The grid, the window and the sampling of the model.
    seconds
        Limit on processor time in s; the limit on elapsed time is `_PATIENCE` times as large.
    name
        The model.
    python_path
        Folders in which the process looks for modules before all others.

    Returns
    -------
    row
        A row with the columns `PEER_COLUMNS`: status (finished, not installed, not finished in
        time, or the failure), the measures of `studies.methods.solids.describe_solid`, the ratio of
        the volume to the winding-number volume minus one, and distances in cells of our grid.
    timing
        `model`, `peer`, `status`, `elements`, `seconds` and `processor_seconds` of the call alone,
        which differ from run to run.
    """
    grid = fractions.grid
    given = {
        "points": soup.points,
        "triangles": soup.triangles,
        "parts": soup.parts,
        "cell_size": grid.cell_size,
        "origin": np.array(grid.origin),
        "kept": fractions.cells >= selection.threshold,
        "settings": json.dumps(settings.to_dict()),
        "selection": json.dumps(selection.to_dict()),
    }
    status, made = _run_apart(peer, given, seconds, python_path)
    row: dict[str, Any] = {"model": name, "peer": peer, "status": status}
    timing = {**row, "elements": pd.NA, **dict.fromkeys(_TIMES, float("nan"))}
    if made is not None:
        timing |= {key: round(float(made[key]), 3) for key in _TIMES}
        measures = _measure(made["points"], made["cells"], soup, fractions)
        timing["elements"] = measures.pop("elements")
        digits = _DIGITS.get(peer, 4)
        row |= {key: _to_digits(value, digits) for key, value in measures.items()}
    return {key: row.get(key) for key in PEER_COLUMNS}, timing


def _measure(
    points: np.ndarray, cells: np.ndarray, soup: Soup, fractions: VolumeFractions
) -> dict[str, Any]:
    """Return the measures of a solid for the table of peers, and its number of `elements`."""
    size = fractions.grid.cell_size
    found = describe_solid(points, cells, cell_size=size)
    volume_error = found.pop("volume") / fractions.volume() - 1
    distances = {key: distance / size for key, distance in measure_fit(points, cells, soup).items()}
    return {**found, "volume_error": volume_error, **distances}


def _run_apart(
    peer: str, given: dict[str, Any], seconds: int, python_path: Sequence[Path]
) -> tuple[str, dict[str, np.ndarray] | None]:
    """Run a peer in a separate process, and return its status and its arrays."""
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "given.npz", Path(folder) / "made.npz"
        np.savez(source, **given)
        command = [sys.executable, "-m", "studies.peer_meshers", peer]
        path = os.pathsep.join(map(str, [*python_path, _PROJECT]))
        try:
            done = subprocess.run(
                [*command, str(source), str(target), str(seconds)],
                capture_output=True,
                text=True,
                timeout=_PATIENCE * seconds,
                cwd=folder,  # fTetWild writes files to its working folder.
                env={**os.environ, "PYTHONPATH": path},
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
    """Return one row per peer that counts how often it matches our mesh and how often it is better.

    Parameters
    ----------
    table
        The rows that `run_peer` returned.

    Returns
    -------
    summary
        `peer`; the numbers of `models` and of `finished` ones; among the finished ones, the number
        that are `manifold`, and that have the `same_topology` as our mesh; the number in which,
        compared with our mesh, the boundary is nearer to the surface (`nearer_boundary`), the
        surface nearer to the boundary (`nearer_surface`), the volume nearer to the winding-number
        volume (`nearer_volume`), and the worst element better (`better_worst_element`); the medians
        of the distances, in cells.
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
    """Return a number rounded to significant digits; other values do not change.

    >>> _to_digits(0.123456, 2), _to_digits("hexes", 1), _to_digits(12, 1)
    (0.12, 'hexes', 12)
    """
    return float(f"{value:.{digits}g}") if isinstance(value, float) else value
