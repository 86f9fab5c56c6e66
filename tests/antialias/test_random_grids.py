"""Random grids with random decisions give manifold meshes with the predicted topology."""

import numpy as np
import pytest
from oracles import betti_by_rank
from skimage.measure import euler_number, label

from tusqh.antialias.clusters import CONNECT, SEPARATE, Decisions, decide_by_vote
from tusqh.antialias.pinches import find_pinches
from tusqh.antialias.resolve import resolve
from tusqh.errors import MeshError
from tusqh.grid import BackgroundGrid
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.checks import check_mesh
from tusqh.meshes.jacobians import smallest_jacobians
from tusqh.topology.effective import effective_betti

N_GRIDS = 2500
POLICIES = ("separate", "connect", "majority")


def random_case(seed):
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(2, 9, 2))
    kept = rng.random(shape) < rng.uniform(0.05, 0.95)
    pinches = find_pinches(kept)
    votes = rng.random(pinches.shape) < rng.random()
    decisions = decide_by_vote(pinches, votes, mixed_pinches=POLICIES[seed % 3])
    return kept, decisions, BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0, 0.0))


@pytest.mark.parametrize("start", range(0, N_GRIDS, 500))
def test_meshes_of_random_grids(start):
    for seed in range(start, start + 500):
        kept, decisions, grid = random_case(seed)
        mesh, rounds = resolve(kept, decisions, grid, name=f"seed {seed}")
        predicted = effective_betti(
            kept, decisions.at_vertex == CONNECT, decisions.at_vertex == SEPARATE
        )
        assert betti_by_rank(mesh.cells) == predicted, seed
        assert betti_by_euler(mesh) == betti_by_boundary(mesh) == predicted, seed
        assert all(check.holds for check in check_mesh(mesh)), seed
        scaled = smallest_jacobians(mesh.points, mesh.cells)[1]
        assert scaled.min(initial=1.0) >= np.sqrt(0.5) - 1e-12, seed
        assert rounds == 0, seed


@pytest.mark.parametrize("connectivity", [1, 2])
def test_one_decision_everywhere_is_scikit_images_connectivity(connectivity):
    """Separating all pinches gives 4-connectivity, and connecting all gives 8-connectivity."""
    for seed in range(300):
        kept, _, grid = random_case(seed)
        pinches = find_pinches(kept)
        decisions = decide_by_vote(pinches, np.full(pinches.shape, connectivity == 2))
        mesh, _ = resolve(kept, decisions, grid)
        n_components = int(label(kept, connectivity=connectivity).max())
        euler = euler_number(kept, connectivity=connectivity)
        assert betti_by_euler(mesh) == (n_components, n_components - euler, 0)


def test_decisions_that_break_the_cluster_rule_are_refused():
    """Opposite decisions at adjacent pinches are an error, never a silent non-manifold result."""
    rng = np.random.default_rng(7)
    n_refused = 0
    for _ in range(400):
        kept = rng.random((7, 7)) < 0.5
        pinches = find_pinches(kept)
        at_vertex = np.where(rng.random(pinches.shape) < 0.5, CONNECT, SEPARATE).astype(np.int8)
        at_vertex[~pinches] = 0
        grid = BackgroundGrid(shape=kept.shape, cell_size=1.0, origin=(0.0, 0.0))
        try:
            mesh, _ = resolve(kept, Decisions(at_vertex, 0, 0, 0), grid, name="broken rule")
        except MeshError as error:
            n_refused += error.where == "broken rule"
        else:
            assert all(check.holds for check in check_mesh(mesh))
    assert 10 < n_refused < 200


@pytest.mark.parametrize("decision", [CONNECT, SEPARATE])
def test_closing_gives_a_forgotten_pinch_the_decision_of_the_nearest(decision):
    kept = np.eye(6, dtype=bool)
    at_vertex = np.zeros((7, 7), dtype=np.int8)
    at_vertex[2, 2], at_vertex[5, 5] = decision, -decision
    grid = BackgroundGrid(shape=kept.shape, cell_size=1.0, origin=(0.0, 0.0))
    mesh, rounds = resolve(kept, Decisions(at_vertex, 0, 0, 0), grid)
    assert rounds == 1
    assert all(check.holds for check in check_mesh(mesh))
    # Vertices 1 to 3 follow the decision at 2; vertices 4 and 5 follow the other one.
    n_components = 3 if decision == CONNECT else 4
    assert betti_by_euler(mesh) == (n_components, 0, 0)


def test_pinches_without_any_decision_are_refused():
    kept = np.eye(2, dtype=bool)
    nothing = Decisions(np.zeros((3, 3), dtype=np.int8), 0, 0, 0)
    grid = BackgroundGrid(shape=kept.shape, cell_size=1.0, origin=(0.0, 0.0))
    with pytest.raises(MeshError, match="non-manifold"):
        resolve(kept, nothing, grid)
