"""The 3D templates are right in every neighbourhood and on random fields with random votes."""

import itertools

import numpy as np
import pytest
from fields import decide_votes, fractions_of_votes, random_votes
from oracles import gudhi_betti
from skimage.measure import label

from tusqh.antialias.pinches import find_pinch_edges, find_pinches, pinch_table
from tusqh.antialias.resolve import build_mesh
from tusqh.grid import BackgroundGrid
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.checks import check_mesh
from tusqh.meshes.jacobians import smallest_jacobians
from tusqh.meshes.volume_mesh import SIDE_BALL
from tusqh.topology.topology import Topology

#: The bounds of algorithm 4.4 on cubic cells: at balls on sides of the grid, and elsewhere.
ON_SIDES, BOUND = 0.39, 1 / np.sqrt(3) - 1e-12
N_FIELDS = 400


def mesh_of(kept, votes):
    """Return the decided cells and their mesh."""
    cells = decide_votes(kept, votes)
    grid = BackgroundGrid(shape=kept.shape, cell_size=1.0, origin=(0.0, 0.0, 0.0))
    return cells, build_mesh(cells, grid).mesh


def check_everything(cells, mesh, case):
    assert [c.name for c in check_mesh(mesh) if not c.holds] == [], case
    assert betti_by_euler(mesh) == betti_by_boundary(mesh) == cells.predicted, case
    bound = np.where(mesh.kind == SIDE_BALL, ON_SIDES, BOUND)
    assert (smallest_jacobians(mesh.points, mesh.cells)[1] >= bound).all(), case


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
        cells, mesh = mesh_of(kept, connect)
        check_everything(cells, mesh, code)
        assert cells.predicted == gudhi_betti(mesh.cells), code
        assert cells.n_overruled == 0, code
        if not pinches.any():
            assert mesh.n_cells == kept.sum()
        else:
            n_resolved += 1
            expected = label(kept, connectivity=3 if connect else 1).max()
            assert cells.predicted.betti_0 == expected, code
    assert n_resolved >= 128


@pytest.mark.parametrize(
    "start", [0, *(pytest.param(s, marks=pytest.mark.slow) for s in range(200, N_FIELDS, 200))]
)
def test_random_fields_with_random_votes(start):
    for seed in range(start, start + 200):
        rng = np.random.default_rng(seed)
        shape = tuple(int(n) for n in rng.integers(4, 9, 3))
        kept = rng.random(shape) < rng.uniform(0.05, 0.95)
        votes = random_votes(rng, shape)
        cells, mesh = mesh_of(kept, votes)
        check_everything(cells, mesh, seed)
        assert cells.n_overruled == 0, seed
        if seed % 10 == 0:
            assert cells.predicted == gudhi_betti(mesh.cells), seed
        topology = Topology(fractions_of_votes(kept, votes).multiples)
        assert cells.predicted == topology.betti_at(0.5), seed


def test_rotations_and_reflections_give_the_rotated_topology():
    """The Betti numbers do not depend on the numbering of cells."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        kept = rng.random((4, 3, 5)) < 0.2
        votes = random_votes(rng, kept.shape)
        cells, _ = mesh_of(kept, votes)
        for axes in itertools.permutations(range(3)):
            other, _ = mesh_of(kept.transpose(axes)[::-1], votes.transpose(axes)[::-1])
            assert other.n_contacts == cells.n_contacts
            assert other.predicted == cells.predicted, seed


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
