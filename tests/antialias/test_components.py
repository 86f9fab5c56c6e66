import numpy as np
import pytest
from conftest import make_fractions, random_fractions

from tusqh.antialias.resolve import keep_cells, resolve
from tusqh.mesh.betti import betti_by_boundary, betti_by_euler
from tusqh.mesh.checks import check_mesh

# A block of six cells, a pair that only the vertex between it and the block joins, and a speck.
CELLS = np.zeros((8, 8))
CELLS[1:3, 1:4] = 1.0
CELLS[3:5, 4] = 0.75
CELLS[6, 6] = 0.5
VERTICES = np.zeros((9, 9))


@pytest.mark.parametrize(
    ("joint", "min_cells", "betti_0", "removed_cells"),
    [(0.0, 1, 3, []), (0.0, 2, 2, [1]), (0.0, 3, 1, [2, 1]), (0.5, 3, 1, [1]), (0.5, 9, 0, [8, 1])],
)
def test_components_are_counted_with_the_effective_decisions(
    joint, min_cells, betti_0, removed_cells
):
    vertices = VERTICES.copy()
    vertices[3, 4] = joint
    fractions = make_fractions(CELLS, vertices)
    cells = keep_cells(fractions, threshold=0.5, min_cells=min_cells)
    assert cells.predicted == (betti_0, 0, 0)
    assert cells.removed["cells"].tolist() == removed_cells
    mesh, _ = resolve(cells.kept, cells.decisions, fractions.grid)
    assert betti_by_euler(mesh) == (betti_0, 0, 0)


def test_a_removed_component_leaves_a_full_row():
    vertices = VERTICES.copy()
    vertices[6, 6] = 0.75  # One corner of the speck is interior.
    removed = keep_cells(make_fractions(CELLS, vertices), threshold=0.5, min_cells=2).removed
    row = removed.iloc[0].to_dict()
    assert row["cells"] == 1
    assert row["volume"] == 1.0
    assert row["largest_fraction"] == 0.5
    assert row["interior_sub_cells"] == 1
    assert (row["x"], row["y"]) == (6.5, 6.5)


def test_removal_leaves_a_manifold_mesh_with_the_predicted_topology():
    for seed in range(400):
        rng = np.random.default_rng(seed)
        fractions = random_fractions(rng, tuple(rng.integers(3, 12, 2)))
        threshold = rng.choice([0.25, 0.5, 0.75])
        all_cells = keep_cells(fractions, threshold=threshold)
        cells = keep_cells(fractions, threshold=threshold, min_cells=int(rng.integers(2, 6)))
        mesh, _ = resolve(cells.kept, cells.decisions, fractions.grid)
        assert betti_by_euler(mesh) == betti_by_boundary(mesh) == cells.predicted, seed
        assert cells.predicted.betti_0 == all_cells.predicted.betti_0 - len(cells.removed), seed
        assert all(check.holds for check in check_mesh(mesh)), seed
        assert cells.kept.sum() + cells.removed["cells"].sum() == all_cells.kept.sum(), seed
