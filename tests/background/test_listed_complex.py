"""The complex of a background: Betti curves by union-find, by gudhi, and those of the grid."""

from itertools import pairwise

import gudhi
import numpy as np
import pytest
from backgrounds import backgrounds, random_values, ring_of_three

from tusqh.background.curves import BackgroundTopology, count_euler
from tusqh.background.makers import make_box
from tusqh.background.node_values import NodeValues, clamp
from tusqh.background.simplices import list_simplices
from tusqh.grid import doubled
from tusqh.topology.clamping import FULL
from tusqh.topology.topology import Topology

NAMES = ["box", "cylinder", "lattice", "triangles"]


@pytest.fixture(scope="module")
def meshes():
    return backgrounds()


def betti_by_gudhi(simplices, values, level):
    """Return the Betti numbers of the nodes with at least a value."""
    tree = gudhi.SimplexTree()
    for rows in simplices:
        inside = rows[(values[rows] >= level).all(axis=1)]
        if len(inside):
            tree.insert_batch(inside.T.astype(np.int32), np.zeros(len(inside)))
    tree.compute_persistence(persistence_dim_max=True)
    return tuple([*tree.betti_numbers(), 0, 0, 0][:3])


@pytest.mark.parametrize("name", NAMES)
def test_union_find_counts_what_gudhi_counts_on_the_listed_complex(meshes, name):
    background, rng = meshes[name], np.random.default_rng(1)
    simplices = list_simplices(background)
    for _ in range(6):
        values = random_values(rng, background)
        topology = BackgroundTopology(background, values)
        nodes = topology.values.all()
        levels = np.unique(nodes[nodes > 0])
        for level in levels:
            expected = betti_by_gudhi(simplices, nodes, level)
            assert tuple(topology.betti_at(level / FULL)) == expected
        curves = topology.curves
        betti = curves[["betti_0", "betti_1", "betti_2"]].to_numpy()
        assert (betti @ [1, -1, 1] == curves["euler"]).all()


@pytest.mark.parametrize("name", NAMES)
def test_the_euler_characteristic_counts_every_listed_simplex_once(meshes, name):
    background = meshes[name]
    values = clamp(background, random_values(np.random.default_rng(2), background))
    nodes, change = values.all(), np.zeros(FULL + 1, dtype=np.int64)
    for k, rows in enumerate(list_simplices(background)):
        np.add.at(change, nodes[rows].min(axis=1), (-1) ** k)
    assert (count_euler(background, values)[1:] == change[1:]).all()


def test_every_face_of_a_listed_simplex_is_listed(meshes):
    for background in meshes.values():
        simplices = list_simplices(background)
        for lower, upper in pairwise(simplices):
            known = set(map(tuple, lower.tolist()))
            for drop in range(upper.shape[1]):
                assert set(map(tuple, np.delete(upper, drop, axis=1).tolist())) <= known


def test_three_hexes_around_a_hole_have_a_hole():
    ring = ring_of_three()
    values = NodeValues(
        *[np.full(n, FULL, dtype=np.int32) for n in (3, ring.n_edges, ring.n_points)]
    )
    assert tuple(BackgroundTopology(ring, values).betti_at(1.0)) == (1, 1, 0)
    simplices = list_simplices(ring)
    assert betti_by_gudhi(simplices, values.all(), 1) == (1, 1, 0)
    # As a flag complex, the three hexes would be a triangle.
    assert [len(rows) for rows in simplices][:3] == [3, 3, 0]


def as_background(values):
    """Return a grid and the values on its doubled grid as a background."""
    dim = values.ndim
    shape = tuple((n - 1) // 2 for n in values.shape)
    background = make_box((0,) * dim, shape, shape)
    multiples = np.rint(values * FULL).astype(np.int32)
    own = [multiples[doubled.cells(dim)].ravel(), multiples[doubled.vertices(dim)].ravel()]
    edges = np.zeros(0, dtype=np.int32)
    if dim == 3:
        twice = (2 * background.points[background.edge_ends].mean(axis=1)).astype(int)
        edges = multiples[tuple(twice.T)]
    return background, NodeValues(own[0], edges, own[1])


@pytest.mark.parametrize("shape", [(5, 4), (4, 3, 5), (6, 5, 4)])
def test_a_grid_as_background_has_the_topology_of_the_grid(shape):
    rng = np.random.default_rng(3)
    for n_levels in (2, 3, 6, 40):
        values = rng.integers(0, n_levels, [2 * n + 1 for n in shape]) / (n_levels - 1)
        # A background has no values on its rim.
        for axis in range(len(shape)):
            values[(slice(None),) * axis + ([0, -1],)] = 0.0
        on_grid = Topology.from_fractions(values)
        listed = BackgroundTopology(*as_background(values))
        assert list(listed.curves["upper"]) == list(on_grid.curves["upper"])
        assert listed.curves.equals(on_grid.curves)
        by_cell = zip(listed.persistence_by_cell, on_grid.persistence_by_cell, strict=True)
        for ours, theirs in by_cell:
            assert (ours == theirs.ravel()).all()


def test_the_inner_rim_of_a_shell_encloses_a_void():
    block = make_box((0, 0, 0), (3, 3, 3), (3, 3, 3))
    shell = type(block)(block.points, np.delete(block.cells, 13, axis=0))
    sizes = shell.n_cells, shell.n_edges, shell.n_points
    full = [np.full(n, FULL, dtype=np.int32) for n in sizes]
    assert tuple(BackgroundTopology(shell, NodeValues(*full)).betti_at(0.5)) == (1, 0, 1)
    full[0][4] = 0  # The cell in the middle of a side opens it.
    assert tuple(BackgroundTopology(shell, NodeValues(*full)).betti_at(0.5)) == (1, 0, 0)
