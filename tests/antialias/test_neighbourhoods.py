"""Exhaustive tests of every neighbourhood of a vertex and of every 4 x 4 field."""

import itertools

import numpy as np
import pytest
from oracles import betti_by_rank

from tusqh.antialias.clusters import CONNECT, SEPARATE, decide_by_vote
from tusqh.antialias.pinches import find_pinches, neighbourhood_codes, pinch_table
from tusqh.antialias.resolve import resolve
from tusqh.grid import BackgroundGrid
from tusqh.meshes.checks import check_mesh
from tusqh.meshes.jacobians import element_volumes
from tusqh.topology.effective import effective_betti


def mesh_of(kept, decisions):
    grid = BackgroundGrid(shape=kept.shape, cell_size=1.0, origin=(0.0, 0.0))
    return resolve(kept, decisions, grid)


@pytest.mark.parametrize("code", range(16))
@pytest.mark.parametrize("connect", [True, False])
def test_all_neighbourhoods_with_both_decisions(code, connect):
    kept = np.array([[code & 1, code >> 2 & 1], [code >> 1 & 1, code >> 3 & 1]], dtype=bool)
    assert neighbourhood_codes(kept)[1, 1] == code
    pinches = find_pinches(kept)
    assert pinches[1, 1] == (code in (0b0110, 0b1001))
    assert pinches.sum() == pinches[1, 1]
    mesh, rounds = mesh_of(kept, decide_by_vote(pinches, np.full(pinches.shape, connect)))
    assert rounds == 0
    assert all(check.holds for check in check_mesh(mesh))
    n_kept = int(kept.sum())
    if not pinches.any():
        assert mesh.n_cells == n_kept
        assert betti_by_rank(mesh.cells) == (min(n_kept, 1), 0, 0)
        return
    assert mesh.n_cells == 6
    assert betti_by_rank(mesh.cells) == ((1 if connect else 2), 0, 0)
    area = element_volumes(mesh.points, mesh.cells).sum()
    # Connecting adds four trapezoids of 3/16, separating removes four.
    assert area == pytest.approx(2 + (4 if connect else -4) * 3 / 16)


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


@pytest.mark.parametrize("policy", ["separate", "connect", "majority"])
def test_every_3_x_3_field_and_every_vote_of_its_pinches(policy):
    """All 512 fields with all votes give manifold meshes with the predicted topology."""
    n_meshes = 0
    for code in range(512):
        kept = (code >> np.arange(9) & 1).astype(bool).reshape(3, 3)
        pinches = find_pinches(kept)
        places = np.argwhere(pinches)
        for votes in itertools.product((False, True), repeat=len(places)):
            ballot = np.zeros(pinches.shape, dtype=bool)
            ballot[tuple(places.T)] = votes
            decisions = decide_by_vote(pinches, ballot, mixed_pinches=policy)
            mesh, rounds = mesh_of(kept, decisions)
            predicted = effective_betti(
                kept, decisions.at_vertex == CONNECT, decisions.at_vertex == SEPARATE
            )
            assert rounds == 0
            assert betti_by_rank(mesh.cells) == predicted
            n_meshes += 1
            if len(places):
                assert all(check.holds for check in check_mesh(mesh)), (code, votes)
    assert n_meshes > 512
