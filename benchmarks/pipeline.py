"""The whole of `tusqh.mesh`, stage by stage: ``python -m benchmarks.pipeline``.

Each case runs in a fresh process, after a small mesh that compiles or loads everything.  Stages are
those that `tusqh.mesh` reports, and the total is their sum.  `seconds` pass by a clock, and
`processor_seconds` add up those of all cores, which other programs disturb less; `load` is the load
average of the machine before the case.  The report, the file and its certificate follow, which
`tusqh.mesh` leaves out until they are asked for, then curves, the persistence diagram and other
programs, which need too much memory on large grids.  These do comparable steps on the same data in
the same process: automesh makes hexes of the kept cells without resolving pinches, gudhi and
cripser pair the cells without sub-cells (a smaller complex), pymeshlab examines the boundary, VTK
measures the elements, and meshio and VTK write the points and elements alone.

The table keeps the rows of cases that were measured before and not now.
"""

from __future__ import annotations

import argparse
import importlib.util
import multiprocessing
import os
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pandas as pd
import psutil

import tusqh
from benchmarks.meshing import BUNNY, THRESHOLD, mesh_automesh
from benchmarks.topology import curves_cubical, pair, pair_cripser, tabulate_curves
from tusqh.certificate import make_certificate
from tusqh.pipeline.result import Result
from tusqh.progress import Report
from tusqh.quality.surface import surface_measures
from tusqh.sampling.io import save_fractions
from tusqh.tables import write_csv

RESULT = Path("results/benchmarks/pipeline.csv")
COLUMNS = [
    *("model", "cells", "goal", "stage", "seconds", "processor_seconds", "peak_gb"),
    *("kept_cells", "elements", "load"),
]
GOALS: dict[str, dict[str, Any]] = {
    "threshold 1/2": {"threshold": THRESHOLD},
    "betti (1, 0, 0)": {"betti": (1, 0, 0)},
}


class Stages:
    """Seconds and peak memory of stages, each of which lasts until the next one begins.

    The memory is the resident memory of the process, less what it had before the first stage.
    """

    def __init__(self) -> None:
        self.rows: list[tuple[str, float, float, float]] = []
        self._memory = psutil.Process(os.getpid()).memory_info
        self._base = self._memory().rss
        self._done = threading.Event()
        self._watcher = threading.Thread(target=self._watch, daemon=True)
        self._begin("start")
        self._watcher.start()

    def __call__(self, what: str) -> Report:
        """Begin a stage, as the argument `progress` of `tusqh.mesh`."""
        self._end()
        self._begin(what)
        return lambda done, total: None

    def stop(self) -> None:
        """End the last stage."""
        self._end()
        self._done.set()
        self._watcher.join()

    def _begin(self, what: str) -> None:
        self._what, self._peak = what, self._memory().rss
        self._started = time.perf_counter(), time.process_time()

    def _end(self) -> None:
        seconds = time.perf_counter() - self._started[0]
        of_processor = time.process_time() - self._started[1]
        peak = max(self._peak, self._memory().rss)
        self.rows.append((self._what, seconds, of_processor, max(peak - self._base, 0) / 1e9))

    def _watch(self) -> None:
        while not self._done.wait(0.002):
            self._peak = max(self._peak, self._memory().rss)


def run_case(cells: int, goal: str, peers: bool) -> pd.DataFrame:
    """Return the rows of one case; the total comes last and is that of `tusqh.mesh` alone."""
    load = os.getloadavg()[0]
    small = tusqh.mesh(BUNNY, cells=12, **GOALS[goal])
    stages = Stages()
    result = tusqh.mesh(BUNNY, cells=cells, progress=stages, **GOALS[goal])
    stages.stop()
    _, seconds, of_processor, peaks = zip(*stages.rows, strict=True)
    total = ("total", sum(seconds), sum(of_processor), max(peaks))
    after = Stages()
    show(result, after)
    if peers:
        run_peers(small, lambda what: None)
        run_peers(result, after)
    after.stop()
    rows = [row for row in (*stages.rows, *after.rows, total) if row[0] != "start"]
    table = pd.DataFrame(rows, columns=["stage", "seconds", "processor_seconds", "peak_gb"])
    facts = {
        "model": result.name,
        "cells": cells,
        "goal": goal,
        "kept_cells": result.built.facts["cells_kept"],
        "elements": result.mesh.n_cells,
        "load": load,
    }
    return table.assign(**facts)[COLUMNS].round(4)


def show(result: Result, stages: Stages) -> None:
    """Print the report, and write the mesh and its certificate, which measures the file."""
    stages("report")
    str(result.report)
    with tempfile.TemporaryDirectory() as folder:
        stages("file, by meshio")
        path, fractions = Path(folder) / "mesh.vtu", Path(folder) / "fractions.npz"
        result.write(path)
        stages("file of fractions")
        save_fractions(fractions, result.fractions)
        stages("certificate")
        cells = result.built.resolved.cells
        make_certificate(result.selection, cells, path, fractions, name=result.name)


def run_peers(result: Result, begin: Callable[[str], object]) -> None:
    """Count and pair the classes, and do comparable steps with other programs."""
    values = result.fractions.values
    begin("Betti numbers of all thresholds")
    tabulate_curves(values)
    begin("persistence diagram")
    pair(values)
    begin("gudhi, cells only: diagram and Betti numbers")
    curves_cubical(values)
    if importlib.util.find_spec("cripser"):
        begin("cripser, cells only: diagram")
        pair_cripser(values)
    if importlib.util.find_spec("automesh"):
        begin("automesh: mesh")
        mesh_automesh(result.fractions)
    begin("pymeshlab: checks of the boundary")
    surface_measures(result.mesh)
    begin("VTK: Jacobians of the elements")
    mesh = result.mesh.to_pyvista()
    mesh.cell_quality("scaled_jacobian")
    with tempfile.TemporaryDirectory() as folder:
        begin("VTK: file")
        mesh.save(Path(folder) / "vtk.vtu")
        begin("meshio: file")
        meshio.vtu.write(Path(folder) / "meshio.vtu", result.mesh.to_meshio(), binary=True)


def in_fresh_process(function: Callable[..., pd.DataFrame], *arguments: Any) -> pd.DataFrame:
    """Return the result of a call in a new process."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(function, arguments)


def with_others(table: pd.DataFrame, path: Path) -> pd.DataFrame:
    """Return a table after the rows of a file that belong to other cases."""
    case = ["model", "cells", "goal"]
    if not path.is_file():
        return table
    stored = pd.read_csv(path)
    measured = set(table[case].itertuples(index=False, name=None))
    others = [row not in measured for row in stored[case].itertuples(index=False, name=None)]
    both = pd.concat([stored[others], table], ignore_index=True)
    return both.sort_values(
        ["model", "goal", "cells"], ascending=[True, False, True], kind="stable"
    )


def to_markdown(table: pd.DataFrame) -> str:
    """Return the processor time of each stage, a row, in each case, a column, and the memory."""
    cases = table.assign(case=table["goal"] + ", " + table["cells"].astype(str) + " cells")
    wide = cases.pivot_table("processor_seconds", "stage", "case", aggfunc="sum", sort=False)
    memory = cases[cases["stage"] == "total"].set_index("case")["peak_gb"]
    of_mesh = [
        list(dict.fromkeys(stages))[: list(dict.fromkeys(stages)).index("report")]
        for _, stages in cases.groupby("case")["stage"]
    ]
    order = [*max(of_mesh, key=len), *(stage for stage in wide.index if stage != "total"), "total"]
    wide = wide.reindex(list(dict.fromkeys(order)))
    words = wide.map(lambda seconds: "-" if pd.isna(seconds) else f"{seconds:.3g} s")
    words.loc["memory"] = [f"{memory[case]:.2g} GB" for case in words.columns]
    return words.rename_axis("stage").reset_index().to_markdown(index=False)


def main() -> None:
    """Measure, print and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--cells",
        type=int,
        nargs="+",
        default=[64, 128],
        metavar="N",
        help="cells along the longest side of the bunny (64 128; 256 and 512 take minutes)",
    )
    parser.add_argument("--goals", nargs="+", choices=list(GOALS), default=list(GOALS))
    parser.add_argument(
        "--no-peers", action="store_true", help="leave out the diagram and other programs"
    )
    given = parser.parse_args()
    for name in ("automesh", "cripser"):
        if not given.no_peers and not importlib.util.find_spec(name):
            print(f"{name} is not installed, so it is left out: pip install -e '.[peers]'")
    tables = []
    for cells in given.cells:
        for goal in given.goals:
            peers = not given.no_peers and goal == given.goals[0]
            tables.append(in_fresh_process(run_case, cells, goal, peers))
            print(tables[-1].to_string(index=False), flush=True)
    table = pd.concat(tables, ignore_index=True)
    totals = table[(table["stage"] == "total") & (table["goal"] == given.goals[0])]
    if len(totals) > 1:
        columns = totals[["kept_cells", "processor_seconds"]]
        power = np.polyfit(*np.log(columns.to_numpy().T), 1)[0]
        print(f"total: processor seconds grow with kept cells to the power {power:.2f}")
    write_csv(RESULT, with_others(table, RESULT))
    print(to_markdown(table))


if __name__ == "__main__":
    main()
