"""From fractions to a resolved hex mesh and its checks: ``python -m benchmarks.meshing``.

`automesh` (a Rust program with a Python package) makes hexes of the same voxels in the same run.
It resolves no pinch and checks nothing: its mesh consists of the unmodified kept cells.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import ndimage

from benchmarks.measure import FIELDS, Cost, compare, growth, measure
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.geometry.packaged import locate
from tusqh.grid import BackgroundGrid
from tusqh.meshes.measure import measure as measure_mesh
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.readers.files import read_file
from tusqh.sampling.fractions import VolumeFractions, round_fractions, sample_fractions
from tusqh.sampling.layout import lay_grid
from tusqh.tables import write_csv

RESULT = Path("results/benchmarks/meshing.csv")
BUNNY = "package:pymeshlab/tests/sample_meshes/bunny.obj"
THRESHOLD = 0.5


def smooth_noise(n: int) -> VolumeFractions:
    """Return a smooth random field on n^3 cells, half of which are kept."""
    values = ndimage.gaussian_filter(
        np.random.default_rng(0).standard_normal((2 * n + 1,) * 3), sigma=4
    )
    return _on_grid(0.5 + values / values.std() / 4)


def white_noise(n: int) -> VolumeFractions:
    """Return a field with pinches everywhere on n^3 cells, half of which are kept."""
    return _on_grid(np.random.default_rng(0).random((2 * n + 1,) * 3))


def bunny(n: int) -> VolumeFractions:
    """Return the fractions of the bunny with n cells along its longest side."""
    geometry = read_file(locate(BUNNY)).geometry
    return sample_fractions(geometry, lay_grid(geometry, None, cells=n))


def mesh_ours(fractions: VolumeFractions) -> VolumeMesh:
    """Make the resolved mesh."""
    return build_mesh(CellSets(fractions).at(THRESHOLD), fractions.grid).mesh


def mesh_automesh(fractions: VolumeFractions) -> object:
    """Make the unresolved mesh of the same cells with automesh, without writing it."""
    from automesh import Voxels

    kept = (fractions.cells >= THRESHOLD).astype(np.uint8)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "voxels.npy"
        np.save(path, kept)
        return Voxels.from_npy(str(path)).as_finite_elements(
            remove=[0], scale=[1.0, 1.0, 1.0], translate=[0.0, 0.0, 0.0]
        )


def check_ours(mesh: VolumeMesh) -> object:
    """Run every check of a mesh that the verification table reports."""
    measured = measure_mesh(mesh)
    return (
        measured.checks,
        measured.by_euler,
        measured.by_boundary,
        measured.smallest_scaled_jacobian,
    )


def finished(name: str, n: int) -> VolumeMesh:
    """Return the finished mesh of a field."""
    return mesh_ours(_FIELDS[name](n))


def _on_grid(values: np.ndarray) -> VolumeFractions:
    grid = BackgroundGrid(
        shape=tuple(n // 2 for n in values.shape), cell_size=1.0, origin=(0.0, 0.0, 0.0)
    )
    return VolumeFractions.from_values(grid, 4, round_fractions(np.clip(values, 0.0, 1.0)))


_FIELDS = {"smooth noise": smooth_noise, "white noise": white_noise, "bunny": bunny}


def main() -> None:
    """Measure, print and write the table; `cells` are the kept ones."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--largest", type=int, default=128, help="cells along a side (128)")
    largest = parser.parse_args().largest
    cases = [("smooth noise", n) for n in (32, 64, 128) if n <= largest]
    cases += [("white noise", min(64, largest)), ("bunny", largest)]
    rows = []
    for name, n in cases:
        field = _FIELDS[name]
        n_kept = int((field(n).cells >= THRESHOLD).sum())
        other = _cost_of_automesh(field, n)
        ours = measure(field, mesh_ours, (8,), n)
        rows.append(compare(f"mesh: {name} {n}", n_kept, ours, "automesh", other))
        checks = measure(finished, check_ours, (name, 8), name, n)
        rows.append(compare(f"checks: {name} {n}", n_kept, checks))
    of_smooth = [row for row in rows if row["case"].startswith("mesh: smooth")]
    if len(of_smooth) > 1:
        print(f"meshing: seconds grow with kept cells to the power {growth(of_smooth):.2f}")
    write_csv(RESULT, pd.DataFrame(rows, columns=FIELDS))


def _cost_of_automesh(field: object, n: int) -> Cost | None:
    try:
        import automesh  # noqa: F401
    except ImportError:
        print("automesh is not installed: pip install automesh==0.3.1")
        return None
    return measure(field, mesh_automesh, (8,), n)  # type: ignore[arg-type]


if __name__ == "__main__":
    main()
