"""If no vote is overruled, the mesh of one material has the Betti numbers of the diagram."""

import numpy as np
import pytest

from tusqh.contacts.material_fractions import FULL, MaterialFractions
from tusqh.contacts.mesh import mesh_materials
from tusqh.grid import BackgroundGrid
from tusqh.pipeline.ingest import read_source
from tusqh.pipeline.sample import sample
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.grid import Grid
from tusqh.topology.topology import Topology


def check_all_thresholds(seed, dim, largest, n_levels):
    """Compare at all plateaus; return how many there are, and how many follow all votes."""
    rng = np.random.default_rng(seed)
    shape = tuple(int(n) for n in rng.integers(2, largest + 1, dim))
    values = rng.integers(0, n_levels, tuple(2 * n + 1 for n in shape)) / (n_levels - 1)
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0,) * dim)
    fractions = VolumeFractions.from_values(grid, 4, values)
    topology = Topology(fractions.multiples)
    materials = MaterialFractions.from_fractions(fractions)
    n_all = n_equal = 0
    for upper in topology.curves["upper"]:
        thresholds = {"material": upper, "void": 1 - upper}
        found = mesh_materials(materials, thresholds=thresholds)
        kept = (fractions.cells >= upper).sum()
        assert (
            kept == (materials.label_cells(np.rint([upper * FULL, FULL - upper * FULL])) == 0).sum()
        )
        assert found.is_as_predicted
        n_all += 1
        if found.n_overruled == 0:
            n_equal += 1
            assert found.predicted["material"] == topology.betti_at(upper), (seed, upper)
            assert found.predicted_solid == found.predicted["material"]
    return n_all, n_equal


def test_in_the_plane_every_vote_is_followed():
    for seed in range(6):
        n_all, n_equal = check_all_thresholds(seed, 2, 6, 4)
        assert n_all == n_equal


def test_in_space_where_no_vote_is_overruled():
    counts = np.array([check_all_thresholds(seed, 3, 3, 4) for seed in range(10)])
    n_all, n_equal = counts.sum(axis=0)
    assert n_equal > 0.4 * n_all


@pytest.mark.slow
def test_many_fields_in_space():
    for seed in range(100, 400):
        check_all_thresholds(seed, 3, 5, 6)


def test_a_real_model_has_the_topology_of_its_diagram(repository):
    """Mesh the bearings on 24 cells, which have many contacts, where all votes are followed."""
    geometry = read_source(str(repository / "data_sources/solids/bearings.stl")).geometry
    fractions = sample(geometry, grid=Grid(cells=24, placement="corner"))
    topology = Topology(fractions.multiples)
    n_followed = 0
    for threshold in (0.3, 0.5, 0.7):
        thresholds = {"material": threshold, "void": 1 - threshold}
        found = mesh_materials(MaterialFractions.from_fractions(fractions), thresholds=thresholds)
        assert found.is_as_predicted
        if found.n_overruled == 0:
            n_followed += 1
            assert found.measured_solid.by_euler == topology.betti_at(threshold)
        assert found.n_overruled < 0.05 * found.n_contacts
    assert n_followed >= 1
