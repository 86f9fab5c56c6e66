"""Exhaustive tests of every neighbourhood of a vertex in the plane and of every 3 x 3 field."""

import itertools

import numpy as np
import pytest
from fields import decide_votes, fractions_of_votes
from oracles import betti_by_rank

from tusqh.antialias.cells import CellSets
from tusqh.antialias.pinches import find_pinches, neighbourhood_codes, pinch_table
from tusqh.antialias.resolve import build_mesh
from tusqh.grid import BackgroundGrid
from tusqh.meshes.checks import check_mesh
from tusqh.meshes.jacobians import element_volumes
from tusqh.settings.policy import Policy


def mesh_of(kept, votes):
    """Return the decided cells and their mesh."""
    cells = decide_votes(kept, votes)
    grid = BackgroundGrid(shape=kept.shape, cell_size=1.0, origin=(0.0, 0.0))
    return cells, build_mesh(cells, grid).mesh


@pytest.mark.parametrize("code", range(16))
@pytest.mark.parametrize("connect", [True, False])
def test_all_neighbourhoods_with_both_decisions(code, connect):
    kept = np.array([[code & 1, code >> 2 & 1], [code >> 1 & 1, code >> 3 & 1]], dtype=bool)
    assert neighbourhood_codes(kept)[1, 1] == code
    pinches = find_pinches(kept)
    assert pinches[1, 1] == (code in (0b0110, 0b1001))
    cells, mesh = mesh_of(kept, connect)
    assert cells.n_contacts == pinches.sum() == pinches[1, 1]
    assert all(check.holds for check in check_mesh(mesh))
    n_kept = int(kept.sum())
    if not pinches.any():
        assert mesh.n_cells == n_kept
        assert betti_by_rank(mesh.cells) == (min(n_kept, 1), 0, 0)
        return
    # Each of the two cells has an inner cell, two trapezoids and two quads; the ball has 4 kites.
    assert mesh.n_cells == 2 * 5 + 4 * connect
    assert betti_by_rank(mesh.cells) == ((1 if connect else 2), 0, 0)
    area = element_volumes(mesh.points, mesh.cells).sum()
    # The ball has the area 3/8; half of it lies in the two cells.
    assert area == pytest.approx(2 + (1 if connect else -1) * 3 / 16)


def test_the_two_pinches_of_the_plane_are_the_diagonals():
    assert np.flatnonzero(pinch_table(2)).tolist() == [0b0110, 0b1001]


def test_pinch_table_in_space_matches_a_hand_count():
    """Count the blocks of 2 x 2 x 2 whose kept or empty cells are not connected by shared faces."""
    expected = 0
    for code in range(256):
        cells = [np.array(c) for b, c in enumerate(itertools.product((0, 1), repeat=3))]
        parts = []
        for value in (0, 1):
            members = [tuple(c) for b, c in enumerate(cells) if (code >> b & 1) == value]
            count = 0
            left = set(members)
            while left:
                count += 1
                stack = [left.pop()]
                while stack:
                    a = stack.pop()
                    near = {b for b in left if np.abs(np.subtract(a, b)).sum() == 1}
                    left -= near
                    stack += near
            parts.append(count)
        expected += max(parts) > 1
    assert pinch_table(3).sum() == expected


def test_every_3_x_3_field_and_every_vote_of_its_pinches():
    """All 512 fields with all votes follow every vote, and have the diagram's topology."""
    n_meshes = 0
    for code in range(512):
        kept = (code >> np.arange(9) & 1).astype(bool).reshape(3, 3)
        places = np.argwhere(find_pinches(kept))
        for votes in itertools.product((False, True), repeat=len(places)):
            ballot = np.zeros((7, 7), dtype=bool)
            ballot[tuple(2 * places.T)] = votes
            cells, mesh = mesh_of(kept, ballot)
            cell_sets = CellSets(fractions_of_votes(kept, ballot), Policy(bridges="none"))
            assert cells.n_overruled == 0
            assert cells.predicted == cell_sets.topology.betti_at(0.5)
            assert betti_by_rank(mesh.cells) == cells.predicted
            n_meshes += 1
            if len(places):
                assert all(check.holds for check in check_mesh(mesh)), (code, votes)
    assert n_meshes > 512


@pytest.mark.parametrize("fraction", [0.5, 0.25])
def test_a_fraction_equal_to_the_threshold_connects(fraction):
    kept = np.eye(2, dtype=bool)
    values = fractions_of_votes(kept, votes=False).values.copy()
    values[2, 2] = fraction
    from_values = fractions_of_votes(kept, votes=False).from_values
    grid = BackgroundGrid(shape=(2, 2), cell_size=1.0, origin=(0.0, 0.0))
    cell_sets = CellSets(from_values(grid, 4, values), Policy(bridges="none"))
    assert cell_sets.at(fraction).predicted == (1, 0, 0)
    assert cell_sets.at(np.nextafter(fraction, 1)).predicted == (2, 0, 0)
