import numpy as np
import pytest
from fields import make_fractions, random_fractions

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.errors import TopologyError
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.checks import check_mesh
from tusqh.settings.policy import Criteria, Policy


def cells_at(fractions, threshold, **criteria):
    """Return the cells at a threshold without bridges, which other tests cover."""
    policy = Policy(bridges="none", **{k: Criteria(**v) for k, v in criteria.items()})
    return CellSets(fractions, policy).at(threshold)


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
    cells = cells_at(fractions, 0.5, components={"min_cells": min_cells})
    assert cells.predicted == (betti_0, 0, 0)
    assert cells.features["cells"].tolist() == removed_cells
    mesh = build_mesh(cells, fractions.grid).mesh
    assert betti_by_euler(mesh) == (betti_0, 0, 0)


def test_a_removed_component_leaves_a_full_row():
    vertices = VERTICES.copy()
    vertices[6, 6] = 0.75  # One corner of the speck is interior.
    removed = cells_at(make_fractions(CELLS, vertices), 0.5, components={"min_cells": 2}).features
    row = removed.iloc[0].to_dict()
    assert row["feature"] == "component"
    assert row["persistence"] == 0.5
    assert row["cells"] == 1
    assert row["volume"] == 1.0
    assert row["largest_fraction"] == 0.5
    assert row["interior_sub_cells"] == 1
    assert (row["x"], row["y"]) == (6.5, 6.5)


def test_a_filled_hole_leaves_a_full_row_and_its_islands_merge():
    """There are a lake of 5 x 5 cells with an island, and a shallower pond of one cell."""
    cells = np.ones((9, 9))
    cells[1:6, 1:6] = 0.125
    cells[3, 3] = 0.75
    cells[7, 7] = 0.25
    fractions = make_fractions(cells)
    assert cells_at(fractions, 0.5).predicted == (2, 2, 0)
    filled = cells_at(fractions, 0.5, holes={"min_cells": 2})
    assert filled.predicted == (2, 1, 0)
    row = filled.features.iloc[0].to_dict()
    assert (row["feature"], row["cells"], row["volume"]) == ("hole", 1, 1.0)
    assert (row["persistence"], row["smallest_fraction"]) == (0.75, 0.25)
    assert (row["x"], row["y"]) == (7.5, 7.5)
    longest = cells_at(fractions, 0.5, holes={"keep": 1})
    assert longest.features["cells"].tolist() == [1]
    none = cells_at(fractions, 0.5, holes={"keep": 0})
    assert none.predicted == (1, 0, 0)
    assert none.features["cells"].tolist() == [24, 1]
    for cells in (filled, longest, none):
        assert betti_by_boundary(build_mesh(cells, fractions.grid).mesh) == cells.predicted


def test_components_go_by_volume_and_by_persistence():
    fractions = make_fractions(CELLS)
    by_volume = cells_at(fractions, 0.5, components={"min_volume": 2.5})
    assert by_volume.features["cells"].tolist() == [2, 1]
    by_life = cells_at(fractions, 0.5, components={"min_persistence": 0.75})
    assert by_life.features["persistence"].tolist() == [0.5]
    assert cells_at(fractions, 0.5, components={"keep": 2}).features["cells"].tolist() == [1]


def test_a_hole_that_no_threshold_closes_lives_longest():
    cells = np.ones((7, 4))
    cells[1:3, 1:3], cells[4:6, 1:3] = 0.0, 0.25
    kept = cells_at(make_fractions(cells), 0.5, holes={"keep": 1})
    assert kept.predicted == (1, 1, 0)
    assert kept.features["smallest_fraction"].tolist() == [0.25]


def test_voids_in_the_plane_are_refused():
    with pytest.raises(TopologyError, match="`voids` of a 2D model"):
        cells_at(make_fractions(CELLS), 0.5, voids={"min_cells": 2})


def test_dropping_leaves_a_manifold_mesh_with_the_predicted_topology():
    for seed in range(400):
        rng = np.random.default_rng(seed)
        fractions = random_fractions(rng, tuple(rng.integers(3, 12, 2)))
        threshold = rng.choice([0.25, 0.5, 0.75])
        all_cells = cells_at(fractions, threshold)
        components, holes = {"min_cells": int(rng.integers(2, 6))}, {}
        if seed % 2:
            holes = {"min_cells": int(rng.integers(1, 4)), "min_persistence": rng.choice([0, 0.5])}
        cells = cells_at(fractions, threshold, components=components, holes=holes)
        mesh = build_mesh(cells, fractions.grid).mesh
        assert betti_by_euler(mesh) == betti_by_boundary(mesh) == cells.predicted, seed
        assert all(check.holds for check in check_mesh(mesh)), seed
        n_removed = cells.n_removed
        if not holes:
            assert cells.predicted.betti_0 == all_cells.predicted.betti_0 - n_removed, seed
        gone = cells.features.groupby("feature")["cells"].sum()
        balance = gone.get("hole", 0) - gone.get("component", 0)
        assert cells.kept.sum() == all_cells.kept.sum() + balance, seed
