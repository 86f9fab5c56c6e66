"""Betti numbers at every level by three methods: union-find, gudhi, and ranks over GF(2)."""

from collections import Counter

import numpy as np
import pytest
from oracles import gudhi_pairs, simplicial_betti_by_rank
from scipy import ndimage

from tusqh.antialias.cells import CellSets
from tusqh.grid import BackgroundGrid
from tusqh.sampling.fractions import VolumeFractions, round_fractions
from tusqh.settings.policy import Policy
from tusqh.topology.filtration import build_filtration
from tusqh.topology.topology import Topology


def random_values(rng, shape):
    """Return a doubled grid with ties, plateaus, zeros, ones, and values outside [0, 1]."""
    doubled = tuple(2 * n + 1 for n in shape)
    n_levels = int(rng.integers(2, 7))
    low, high = (0, n_levels) if rng.random() < 0.8 else (-1, n_levels + 1)
    values = rng.integers(low, high, doubled) / 2.0 ** np.ceil(np.log2(n_levels - 1))
    if rng.random() < 0.3:  # A plateau: a block of equal values.
        block = tuple(slice(0, int(rng.integers(1, n + 1))) for n in doubled)
        values[block] = rng.integers(0, 2)
    return values


def compare_pairs(topology, reference):
    clipped = [(k, min(birth, 1.0), min(death, 1.0)) for k, birth, death in reference]
    expected = sorted(pair for pair in clipped if pair[1] > pair[2])
    assert sorted(map(tuple, topology.pairs[["dimension", "birth", "death"]].values)) == expected
    on_diagonal = Counter((k, birth) for k, birth, death in clipped if birth == death)
    found = topology.diagonal
    keys = zip(found["dimension"], found["birth"], strict=True)
    assert dict(zip(keys, found["pairs"], strict=True)) == on_diagonal


def compare_everything(values):
    filtration = build_filtration(values)
    topology = Topology.from_fractions(values)
    plateaus = topology.curves
    assert plateaus["upper"].iloc[0] == 1.0
    assert plateaus["lower"].iloc[-1] == 0.0
    topology.require_agreement(name="random")
    reference = gudhi_pairs(filtration)
    for row in plateaus.itertuples():
        alone = Topology.from_fractions(values)
        assert alone.betti_at(row.upper) == alone.betti_at((row.lower + row.upper) / 2)
        assert list(alone.betti_at(row.upper)) == [row.betti_0, row.betti_1, row.betti_2]
        level = (filtration.values >= row.upper).nonzero()[0]
        inside = [s[np.isin(s, level).all(axis=1)] for s in filtration.simplices]
        by_rank = [*simplicial_betti_by_rank(inside), 0][:3]
        by_gudhi = [
            sum(k == dim and death < row.upper <= birth for k, birth, death in reference)
            for dim in range(3)
        ]
        assert [row.betti_0, row.betti_1, row.betti_2] == by_rank == by_gudhi
        assert row.euler == row.betti_0 - row.betti_1 + row.betti_2
        assert list(topology.betti_at((row.lower + row.upper) / 2)) == by_rank
    compare_pairs(topology, reference)


@pytest.mark.parametrize("seed", range(50))
def test_in_the_plane(seed):
    rng = np.random.default_rng(seed)
    for _ in range(10):
        compare_everything(random_values(rng, tuple(rng.integers(1, 7, 2))))


@pytest.mark.parametrize("seed", range(50))
def test_in_space(seed):
    rng = np.random.default_rng(1000 + seed)
    for _ in range(4):
        compare_everything(random_values(rng, tuple(rng.integers(1, 5, 3))))


@pytest.mark.parametrize("seed", range(10))
def test_pairs_of_larger_fields_in_space(seed):
    """Smooth fields with many ties, and white noise with none, in which loops are long."""
    rng = np.random.default_rng(3000 + seed)
    values = rng.random(tuple(2 * rng.integers(4, 7, 3) + 1))
    if seed % 2:
        values = ndimage.gaussian_filter(values, 2.0, mode="constant")
        values = np.floor(values / values.max() * 8) / 8
    values = round_fractions(values)
    compare_pairs(Topology.from_fractions(values), gudhi_pairs(build_filtration(values)))


@pytest.mark.parametrize("seed", range(20))
def test_raw_equals_effective_where_nothing_is_overruled(seed):
    rng = np.random.default_rng(2000 + seed)
    shape = tuple(int(n) for n in rng.integers(1, 7, 2))
    values = np.clip(random_values(rng, shape), 0, 1)
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0, 0.0))
    fractions = VolumeFractions.from_values(grid=grid, samples=4, values=values)
    cell_sets = CellSets(fractions, Policy(bridges="none"))
    for threshold in cell_sets.topology.curves["upper"]:
        cells = cell_sets.at(threshold)
        if cells.n_overruled == 0:
            assert cells.predicted == cell_sets.topology.betti_at(threshold)


@pytest.mark.parametrize("shape", [(1, 1), (1, 5), (1, 1, 1), (1, 1, 4)])
@pytest.mark.parametrize("value", [0.0, 0.5, 1.0])
def test_constant_fields(shape, value):
    values = np.full(tuple(2 * n + 1 for n in shape), value)
    plateaus = Topology.from_fractions(values).curves
    assert (plateaus["betti_0"] == (plateaus["upper"] <= value)).all()
    assert (plateaus[["betti_1", "betti_2"]] == 0).all(axis=None)
