"""The 3D templates are right in every neighbourhood and on random fields with random decisions."""

import itertools

import numpy as np
import pytest
from oracles import gudhi_betti

from tusqh.antialias.clusters import CONNECT, SEPARATE, decide_by_vote
from tusqh.antialias.pinches import find_pinch_edges, find_pinches, pinch_table
from tusqh.antialias.resolve import resolve
from tusqh.grid import BackgroundGrid
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.checks import check_mesh
from tusqh.meshes.jacobians import element_volumes, smallest_jacobians
from tusqh.topology.effective import effective_betti

#: The bound of algorithm 4.5 on cubic cells.
BOUND = 1 / np.sqrt(3) - 1e-12
N_FIELDS = 2000
POLICIES = ("separate", "connect", "majority")


def mesh_of(kept, decisions):
    grid = BackgroundGrid(shape=kept.shape, cell_size=1.0, origin=(0.0, 0.0, 0.0))
    return resolve(kept, decisions, grid)


def check_everything(kept, decisions, mesh, case):
    predicted = effective_betti(
        kept, decisions.at_vertex == CONNECT, decisions.at_vertex == SEPARATE
    )
    assert [c.name for c in check_mesh(mesh) if not c.holds] == [], case
    assert betti_by_euler(mesh) == betti_by_boundary(mesh) == predicted, case
    assert smallest_jacobians(mesh.points, mesh.cells)[1].min(initial=1.0) >= BOUND, case
    return predicted


def neighbourhood(code):
    cells = [code >> b & 1 for b in range(8)]
    return np.array(cells, dtype=bool).reshape(2, 2, 2).transpose(2, 1, 0)


@pytest.mark.parametrize("connect", [True, False])
def test_all_254_mixed_neighbourhoods(connect):
    n_resolved = 0
    for code in range(1, 255):
        kept = neighbourhood(code)
        pinches = find_pinches(kept)
        assert pinches[1, 1, 1] == pinch_table(3)[code]
        decisions = decide_by_vote(pinches, np.full(pinches.shape, connect))
        mesh, _ = mesh_of(kept, decisions)
        predicted = check_everything(kept, decisions, mesh, code)
        assert predicted == gudhi_betti(mesh.cells), code
        if not pinches.any():
            assert mesh.n_cells == kept.sum()
        else:
            n_resolved += 1
            grown = element_volumes(mesh.points, mesh.cells).sum() - kept.sum()
            assert (grown > 0) == connect, code
    assert n_resolved >= 128


@pytest.mark.parametrize("start", range(0, N_FIELDS, 200))
def test_random_fields_with_random_decisions(start):
    for seed in range(start, start + 200):
        rng = np.random.default_rng(seed)
        shape = tuple(int(n) for n in rng.integers(4, 9, 3))
        kept = rng.random(shape) < rng.uniform(0.05, 0.95)
        pinches = find_pinches(kept)
        votes = rng.random(pinches.shape) < rng.random()
        decisions = decide_by_vote(pinches, votes, mixed_pinches=POLICIES[seed % 3])
        mesh, rounds = mesh_of(kept, decisions)
        predicted = check_everything(kept, decisions, mesh, seed)
        assert rounds <= 3
        if seed % 20 == 0:
            assert predicted == gudhi_betti(mesh.cells), seed


def test_rotations_and_reflections_give_the_rotated_mesh():
    """Compare the centroids of all elements, except after closing, which breaks ties by index."""
    n_compared = 0
    for seed in range(30):
        rng = np.random.default_rng(seed)
        kept = rng.random((5, 4, 6)) < 0.4
        pinches = find_pinches(kept)
        decisions = decide_by_vote(pinches, rng.random(pinches.shape) < 0.5)
        mesh, rounds = mesh_of(kept, decisions)
        if rounds:
            continue
        n_compared += 1
        for axes in itertools.permutations(range(3)):
            turned = kept.transpose(axes)[::-1]
            at_vertex = decisions.at_vertex.transpose(axes)[::-1]
            connects = at_vertex == CONNECT
            other, _ = mesh_of(turned, decide_by_vote(at_vertex != 0, connects))
            points = mesh.points[:, axes].copy()
            points[:, 0] = turned.shape[0] - points[:, 0]
            expected = points[mesh.cells].mean(axis=1)
            found = other.points[other.cells].mean(axis=1)
            assert np.allclose(
                *(np.round(c[np.lexsort(np.round(c, 6).T)], 6) for c in (expected, found))
            )
    assert n_compared > 15


def test_a_pinch_edge_is_a_diagonal_of_its_four_cells():
    rng = np.random.default_rng(1)
    kept = rng.random((4, 5, 3)) < 0.5
    padded = np.pad(kept, 1)
    for axis in range(3):
        across = [k for k in range(3) if k != axis]
        for place in np.ndindex(find_pinch_edges(kept, axis).shape):
            four = []
            for offset in itertools.product((0, 1), repeat=2):
                index = np.array(place)
                index[axis] += 1
                index[across] += offset
                four.append(bool(padded[tuple(index)]))
            is_pinch = four in ([True, False, False, True], [False, True, True, False])
            assert find_pinch_edges(kept, axis)[place] == is_pinch
