"""Contacts found at one threshold, counted at all thresholds, and decided in the mesh agree."""

import numpy as np
import pytest

from tusqh.antialias.cells import CellSets
from tusqh.antialias.pinches import find_pinch_edges, find_pinches
from tusqh.contacts.one_material_contacts import count_contacts, find_contacts
from tusqh.grid import BackgroundGrid
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Policy


def random_fractions(seed, dim):
    """Return random fractions, some of them below 0 and above 1, with ties."""
    rng = np.random.default_rng(seed)
    shape = tuple(int(n) for n in rng.integers(1, 8 if dim == 2 else 6, dim))
    values = rng.integers(-1, 7, tuple(2 * n + 1 for n in shape)) / 5
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0,) * dim)
    return VolumeFractions.from_values(grid, 4, values)


def count(kept):
    """Count pinched vertices and edges from their definition."""
    n_edges = sum(find_pinch_edges(kept, axis).sum() for axis in range(3 if kept.ndim == 3 else 0))
    return int(find_pinches(kept).sum() + n_edges)


@pytest.mark.parametrize("dim", [2, 3])
def test_contacts_are_counted_at_all_thresholds(dim):
    for seed in range(60):
        fractions = random_fractions(seed, dim)
        thresholds = np.array([0.05, 0.2, 0.3, 0.6, 0.61, 0.8, 1.0])
        least = np.ceil(thresholds / RESOLUTION).astype(np.int64)
        expected = [count(fractions.cells >= t) for t in thresholds]
        assert count_contacts(fractions.multiples, least).tolist() == expected


@pytest.mark.parametrize("dim", [2, 3])
def test_the_templates_decide_what_the_votes_say(dim):
    n_contacts = 0
    for seed in range(60):
        fractions = random_fractions(seed, dim)
        for threshold in (0.2, 0.6):
            cells = CellSets(fractions, Policy(bridges="none")).at(threshold)
            assert cells.n_contacts == count(cells.kept)
            found, wanted = cells.decision.contacts, cells.contacts
            for name in ("vertex_cells", "ball", "sticks", "edge_cells", "edge_material"):
                assert np.array_equal(getattr(found, name), getattr(wanted, name)), name
            assert cells.n_overruled == 0
            n_contacts += cells.n_contacts
    assert n_contacts > 100


def test_a_wrong_decision_is_counted_as_overruled():
    fractions = random_fractions(1, 3)
    cells = CellSets(fractions, Policy(bridges="none")).at(0.6)
    assert cells.n_contacts > 0
    cells.contacts.ball[:] = 1 - cells.contacts.ball
    assert cells.n_overruled == len(cells.contacts.ball)


def test_more_contacts_than_the_first_buffer_holds():
    kept = np.indices((20, 20, 20)).sum(axis=0) % 2 == 0
    contacts = find_contacts(kept, np.zeros((41, 41, 41), dtype=bool))
    assert len(contacts) == count(kept) > 3 * 1024
