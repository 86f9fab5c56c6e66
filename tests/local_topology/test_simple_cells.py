"""A cell is simple exactly if its link is contractible, and then changes no Betti number."""

import numpy as np
import pytest
from fields import decide_votes
from flag_complexes import has_contractible_link

from tusqh.antialias.cells import CellSets
from tusqh.grid import BackgroundGrid
from tusqh.local_topology.base import find_base
from tusqh.local_topology.link import link_in
from tusqh.local_topology.move import approach, changes_of
from tusqh.local_topology.simple_cells import is_simple
from tusqh.sampling.fractions import VolumeFractions


def is_middle_simple(kept, votes):
    """Return whether the middle of three cells a side is simple."""
    padded, on_doubled = np.pad(kept, 1), np.pad(votes, 2)
    cell = np.ravel_multi_index((2,) * kept.ndim, padded.shape)
    place = np.ravel_multi_index((5,) * kept.ndim, on_doubled.shape)
    link = link_in(padded.shape, on_doubled.shape)
    return is_simple(cell, place, padded.ravel(), on_doubled.ravel(), link)


def check(kept, votes):
    """Compare with the link by gudhi and with the Betti numbers of all cells; return the answer."""
    middle = (1,) * kept.ndim
    found = is_middle_simple(kept, votes)
    assert found == has_contractible_link(kept, votes, middle)
    changed = kept.copy()
    changed[middle] = not kept[middle]
    assert found == is_middle_simple(changed, votes)
    betti = [decide_votes(cells, votes).predicted for cells in (kept, changed)]
    if found:
        assert betti[0] == betti[1]
    elif kept.ndim == 2:
        assert betti[0] != betti[1]
    return found


def test_every_neighbourhood_in_the_plane():
    rng, n_simple = np.random.default_rng(0), 0
    for code in range(256):
        bits = [code >> k & 1 for k in range(8)]
        kept = np.array([*bits[:4], 0, *bits[4:]], dtype=bool).reshape(3, 3)
        n_simple += check(kept, rng.random((7, 7)) < 0.5)
    assert 50 < n_simple < 206


def test_random_neighbourhoods_in_space():
    rng = np.random.default_rng(0)
    answers = [
        check(rng.random((3, 3, 3)) < rng.random(), rng.random((7, 7, 7)) < rng.random())
        for _ in range(80)
    ]
    assert 8 < sum(answers) < 72


@pytest.mark.parametrize("shape", [(9, 8), (6, 5, 7)])
def test_one_cell_of_a_full_block_grows_to_the_block(shape):
    """All cells are equally full but one, which is a ball; so is the block."""
    cells = np.full(shape, 0.75)
    cells[tuple(n // 2 for n in shape)] = 1.0
    fractions = fractions_of(cells)
    found = approach(CellSets(fractions), 0.5).at(1.0)
    assert found.kept.all()
    assert tuple(found.predicted) == (1, 0, 0)
    assert len(changes_of(found)) == 0


@pytest.mark.parametrize("dim", [2, 3])
def test_a_ring_grows_until_its_hole_is_one_cell_wide(dim):
    """The seed is a ring, the base a full block: one line of cells through the hole is left out."""
    cells = np.full((7, 7, 3)[:dim], 0.75)
    cells[1:-1, 1:-1] = 1.0
    cells[2:-2, 2:-2] = 0.75
    cells[3, 3] = 0.6
    found = approach(CellSets(fractions_of(cells)), 0.5).at(1.0)
    assert tuple(found.predicted) == (1, 1, 0)
    assert np.argwhere(~found.kept)[:, :2].tolist() == [[3, 3]] * (1 if dim == 2 else 3)
    (row,) = changes_of(found).to_dict("records")
    assert (row["change"], row["x"], row["y"]) == ("left out", 3.5, 3.5)


def test_a_ring_is_cut_where_it_is_thinnest():
    """The seed lacks three cells of a ring, the base has the whole ring."""
    cells = np.ones((5, 5))
    cells[1:-1, 1:-1] = 0.0
    cells[0, 1:-1] = 0.7, 0.6, 0.65
    cell_sets = CellSets(fractions_of(cells))
    assert tuple(cell_sets.at(0.5).predicted) == (1, 1, 0)
    found = approach(cell_sets, 0.5).at(0.75)
    assert tuple(found.predicted) == (1, 0, 0)
    (row,) = changes_of(found).to_dict("records")
    assert (row["change"], row["cells"]) == ("left out", 1)
    assert row["largest_fraction"] == pytest.approx(0.6, abs=1e-6)


def fractions_of(cells):
    """Return fractions whose sub-cells are empty, so that all contacts separate."""
    values = np.zeros(tuple(2 * n + 1 for n in cells.shape))
    values[(slice(1, None, 2),) * cells.ndim] = cells
    grid = BackgroundGrid(shape=cells.shape, cell_size=1.0, origin=(0.0,) * cells.ndim)
    return VolumeFractions.from_values(grid, 4, values)


def test_the_base_of_a_volume_is_the_nearest():
    rng = np.random.default_rng(0)
    fractions = fractions_of(rng.integers(0, 9, (5, 6)) / 8)
    for volume in (0.0, 1.0, 7.5, 12.0, 30.0, 99.0):
        base = find_base(fractions, "match", volume=volume)
        error = abs((fractions.cells >= base).sum() - volume)
        others = [(fractions.cells >= t).sum() for t in np.arange(1, 9) / 8]
        assert error == min(abs(n - volume) for n in others if n > 0)
