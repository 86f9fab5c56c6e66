"""Clamping, and the table of pairs with its check; test_curves checks the numbers."""

import numpy as np
import pandas as pd
import pytest
from fields import make_fractions, random_fractions

from tusqh.errors import TopologyError
from tusqh.grid import BackgroundGrid
from tusqh.sampling.fractions import VolumeFractions
from tusqh.tables import write_csv
from tusqh.topology.filtration import clamp_values
from tusqh.topology.persistence import (
    count_alive,
    locate_pairs,
    place_pairs,
    require_agreement,
)
from tusqh.topology.topology import Topology


def test_a_ring_with_a_weak_side_by_hand():
    """Eight cells surround a hole; the ring closes at 0.5, when its weak side enters."""
    cells = np.ones((3, 3))
    cells[1, 1], cells[0, 1] = 0.25, 0.5
    fractions = make_fractions(cells)
    pairs = locate_pairs(Topology(fractions.multiples).pairs, fractions.grid)
    holes = pairs[pairs["dimension"] == 1]
    assert holes[["birth", "death"]].to_numpy().tolist() == [[0.5, 0.25]]
    # The cell (0, 1) makes the hole; the last vertex around the cell (1, 1) fills it.
    assert holes[["birth_x", "birth_y"]].to_numpy().tolist() == [[0.5, 1.5]]
    assert abs(holes["death_x"].iloc[0] - 1.5) <= 0.5
    assert abs(holes["death_y"].iloc[0] - 1.5) <= 0.5
    components = pairs[pairs["dimension"] == 0]
    assert components["essential"].tolist() == [True]


def test_clamping_keeps_sub_cells_between_their_neighbours():
    rng = np.random.default_rng(1)
    for shape in [(7, 9), (5, 7, 5)]:
        values = rng.random(shape)
        clamped = clamp_values(values)
        cells = (slice(1, None, 2),) * len(shape)
        assert np.array_equal(clamped[cells], values[cells])
        inner = clamped[(slice(2, -2, 2),) * len(shape)]
        around = np.stack(
            [
                values[
                    tuple(slice(2 + o, n - 2 + o, 2) for o, n in zip(offset, shape, strict=True))
                ]
                for offset in np.ndindex((2,) * len(shape))
                for offset in [tuple(2 * x - 1 for x in offset)]
            ]
        )
        assert (inner <= around.max(axis=0)).all()
        assert (inner >= around.min(axis=0)).all()


def test_places_are_inside_the_grid_and_have_the_values_of_the_events():
    rng = np.random.default_rng(5)
    for shape in [(4, 5), (3, 4, 2)]:
        values = rng.integers(0, 9, 2 * np.array(shape) + 1) / 8
        pairs = Topology.from_fractions(values).pairs
        padded = clamp_values(np.pad(values, 2))
        clamped = padded[(slice(2, -2),) * len(shape)].ravel()
        assert (clamped[pairs["birth_place"]] == pairs["birth"]).all()
        mortal = pairs[~pairs["essential"]]
        assert (clamped[mortal["death_place"]] == mortal["death"]).all()
        assert (pairs.loc[pairs["essential"], "death_place"] == -1).all()


def test_located_pairs_name_the_place_as_it_is_on_the_map():
    fractions = random_fractions(np.random.default_rng(8), (5, 4))
    pairs = Topology(fractions.multiples).pairs
    some = pairs[pairs.index % 2 == 1]  # Rows may have been filtered before.
    located = locate_pairs(some, fractions.grid)
    mortal = located[~located["essential"]]
    assert located["birth_i"].notna().all()
    assert mortal["death_i"].notna().all()
    assert (
        located.loc[located["essential"], ["death_at", "death_i", "death_x"]].isna().all(axis=None)
    )
    of_cells = located[located["birth_at"] == "cell"]
    assert np.allclose(of_cells["birth_x"], of_cells["birth_i"].astype(float) + 0.5)


@pytest.mark.parametrize("shape", [(6, 5), (3, 4, 3)])
def test_places_are_found_again_in_the_written_table(tmp_path, shape):
    rng = np.random.default_rng(3)
    grid = BackgroundGrid(shape=shape, cell_size=0.3, origin=(-7.1,) * len(shape))
    values = rng.integers(0, 9, tuple(2 * n + 1 for n in shape)) / 8
    pairs = Topology(VolumeFractions.from_values(grid, 4, values).multiples).pairs
    write_csv(tmp_path / "diagram.csv", locate_pairs(pairs, grid))
    found = place_pairs(pd.read_csv(tmp_path / "diagram.csv"), grid)
    pd.testing.assert_frame_equal(found[list(pairs.columns)], pairs.reset_index(drop=True))


def test_a_disagreement_between_the_two_roads_is_never_silent():
    values = np.random.default_rng(7).integers(0, 9, (9, 9)) / 8
    topology = Topology.from_fractions(values)
    topology.require_agreement(name="plane")
    with pytest.raises(TopologyError, match="persistence pairs give Betti numbers"):
        require_agreement(topology.pairs.iloc[1:], topology.curves, name="plane")


def test_no_pairs_count_as_nothing():
    pairs = Topology.from_fractions(np.zeros((5, 5))).pairs
    assert len(pairs) == 0
    assert count_alive(pairs, np.array([0.5])).tolist() == [[0, 0, 0]]


def test_a_topology_is_computed_once_and_agrees_with_stored_tables():
    fractions = random_fractions(np.random.default_rng(9), (6, 5))
    topology = Topology(fractions.multiples)
    assert topology.curves is topology.curves
    assert topology.pairs is topology.pairs
    stored = Topology.from_tables(fractions.multiples, topology.curves, topology.pairs)
    assert stored.betti_at(0.5) == topology.betti_at(0.5)
    stored.require_agreement(name="stored")
    for ours, theirs in zip(stored.persistence_by_cell, topology.persistence_by_cell, strict=True):
        assert np.array_equal(ours, theirs)
