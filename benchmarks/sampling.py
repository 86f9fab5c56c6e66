"""Volume fractions against dense libigl: ``python -m benchmarks.sampling``.

libigl evaluates every sample, soups by `igl.fast_winding_number` (its tree) and outlines by
`igl.winding_number`; it is timed on a random subset and scaled.  Ours is everything from the soup
to rounded fractions of all dimensions.  Seconds are medians of five runs after a warm-up.  Errors
are those of cell fractions before rounding, against exact `igl.winding_number` on 2,000 random
cells, half of them on the boundary.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import igl
import numpy as np
import pandas as pd

from benchmarks.measure import measure
from tusqh.figures import style
from tusqh.geometry.kinds import Surface
from tusqh.geometry.outline import Outline
from tusqh.geometry.packaged import locate
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid, FloatArray
from tusqh.readers.files import read_file
from tusqh.sampling.field import make_field
from tusqh.sampling.fractions import VolumeFractions, sample_fractions
from tusqh.sampling.lattice import Lattice
from tusqh.sampling.layout import lay_grid
from tusqh.settings.sampling import Sampling
from tusqh.tables import write_csv

RESULT = Path("results/benchmarks/sampling.csv")
SAMPLES, REPEATS, CELLS = 4, 5, 2000
#: Number of samples on which libigl is timed, by dimension.
SUBSET = {2: 30_000, 3: 400_000}
BUNNY = "package:pymeshlab/tests/sample_meshes/bunny.obj"
COLUMNS = ["model", "n", "s", "ours_seconds", "other", "other_seconds", "ratio", "max_error"]
COLUMNS += ["ours_peak_gb", "cap", "required_ratio", "required_error"]

#: Model, cells along its longest side, required ratio and largest error allowed.
CASES = [
    ("bunny", 64, 80, 1e-12),
    ("bunny", 128, 150, 1e-12),
    ("bunny", 256, 200, 1e-12),
    *((name, 96, 40, 1e-8) for name in ("dragon", "bearings", "cow", "bones", "mannequin-devil")),
    *((name, 96, 10, 1e-6) for name in ("airplane", "elephant-with-holes", "lion")),
    ("bunny damaged", 96, 10, 1e-6),
    ("loose sheets", 96, 1, 1e-6),
    ("bunny exploded", 96, 1, 1e-6),
    ("chesapeake", 316, 200, 1e-10),
]
FILES = {
    "bunny": BUNNY,
    "dragon": "data_sources/dragon/dragon.off",
    "bearings": "data_sources/solids/bearings.stl",
    "cow": "package:pymeshlab/tests/sample_meshes/cow.obj",
    "airplane": "package:pyvista/examples/airplane.ply",
    "chesapeake": "data_sources/chesapeake/counties.geojson",
    **{f: f"data_sources/zoo/{f}.off" for f in ("bones", "mannequin-devil", "elephant-with-holes")},
    "lion": "data_sources/zoo/lion.off",
}


def damaged_bunny() -> Soup:
    """Return the bunny with a tenth of its triangles flipped and another tenth removed."""
    bunny = read_file(locate(BUNNY)).geometry
    assert isinstance(bunny, Soup)
    rng = np.random.default_rng(0)
    triangles = bunny.triangles.copy()
    is_flipped = rng.random(len(triangles)) < 0.1
    triangles[is_flipped] = triangles[is_flipped][:, ::-1]
    return _soup(bunny.points, triangles[rng.random(len(triangles)) >= 0.1])


def exploded_bunny() -> Soup:
    """Return the bunny with every triangle shrunk by a tenth, so that every edge is a boundary."""
    bunny = read_file(locate(BUNNY)).geometry
    assert isinstance(bunny, Soup)
    corners = bunny.points[bunny.triangles]
    middle = corners.mean(axis=1, keepdims=True)
    points = (middle + 0.9 * (corners - middle)).reshape(-1, 3)
    return _soup(points, np.arange(len(points)).reshape(-1, 3))


def loose_sheets() -> Soup:
    """Return 1,500 randomly placed parallelograms that cross one another."""
    rng = np.random.default_rng(1)
    start = rng.random((1500, 1, 3))
    u, v = rng.normal(size=(2, 1500, 1, 3)) * 0.1
    points = np.concatenate([start, start + u, start + u + v, start + v], axis=1).reshape(-1, 3)
    first = 4 * np.arange(1500)[:, None]
    return _soup(points, np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])]))


def _soup(points: FloatArray, triangles: np.ndarray) -> Soup:
    return Soup(points, triangles, np.zeros(len(triangles), dtype=np.int64))


MADE: dict[str, Callable[[], Surface]] = {
    "bunny damaged": damaged_bunny,
    "bunny exploded": exploded_bunny,
    "loose sheets": loose_sheets,
}


def geometry_of(name: str) -> Surface:
    """Return the geometry of a case."""
    return MADE[name]() if name in MADE else read_file(locate(FILES[name])).geometry


def prepare(name: str, n: int) -> tuple[Surface, BackgroundGrid]:
    """Return a geometry and its grid."""
    geometry = geometry_of(name)
    return geometry, lay_grid(geometry, None, cells=n)


def sample(case: tuple[Surface, BackgroundGrid]) -> VolumeFractions:
    """Sample the fractions of all dimensions."""
    return sample_fractions(*case, sampling=Sampling(samples=SAMPLES))


def main() -> None:
    """Measure, print and write the table and the plot."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--largest", type=int, default=512, help="cells of the bunny (512)")
    largest = parser.parse_args().largest
    rows = [_compare(*case) for case in CASES if case[0] != "bunny" or case[1] <= largest]
    growth = _grow(largest)
    write_csv(RESULT, pd.DataFrame(rows + growth, columns=COLUMNS))
    style.save(_draw(pd.DataFrame(rows), pd.DataFrame(growth)), RESULT.with_suffix(".png"))


def _compare(name: str, n: int, required_ratio: float, required_error: float) -> dict:
    geometry, grid = prepare(name, n)
    sample((geometry, grid))  # Compile what this kind of geometry needs.
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        sample((geometry, grid))
        seconds.append(time.perf_counter() - start)
    other = grid.n_cells * SAMPLES**grid.dim / _rate_of_libigl(geometry, grid)
    ours = statistics.median(seconds)
    field = make_field(geometry)
    row = {
        "model": name,
        "n": n,
        "s": SAMPLES,
        "ours_seconds": round(ours, 4),
        "other": "igl.winding_number" if grid.dim == 2 else "igl.fast_winding_number",
        "other_seconds": round(other, 2),
        "ratio": round(other / ours, 1),
        "max_error": _largest_error(geometry, grid),
        "ours_peak_gb": round(measure(prepare, sample, (name, 8), name, n).peak_gb, 3),
        "cap": len(field.cap),  # type: ignore[attr-defined]
        "required_ratio": required_ratio,
        "required_error": required_error,
    }
    return _print(row)


def _grow(largest: int) -> list[dict]:
    """Return rows for the bunny at growing sizes, each measured in a separate process."""
    rows = []
    for n in (n for n in (64, 128, 256, 512) if n <= largest):
        cost = measure(prepare, sample, ("bunny", 8), "bunny", n)
        row = {"model": "bunny, growth", "n": n, "s": SAMPLES, "cap": 0}
        row |= {"ours_seconds": round(cost.seconds, 4), "ours_peak_gb": round(cost.peak_gb, 3)}
        rows.append(_print(row))
    if len(rows) > 1:
        n, t = np.log([[row["n"], row["ours_seconds"]] for row in rows]).T
        print(f"sampling: seconds grow with n to the power {np.polyfit(n, t, 1)[0]:.2f}")
    return rows


def _print(row: dict) -> dict:
    print("  ".join(f"{key} {value}" for key, value in row.items()), flush=True)
    return row


def _rate_of_libigl(geometry: Surface, grid: BackgroundGrid) -> float:
    """Return the median of three rates in samples per second, without building the tree."""
    rng = np.random.default_rng(0)
    queries = grid.to_points(rng.random((SUBSET[grid.dim], grid.dim)) * np.array(grid.shape))
    if isinstance(geometry, Outline):
        call, simplices = igl.winding_number, geometry.segments
    else:
        call, simplices = igl.fast_winding_number, geometry.triangles
    net = []
    for _ in range(3):
        start = time.perf_counter()
        call(geometry.points, simplices, queries[:1])
        middle = time.perf_counter()
        call(geometry.points, simplices, queries)
        net.append(time.perf_counter() - middle - (middle - start))
    return len(queries) / statistics.median(net)


def _largest_error(geometry: Surface, grid: BackgroundGrid) -> float:
    """Return the largest error over random cells, half of them on the boundary."""
    lattice = Lattice.over_grid(grid, SAMPLES)
    sums = make_field(geometry).sums(lattice, 0, int(lattice.n_blocks[0]))
    pairs = [2, 1 if grid.dim == 2 else 2, 2]
    blocked = [k for n, p in zip(sums.shape, pairs, strict=True) for k in (n // p, p)]
    cells = sums.reshape(blocked).sum(axis=(1, 3, 5)).reshape(grid.shape) / SAMPLES**grid.dim
    rng = np.random.default_rng(1)
    on_boundary = np.argwhere((np.abs(cells) > 0.01) & (np.abs(cells) < 0.99))
    chosen = on_boundary[rng.integers(0, len(on_boundary), CELLS // 2)]
    chosen = np.concatenate([chosen, rng.integers(0, cells.shape, (CELLS // 2, grid.dim))])
    offsets = (np.indices((SAMPLES,) * grid.dim).reshape(grid.dim, -1).T + 0.5) / SAMPLES
    queries = grid.to_points((chosen[:, None] + offsets).reshape(-1, grid.dim))
    origin = np.array(grid.origin)
    simplices = geometry.segments if isinstance(geometry, Outline) else geometry.triangles
    exact = igl.winding_number(geometry.points - origin, simplices, queries - origin)
    exact = exact.reshape(CELLS, -1).mean(axis=1)
    return float(np.abs(cells[tuple(chosen.T)] - exact).max())


def _draw(rows: pd.DataFrame, growth: pd.DataFrame) -> object:
    """Draw ratios over errors, and seconds over cells."""
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.5), layout="constrained")
    left.scatter(
        rows["max_error"].clip(lower=1e-16), rows["ratio"], color=style.DIMENSION_COLOURS[0]
    )
    for row in rows.itertuples():
        left.annotate(
            f"{row.model} {row.n}", (max(row.max_error, 1e-16), row.ratio), fontsize=7,
            xytext=(4, 3), textcoords="offset points",
        )  # fmt: skip
    left.set(xscale="log", yscale="log", xlabel="largest error of a cell fraction [-]")
    left.set_xlim(1e-16, 1e-3)
    left.set_ylabel("times faster than dense libigl [-]")
    left.axhline(1, color="0.5", linewidth=0.8)
    right.plot(
        growth["n"], growth["ours_seconds"], "o-", color=style.DIMENSION_COLOURS[0], label="seconds"
    )
    right.plot(
        growth["n"],
        growth["ours_peak_gb"],
        "s--",
        color=style.DIMENSION_COLOURS[1],
        label="peak GB",
    )
    right.set(xscale="log", yscale="log", xlabel="cells along the longest side of the bunny")
    right.set_ylabel("seconds [s], memory [GB]")
    right.set_xticks(growth["n"], growth["n"].astype(str))
    right.minorticks_off()
    right.legend()
    return figure


if __name__ == "__main__":
    main()
