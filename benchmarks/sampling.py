"""Volume fractions of solids against dense libigl: ``python -m benchmarks.sampling``.

libigl evaluates every sample by `igl.fast_winding_number`; it is timed on a random subset and
scaled.  Errors are those of cell fractions against exact `igl.winding_number` on random cells, half
of them boundary cells.
"""

from __future__ import annotations

import statistics
import time
from pathlib import Path

import igl
import numpy as np
import pandas as pd

from tusqh.geometry.files import locate, read_geometry
from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray
from tusqh.sampling.fractions import VolumeFractions, sample_fractions
from tusqh.sampling.layout import lay_grid
from tusqh.tables import write_csv

RESULT = Path("results/benchmarks/sampling.csv")
SAMPLES = 4
REPEATS = 5
#: Samples that libigl is timed on, and cells whose error is measured.
SUBSET, CELLS = 400_000, 300

CASES = [
    ("bunny", "package:pymeshlab/tests/sample_meshes/bunny.obj", (64, 128, 256)),
    ("dragon", "data_sources/dragon/dragon.off", (96,)),
    ("bearings", "data_sources/solids/bearings.stl", (96,)),
    ("cow", "package:pymeshlab/tests/sample_meshes/cow.obj", (96,)),
    ("airplane", "package:pyvista/examples/airplane.ply", (64,)),
]


def main() -> None:
    """Measure, print and write the table."""
    rows = []
    for name, geometry, sizes in CASES:
        soup = read_geometry(locate(geometry))
        assert isinstance(soup, Soup)
        sample_fractions(soup, lay_grid(soup, None, cells=8))  # Compiles.
        for n in sizes:
            grid = lay_grid(soup, None, cells=n)
            seconds = []
            for _ in range(REPEATS):
                start = time.perf_counter()
                fractions = sample_fractions(soup, grid, orientation="as-is")
                seconds.append(time.perf_counter() - start)
            rate = _rate_of_libigl(soup, fractions)
            other = grid.n_cells * SAMPLES**3 / rate
            ours = statistics.median(seconds)
            row = {
                "model": name,
                "n": n,
                "s": SAMPLES,
                "ours_seconds": round(ours, 4),
                "other": "igl.fast_winding_number",
                "other_seconds": round(other, 2),
                "ratio": round(other / ours, 1),
                "max_error": _largest_error(soup, fractions),
            }
            print("  ".join(f"{key} {value}" for key, value in row.items()), flush=True)
            rows.append(row)
    write_csv(RESULT, pd.DataFrame(rows))


def _rate_of_libigl(soup: Soup, fractions: VolumeFractions) -> float:
    """Return samples per second, the time to build its tree left out."""
    rng = np.random.default_rng(0)
    grid = fractions.grid
    queries = grid.to_points(rng.random((SUBSET, 3)) * np.array(grid.shape))
    one = queries[:1]
    start = time.perf_counter()
    igl.fast_winding_number(soup.points, soup.triangles, one)
    tree = time.perf_counter() - start
    start = time.perf_counter()
    igl.fast_winding_number(soup.points, soup.triangles, queries)
    return SUBSET / (time.perf_counter() - start - tree)


def _largest_error(soup: Soup, fractions: VolumeFractions) -> float:
    """Return the largest error over random cells, half of them on the boundary."""
    rng = np.random.default_rng(1)
    cells = fractions.cells
    on_boundary = np.argwhere((cells > 0.01) & (cells < 0.99))
    chosen = on_boundary[rng.integers(0, len(on_boundary), CELLS // 2)]
    chosen = np.concatenate([chosen, rng.integers(0, cells.shape, (CELLS // 2, 3))])
    offsets: FloatArray = (np.indices((SAMPLES,) * 3).reshape(3, -1).T + 0.5) / SAMPLES
    queries = fractions.grid.to_points((chosen[:, None] + offsets).reshape(-1, 3))
    exact = igl.winding_number(soup.points, soup.triangles, queries)
    exact = exact.reshape(CELLS, -1).mean(axis=1)
    # Fractions are stored as multiples of 2^-20: that rounding is no error of the method.
    found = cells[tuple(chosen.T)]
    return float(np.maximum(np.abs(found - exact) - 2.0**-21, 0.0).max())


if __name__ == "__main__":
    main()
