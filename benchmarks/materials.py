"""From an image of labels to a checked mesh of all grains: ``python -m benchmarks.materials``.

The labels are polycrystals, each voxel that of the nearest of some seeds.  The table has the
time, and the number of grains that are not manifolds in this mesh and in a mesh of the plain
voxels, which programs write that take voxels as they are.
"""

from __future__ import annotations

import argparse
import importlib.util
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.measure import measure
from tusqh.contacts import MaterialMesh, fractions_of_labels, mesh_materials
from tusqh.meshes.measure_regions import measure_regions
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.tables import write_csv

RESULT = Path("results/benchmarks/materials.csv")

#: Voxels along each side, and grains.
CASES = ((32, 20), (64, 20), (128, 100))


def polycrystal(side: int, n_grains: int) -> np.ndarray:
    """Return the labels of a polycrystal, made as the model `polycrystal` is."""
    path = Path("data_sources/polycrystal/derive.py")
    spec = importlib.util.spec_from_file_location("derive", path)
    derive = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(derive)
    return derive.grains(side, n_grains)


def mesh_and_check(labels: np.ndarray) -> MaterialMesh:
    """Mesh the labels and check every grain, all of them together and every element."""
    found = mesh_materials(fractions_of_labels(labels))
    if not found.is_as_predicted:
        raise SystemExit("a grain is not as predicted")
    return found


def plain_voxels(labels: np.ndarray) -> VolumeMesh:
    """Return the voxels as hexes that share their corners."""
    steps = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    steps = np.concatenate([steps, steps + np.array([0, 0, 1])])
    shape = tuple(n + 1 for n in labels.shape)
    corners = np.argwhere(np.ones(labels.shape, dtype=bool))[:, None] + steps
    cells = np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), shape)
    points = np.argwhere(np.ones(shape, dtype=bool)).astype(float)
    return VolumeMesh.from_arrays(points, cells)


def row(side: int, n_grains: int) -> dict[str, object]:
    """Return the row of a polycrystal."""
    labels = polycrystal(side, n_grains)
    cost = measure(polycrystal, mesh_and_check, (8, 4), side, n_grains)
    found = mesh_and_check(labels)
    alone = measure_regions(plain_voxels(labels), labels.ravel().astype(np.int64) - 1, n_grains)
    return {
        "voxels": f"{side}^3",
        "grains": n_grains,
        "hexes": found.mesh.n_cells,
        "contacts": found.n_contacts,
        "overruled": found.n_overruled,
        "seconds": round(cost.seconds, 2),
        "peak_gb": round(cost.peak_gb, 2),
        "broken_grains": sum(m.n_non_manifold > 0 for m in found.measured.values()),
        "broken_grains_plain": sum(m.n_non_manifold > 0 for m in alone),
        "broken_points_plain": sum(m.n_non_manifold for m in alone),
    }


def main() -> None:
    """Measure, print and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--largest", type=int, default=128, help="voxels along a side (128)")
    largest = parser.parse_args().largest
    table = pd.DataFrame([row(*case) for case in CASES if case[0] <= largest])
    print(table.to_string(index=False))
    write_csv(RESULT, table)


if __name__ == "__main__":
    main()
