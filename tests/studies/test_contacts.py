"""Every contact follows its vote, so meshes have the topology of the diagram."""

import numpy as np
import pytest

from studies.contacts import tabulate_contacts
from tusqh.grid import BackgroundGrid
from tusqh.pipeline.ingest import read_source
from tusqh.pipeline.sample import sample
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.grid import Grid
from tusqh.topology.topology import Topology

THRESHOLDS = (0.125, 0.5, 0.75, 1.0)


def table_of(fractions):
    return tabulate_contacts(
        fractions, Topology(fractions.multiples).curves, THRESHOLDS, name="model"
    )


@pytest.mark.parametrize("dim", [2, 3])
def test_no_vote_overruled_implies_the_topology_of_the_diagram(dim):
    n_pinches = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        shape = tuple(int(n) for n in rng.integers(2, 6, dim))
        values = rng.integers(0, 9, tuple(2 * n + 1 for n in shape)) / 8
        grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0,) * dim)
        table = table_of(VolumeFractions.from_values(grid, 4, values))
        assert table["equals_diagram"].all(), seed
        assert (table["overruled"] == 0).all(), seed
        n_pinches += table["pinches"].sum()
    assert n_pinches > 30


def test_a_real_model_with_hundreds_of_pinches(repository):
    geometry = read_source(str(repository / "data_sources/solids/bearings.stl")).geometry
    table = table_of(sample(geometry, grid=Grid(cells=24, placement="corner")))
    assert table["pinches"].sum() > 50
    assert table["equals_diagram"].all()
    assert (table["hexes"] >= table["hexes_plain"]).all()


def test_another_diagram_is_noticed():
    values = np.zeros((5, 5))
    values[1, 1] = values[3, 3] = 1.0
    grid = BackgroundGrid(shape=(2, 2), cell_size=1.0, origin=(0.0, 0.0))
    fractions = VolumeFractions.from_values(grid, 4, values)
    curves = Topology(fractions.multiples).curves
    wrong = curves.assign(betti_0=1)
    assert tabulate_contacts(fractions, curves, [0.5], name="a")["equals_diagram"].tolist() == [
        True
    ]
    assert not tabulate_contacts(fractions, wrong, [0.5], name="a")["equals_diagram"].any()
