"""Every vote is followed, so the mesh of one material has the Betti numbers of the diagram."""

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
    """Compare the mesh with the diagram at all plateaus."""
    rng = np.random.default_rng(seed)
    shape = tuple(int(n) for n in rng.integers(2, largest + 1, dim))
    values = rng.integers(0, n_levels, tuple(2 * n + 1 for n in shape)) / (n_levels - 1)
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0,) * dim)
    fractions = VolumeFractions.from_values(grid, 4, values)
    topology = Topology(fractions.multiples)
    materials = MaterialFractions.from_fractions(fractions)
    for upper in topology.curves["upper"]:
        thresholds = {"material": upper, "void": 1 - upper}
        found = mesh_materials(materials, thresholds=thresholds)
        kept = (fractions.cells >= upper).sum()
        assert (
            kept == (materials.label_cells(np.rint([upper * FULL, FULL - upper * FULL])) == 0).sum()
        )
        assert found.is_as_predicted
        assert found.predicted["material"] == topology.betti_at(upper), (seed, upper)
        assert found.predicted_solid == found.predicted["material"]


def test_in_the_plane_every_vote_is_followed():
    for seed in range(6):
        check_all_thresholds(seed, 2, 6, 4)


def test_in_space_every_vote_is_followed():
    for seed in range(10):
        check_all_thresholds(seed, 3, 3, 4)


@pytest.mark.slow
def test_many_fields_in_space():
    for seed in range(100, 400):
        check_all_thresholds(seed, 3, 5, 6)


def test_a_real_model_has_the_topology_of_its_diagram(repository):
    """Mesh the bearings on 24 cells, which have many contacts."""
    geometry = read_source(str(repository / "data_sources/solids/bearings.stl")).geometry
    fractions = sample(geometry, grid=Grid(cells=24, placement="corner"))
    topology = Topology(fractions.multiples)
    for threshold in (0.3, 0.5, 0.7):
        thresholds = {"material": threshold, "void": 1 - threshold}
        found = mesh_materials(MaterialFractions.from_fractions(fractions), thresholds=thresholds)
        assert found.is_as_predicted
        assert found.measured_solid.by_euler == topology.betti_at(threshold)
        assert found.n_contacts > 20
