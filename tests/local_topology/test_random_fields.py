"""The result has the seed's Betti numbers by three counts, on random fields with ties."""

import gudhi
import numpy as np
import pytest

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.contacts.one_material import thresholds_of
from tusqh.grid import BackgroundGrid
from tusqh.local_topology.move import move_to_base
from tusqh.sampling.fractions import VolumeFractions, round_fractions
from tusqh.settings.policy import Policy

NO_BRIDGES = Policy(bridges="none")


def random_field(seed, dim, largest):
    """Return fractions with ties and plateaus, smooth or rough, whose sub-cells may contradict."""
    rng = np.random.default_rng(seed)
    shape = tuple(int(n) for n in rng.integers(2, largest + 1, dim))
    places = tuple(2 * n + 1 for n in shape)
    kind = seed % 4
    if kind == 0:
        values = rng.random(places)
    elif kind == 1:
        values = rng.integers(0, 4, places) / 3
    elif kind == 2:  # Cells with few levels, and sub-cells that are their means with some noise.
        values = rng.integers(0, 6, places) / 5
        values = np.clip(values + 0.2 * (rng.random(places) - 0.5), 0, 1)
    else:  # The outside is empty and the inside nearly full.
        values = np.clip(rng.random(places) + 0.3, 0, 1)
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0,) * dim)
    return VolumeFractions.from_values(grid, 4, round_fractions(values))


def thresholds_to_try(cell_sets, rng, n):
    """Return a threshold of some intervals of the fractions, always including the extremes."""
    levels = cell_sets.distinct_fractions
    chosen = levels if len(levels) <= n else rng.choice(levels, n, replace=False)
    return [float(t) for t in chosen]


def betti_by_flag_complex(kept, votes):
    """Return the Betti numbers of kept cells whose pinches follow their votes, by gudhi."""
    kept, dim = np.pad(kept, 1), kept.ndim
    votes = np.pad(votes, 2)
    places = np.zeros(votes.shape, dtype=bool)
    for place in np.ndindex(votes.shape):
        odd = sum(i % 2 for i in place)
        if odd == dim - 1 and dim > 1:  # No node.
            continue
        around = np.ix_(*[[i // 2] if i % 2 else [i // 2 - 1, i // 2] for i in place])
        if any(
            i % 2 == 0 and (i == 0 or i == n - 1) for i, n in zip(place, votes.shape, strict=True)
        ):
            continue
        cells = kept[around]
        if is_pinched(cells):
            places[place] = votes[place]
        else:
            places[place] = cells.any()
    return betti_of_nodes(places)


def is_pinched(cells):
    """Return whether kept cells, or empty ones, of a block of two cells a side are not joined."""
    block = np.squeeze(cells)
    if block.ndim < 2:
        return False
    return any(n_joined(side) > 1 for side in (block, ~block))


def n_joined(cells):
    from scipy import ndimage

    return ndimage.label(cells)[1]


def betti_of_nodes(is_node):
    """Return the Betti numbers of the paper's complex of some places."""
    dim = is_node.ndim
    number = {tuple(p): i for i, p in enumerate(np.argwhere(is_node).tolist())}
    tree = gudhi.SimplexTree()
    for p, i in number.items():
        tree.insert([i])
        for step in np.ndindex((5,) * dim):
            q = tuple(a + s - 2 for a, s in zip(p, step, strict=True))
            if q in number and i < number[q] and is_joined(p, q):
                tree.insert([i, number[q]])
    tree.expansion(dim)
    tree.set_dimension(dim)
    tree.compute_persistence(persistence_dim_max=True)
    found = [*tree.betti_numbers(), 0, 0, 0]
    return tuple(found[:3])


def is_joined(p, q):
    """Return whether two places are cells with a common face, or one contains the other."""
    differ = [abs(a - b) for a, b in zip(p, q, strict=True)]
    odd = [all(i % 2 for i in place) for place in (p, q)]
    if all(odd):
        return sorted(differ)[-1] == 2 and sum(differ) == 2
    if max(differ) > 1:
        return False
    # One of the two is on the boundary of the other: it is even wherever they differ.
    for a, b in ((p, q), (q, p)):
        if all(x == y or (x % 2 == 0 and y % 2 == 1) for x, y in zip(a, b, strict=True)):
            return True
    return False


@pytest.mark.parametrize("dim", [2, 3])
def test_the_flag_complex_is_that_of_the_mesh(dim):
    for seed in range(8):
        fractions = random_field(seed, dim, 4 if dim == 3 else 6)
        cells = CellSets(fractions, NO_BRIDGES).at(0.5)
        votes = fractions.multiples >= thresholds_of(0.5)[0]
        assert betti_by_flag_complex(cells.kept, votes) == tuple(cells.predicted)


def check_field(seed, dim, largest, n_seeds):
    """Check all three counts for seeds and bases of a random field; return how many were held."""
    fractions = random_field(seed, dim, largest)
    rng = np.random.default_rng(seed)
    cell_sets = CellSets(fractions, NO_BRIDGES)
    n_changed = n_held = 0
    for threshold in thresholds_to_try(cell_sets, rng, n_seeds):
        start = cell_sets.at(threshold)
        base = float(rng.choice([0.5, rng.choice(cell_sets.distinct_fractions)]))
        in_base = cell_sets.at(base)
        found = move_to_base(start, in_base)
        assert found.predicted == start.predicted
        mesh = build_mesh(found, fractions.grid).mesh
        if found.kept.any():
            assert mesh.measurement.has_topology(start.predicted)
            assert mesh.measurement.is_sound
        votes = fractions.multiples >= thresholds_of(threshold)[0]
        assert betti_by_flag_complex(found.kept, votes) == tuple(start.predicted)
        outside = start.kept == found.in_base
        assert (found.kept[outside] == found.in_base[outside]).all()
        n_changed += int((found.kept != start.kept).sum())
        n_held += found.n_held > 0
    return n_changed, n_held


def test_random_fields_2d():
    counts = np.array([check_field(seed, 2, 7, 4) for seed in range(30)])
    assert counts[:, 0].sum() > 400


def test_random_fields_3d():
    counts = np.array([check_field(seed, 3, 4, 2) for seed in range(16)])
    print(counts.sum(axis=0))
    assert counts[:, 0].sum() > 100
