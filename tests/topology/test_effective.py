"""The effective count equals the homology of the complex that includes the decisions."""

import numpy as np
import pytest

from tusqh.antialias.clusters import CONNECT, SEPARATE, decide_by_vote
from tusqh.antialias.pinches import find_pinches
from tusqh.topology.effective import count_euler_characteristic, effective_betti
from tusqh.topology.topology import Topology


def decided_nodes(kept, connects):
    """Return the nodes of the complex as fractions 0 and 1; clamping decides all except pinches."""
    values = np.zeros(tuple(2 * n + 1 for n in kept.shape))
    values[(slice(1, None, 2),) * kept.ndim] = kept
    values[(slice(None, None, 2),) * kept.ndim] = connects
    for axis in range(kept.ndim if kept.ndim == 3 else 0):
        # An edge between two connected pinches is connected; every other edge may be absent.
        parity = tuple(slice(1 if k == axis else 0, None, 2) for k in range(3))
        ends = [connects[(slice(None),) * axis + (part,)] for part in (slice(-1), slice(1, None))]
        values[parity] = ends[0] & ends[1]
    return values


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("seed", range(60))
def test_random_cells_and_decisions(dim, seed):
    rng = np.random.default_rng(seed)
    for _ in range(4):
        shape = tuple(rng.integers(1, 8 if dim == 2 else 6, dim))
        kept = rng.random(shape) < rng.uniform(0.1, 0.9)
        is_pinch = find_pinches(kept)
        at_vertex = decide_by_vote(is_pinch, rng.random(is_pinch.shape) < 0.5).at_vertex
        connects, separates = at_vertex == CONNECT, at_vertex == SEPARATE
        predicted = effective_betti(kept, connects, separates)
        topology = Topology.from_fractions(decided_nodes(kept, connects))
        topology.require_agreement(name="decided")
        assert predicted == topology.betti_at(1.0)
        assert count_euler_characteristic(kept, connects) == predicted.euler_characteristic
