"""The filtration, its pairs and the effective count, each against an independent road."""

import numpy as np
import pytest
from conftest import make_fractions, random_fractions
from oracles import simplicial_betti_by_rank

from tusqh.antialias.resolve import keep_cells
from tusqh.topology.filtration import build_filtration, clamp_values
from tusqh.topology.persistence import betti_at, list_plateaus, locate_pairs, persistence_pairs


def sublevel(filtration, threshold):
    """The simplices whose nodes all have values of at least the threshold."""
    return [s[(filtration.values[s] >= threshold).all(axis=1)] for s in filtration.simplices]


@pytest.mark.parametrize("seed", range(60))
def test_plateaus_in_the_plane_match_ranks_and_the_effective_count(seed):
    rng = np.random.default_rng(seed)
    fractions = random_fractions(rng, tuple(rng.integers(1, 6, 2)))
    filtration = build_filtration(fractions.values)
    plateaus = list_plateaus(filtration, persistence_pairs(filtration))
    assert plateaus["upper"].iloc[0] == 1.0
    assert plateaus["lower"].iloc[-1] == 0.0
    for row in plateaus.itertuples():
        for threshold in (row.upper, (row.lower + row.upper) / 2):
            expected = simplicial_betti_by_rank(sublevel(filtration, threshold))
            assert [row.betti_0, row.betti_1, row.betti_2] == expected
            cells = keep_cells(fractions, threshold=threshold)
            if cells.decisions.n_overruled_clusters == 0:
                assert list(cells.predicted) == expected
            assert list(betti_at(plateaus, threshold)) == expected


@pytest.mark.parametrize("seed", range(10))
def test_plateaus_in_space_match_ranks(seed):
    rng = np.random.default_rng(seed)
    shape = rng.integers(1, 3, 3)
    values = rng.integers(0, 4, 2 * shape + 1) / 3
    filtration = build_filtration(values)
    plateaus = list_plateaus(filtration, persistence_pairs(filtration))
    for row in plateaus.itertuples():
        expected = simplicial_betti_by_rank(sublevel(filtration, row.upper))
        assert [row.betti_0, row.betti_1, row.betti_2, 0] == expected


def test_a_ring_with_a_weak_side_by_hand():
    """Eight cells around a hole: it closes at 0.5 when the weak side comes in."""
    cells = np.ones((3, 3))
    cells[1, 1], cells[0, 1] = 0.25, 0.5
    fractions = make_fractions(cells)
    filtration = build_filtration(fractions.values)
    pairs = locate_pairs(persistence_pairs(filtration), filtration, fractions.grid)
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
