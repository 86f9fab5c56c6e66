"""Every combination of votes at a vertex is followed, with a ball where sticks alone cannot."""

import itertools

import numpy as np
import pytest

from tusqh.contacts import decide, spatial
from tusqh.contacts.material_fractions import FULL, MaterialFractions
from tusqh.contacts.mesh import mesh_materials
from tusqh.contacts.octants import BITS, octants
from tusqh.grid import BackgroundGrid

TABLES = octants()
#: Blocks of 2 x 2 x 2 cells follow one another along every axis, with layers of void between them.
PITCH = 4


def find_pinched_edges(kept):
    """Return the half-edges at which two opposite octants are kept and the others are not."""
    four = kept[TABLES.around]
    return np.flatnonzero(
        (four[:, 0] == four[:, 2]) & (four[:, 1] == four[:, 3]) & four.any(1) & ~four.all(1)
    )


def all_votes():
    """Return the kept octants, pinched half-edges that vote for them, and votes of the vertex.

    These are all combinations at all pinched vertices with two materials.
    """
    found = []
    for code in range(256):
        kept = (code >> np.arange(8) & 1).astype(bool)
        if not TABLES.is_pinched[code]:
            continue
        edges = find_pinched_edges(kept)
        for votes in itertools.product((0, 1), repeat=len(edges) + 1):
            found.append((kept, edges[np.array(votes[1:], dtype=bool)], votes[0]))
    return found


def lay_blocks(configurations, rng):
    """Return fractions with one block per configuration; other places vote at random."""
    n = int(np.ceil(len(configurations) ** (1 / 3)))
    shape = (n * PITCH,) * 3
    multiples = FULL * rng.integers(0, 2, tuple(2 * s + 1 for s in shape))
    multiples[1::2, 1::2, 1::2] = 0
    for i, (kept, connecting, vertex) in enumerate(configurations):
        centre = 2 * (np.array(np.unravel_index(i, (n,) * 3)) * PITCH + 2)
        for a in range(8):
            multiples[tuple(centre + 2 * BITS[a] - 1)] = FULL * kept[a]
        for e in range(6):
            step = (2 * (e % 2) - 1) * (np.arange(3) == e // 2)
            multiples[tuple(centre + step)] = FULL * (e in connecting)
        multiples[tuple(centre)] = FULL * vertex
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0, 0.0, 0.0))
    return MaterialFractions.from_multiples(grid, ["material"], [multiples.astype(np.int32)])


def check_votes(configurations):
    fractions = lay_blocks(configurations, np.random.default_rng(0))
    found = mesh_materials(fractions, thresholds={"material": 0.5, "void": 0.5}, with_void=True)
    assert found.n_overruled == 0
    assert found.is_as_predicted
    assert found.mesh.measurement.smallest_scaled_jacobian > 0.577
    return found


def test_votes_at_a_vertex():
    check_votes(all_votes()[::60])


@pytest.mark.slow
def test_all_votes_at_a_vertex():
    check_votes(all_votes())


def test_without_balls_some_votes_fail(monkeypatch):
    """Sticks alone cannot follow all votes, so the mesh without the balls is wrong."""

    def decide_without_balls(*arguments):
        decision = spatial.decide_sticks(*arguments)
        assert decision.field.has_ball.sum() > 5
        decision.field.has_ball[:] = False
        return decision

    monkeypatch.setattr(decide, "decide_sticks", decide_without_balls)
    with pytest.raises(AssertionError, match="is_as_predicted"):
        check_votes(all_votes()[::60])
