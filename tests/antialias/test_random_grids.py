"""Random grids with random votes give manifold meshes with the topology of the diagram."""

import numpy as np
import pytest
from fields import decide_votes, fractions_of_votes, random_votes
from oracles import betti_by_rank
from skimage.measure import euler_number, label

from tusqh.antialias.resolve import build_mesh
from tusqh.grid import BackgroundGrid
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.checks import check_mesh
from tusqh.meshes.jacobians import smallest_jacobians
from tusqh.topology.topology import Topology

N_GRIDS = 1500


def random_case(seed):
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(2, 9, 2))
    kept = rng.random(shape) < rng.uniform(0.05, 0.95)
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0, 0.0))
    return kept, random_votes(rng, shape), grid


@pytest.mark.parametrize("start", range(0, N_GRIDS, 500))
def test_meshes_of_random_grids(start):
    for seed in range(start, start + 500):
        kept, votes, grid = random_case(seed)
        cells = decide_votes(kept, votes)
        mesh = build_mesh(cells, grid, name=f"seed {seed}").mesh
        topology = Topology(fractions_of_votes(kept, votes).multiples)
        assert cells.n_overruled == 0, seed
        assert cells.predicted == topology.betti_at(0.5), seed
        assert betti_by_rank(mesh.cells) == cells.predicted, seed
        assert betti_by_euler(mesh) == betti_by_boundary(mesh) == cells.predicted, seed
        assert all(check.holds for check in check_mesh(mesh)), seed
        scaled = smallest_jacobians(mesh.points, mesh.cells)[1]
        assert scaled.min(initial=1.0) >= np.sqrt(0.5) - 1e-12, seed


@pytest.mark.parametrize("connectivity", [1, 2])
def test_one_vote_everywhere_is_scikit_images_connectivity(connectivity):
    """Separating all pinches gives 4-connectivity, and connecting all gives 8-connectivity."""
    for seed in range(300):
        kept, _, grid = random_case(seed)
        mesh = build_mesh(decide_votes(kept, connectivity == 2), grid).mesh
        n_components = int(label(kept, connectivity=connectivity).max())
        euler = euler_number(kept, connectivity=connectivity)
        assert betti_by_euler(mesh) == (n_components, n_components - euler, 0)
