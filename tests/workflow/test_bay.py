"""The real model is right at every threshold of the sweep and for every topology."""

import pytest

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.meshes.betti import betti_by_boundary
from tusqh.quality.verification import VERIFICATION_COLUMNS, verify_mesh
from tusqh.readers.files import read_file
from tusqh.sampling.fractions import sample_fractions
from tusqh.sampling.layout import lay_grid
from tusqh.settings.goal import Goal
from tusqh.settings.policy import Criteria, Policy
from tusqh.settings.sampling import Sampling
from tusqh.threshold.choose import choose_threshold
from tusqh.threshold.plateaus import Plateaus

WINDOW = ((250000.0, 4075000.0), (490000.0, 4391000.0))


@pytest.fixture(scope="module")
def fractions(repository):
    outline = read_file(repository / "data_sources/chesapeake/counties.geojson").geometry
    grid = lay_grid(outline, WINDOW, cells=[60, 79])
    return sample_fractions(outline, grid, sampling=Sampling(domain="outside"), window=WINDOW)


@pytest.mark.parametrize("bridges", ["none", "forest", "all"])
@pytest.mark.parametrize("min_cells", [1, 4])
@pytest.mark.parametrize("threshold", [0.9, 0.75, 0.5, 0.25, 0.15, 0.05, 0.01])
def test_predicted_topology_is_measured_topology(fractions, threshold, min_cells, bridges):
    policy = Policy(bridges=bridges, components=Criteria(min_cells=min_cells))
    cells = CellSets(fractions, policy).at(threshold)
    mesh = build_mesh(cells, fractions.grid, name="chesapeake").mesh
    row = verify_mesh(mesh, cells, grid=fractions.grid.label)
    assert list(row) == VERIFICATION_COLUMNS
    assert row["holds"]
    assert row["grid"] == "60x79"


@pytest.mark.parametrize("bridges", ["none", "forest"])
def test_at_least_six_topologies_can_be_asked_for(fractions, bridges):
    policy = Policy(bridges=bridges, components=Criteria(min_cells=4))
    cell_sets = CellSets(fractions, policy)
    plateaus = Plateaus(cell_sets)
    targets = plateaus.table[["betti_0", "betti_1"]].drop_duplicates().to_dict("records")
    assert len(targets) >= 6
    for target in targets:
        chosen, candidates = choose_threshold(plateaus, Goal.from_dict({"target": target}))
        assert (candidates["status"] == "chosen").sum() == 1
        mesh = build_mesh(cell_sets.at(chosen.threshold), fractions.grid).mesh
        assert betti_by_boundary(mesh)._asdict() == {**target, "betti_2": 0}
