"""Bridges in space run along interior edges and change the topology as predicted."""

import numpy as np
import pytest

import tusqh
from tusqh.antialias.bridges import ACCEPTED, bridge_columns
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.antialias.scheme import PINCH_TEMPLATES
from tusqh.grid import BackgroundGrid
from tusqh.local_topology.move import move_to_base
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Criteria, Policy


def fractions_of(values):
    shape = tuple(n // 2 for n in values.shape)
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0, 0.0, 0.0))
    return VolumeFractions.from_values(grid, 4, values)


def two_cubes(*edges):
    """Return two cubes of eight cells, two cells apart, and interior edges with inner vertices."""
    values = np.zeros((17, 9, 9))
    values[1::2, 1::2, 1::2][1:3, 1:3, 1:3] = 1
    values[1::2, 1::2, 1::2][5:7, 1:3, 1:3] = 1
    for start, end in edges:
        low, high = 2 * np.minimum(start, end), 2 * np.maximum(start, end)
        inside = tuple(slice(a, b + 1) for a, b in zip(low, high, strict=True))
        values[inside] = np.maximum(values[inside], 0.75)
    return fractions_of(values)


def measured(cells):
    mesh = build_mesh(cells, cells.fractions.grid).mesh
    assert mesh.measurement.is_sound
    assert mesh.measurement.has_topology(cells.predicted)
    assert PINCH_TEMPLATES.allows(mesh.measurement.smallest_scaled_jacobian, mesh)
    return tuple(mesh.measurement.by_boundary)


STRAIGHT, BENT = [((3, 2, 2), (5, 2, 2))], [((3, 1, 1), (4, 1, 1)), ((4, 1, 1), (4, 3, 1))]
BENT = [*BENT, ((4, 3, 1), (5, 3, 1))]


@pytest.mark.parametrize(("edges", "n_edges"), [(STRAIGHT, 2), (BENT, 4)])
def test_an_interior_path_joins_two_cubes(edges, n_edges):
    for mode, betti in (("none", (2, 0, 0)), ("forest", (1, 0, 0)), (None, (2, 0, 0))):
        cells = CellSets(two_cubes(*edges), Policy(bridges=mode)).at(0.5)
        assert measured(cells) == betti
    cells = CellSets(two_cubes(*edges), Policy(bridges="forest")).at(0.5)
    assert list(cells.bridge_table.columns) == bridge_columns(3)
    (row,) = cells.bridge_table.to_dict("records")
    assert (row["kind"], row["edges"], row["status"]) == ("path", n_edges, ACCEPTED)
    assert (row["x_a"], row["x_b"]) == (3, 5)
    assert row["cells_a"] == row["cells_b"] == 8


def test_all_paths_make_a_hole_and_a_forest_does_not():
    fractions = two_cubes(*STRAIGHT, *BENT)
    assert measured(CellSets(fractions, Policy(bridges="forest")).at(0.5)) == (1, 0, 0)
    assert measured(CellSets(fractions, Policy(bridges="all")).at(0.5)) == (1, 1, 0)


def test_a_bridge_goes_with_the_component_at_its_end():
    fractions = two_cubes(*STRAIGHT)
    values = fractions.values.copy()
    values[1::2, 1::2, 1::2][6, 1:3, 1:3] = values[1::2, 1::2, 1::2][5, 2] = 0.0
    fractions = fractions_of(values)
    policy = Policy(bridges="forest", components=Criteria(min_cells=10))
    joined = CellSets(fractions, policy).at(0.5)
    assert measured(joined) == (1, 0, 0)  # Joined, it has 8 and 2 cells.
    policy = Policy(bridges="none", components=Criteria(min_cells=3))
    assert measured(CellSets(fractions, policy).at(0.5)) == (1, 0, 0)


@pytest.mark.parametrize("mode", ["forest", "all"])
def test_random_fields_have_the_predicted_topology(mode):
    n_bridges = n_moved = 0
    for seed in range(16):
        rng = np.random.default_rng(seed)
        shape = tuple(int(n) for n in rng.integers(4, 7, 3))
        values = rng.random(tuple(2 * n + 1 for n in shape))
        is_cell = (slice(1, None, 2),) * 3
        values[is_cell] *= rng.random(shape) < 0.3
        values[tuple(slice(None, None, 2) for _ in range(3))] += 0.2
        fractions = fractions_of(np.round(np.clip(values, 0, 1) * 8) / 8)
        cell_sets = CellSets(fractions, Policy(bridges=mode))
        plain = CellSets(fractions, Policy(bridges="none"))
        for threshold in (0.375, 0.625):
            cells, before = cell_sets.at(threshold), plain.at(threshold)
            betti = measured(cells)
            n = cells.n_bridges
            if mode == "forest":
                assert betti == (before.predicted.betti_0 - n, *before.predicted[1:])
            assert betti[0] - betti[1] == before.predicted[0] - before.predicted[1] - n
            found = move_to_base(cells, cell_sets.at(0.5))
            assert measured(found) == betti
            n_moved += int((found.kept != cells.kept).sum())
            n_bridges += n
    assert n_bridges > 40
    assert n_moved > 20


def test_the_command_never_ignores_bridges_in_space():
    corners = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]])
    points = np.concatenate([corners, corners + np.array([0.0, 0, 2])])
    quads = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    triangles = [[q[0], q[k], q[k + 1]] for q in quads for k in (1, 2)]
    result = tusqh.mesh((points, triangles), cells=4, bridges="forest", name="cube")
    assert result.report.is_met
    assert not any("bridges" in str(remark) for remark in result.report.remarks)
