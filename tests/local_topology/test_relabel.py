"""Cells of several materials are relabelled without a change of the topology of any of them."""

import numpy as np
import pytest
from flag_complexes import around, betti_by_flag_complex, has_contractible_link, is_pinched
from random_materials import random_materials
from scipy import ndimage

from tusqh.contacts import MaterialFractions
from tusqh.contacts.decide import decide_contacts
from tusqh.contacts.mesh import mesh_materials, round_thresholds
from tusqh.contacts.predict import predict_betti
from tusqh.contacts.surround import LAYERS_OF
from tusqh.grid import BackgroundGrid
from tusqh.local_topology.relabel import relabel_to_base


def decide(fractions, labels, thresholds):
    """Return the decided contacts of labels, and which material has each contact by its place."""
    decision = decide_contacts(fractions, labels, thresholds)
    contacts, winners = decision.contacts, {}
    layers = LAYERS_OF[labels.ndim]
    for cells, material in (
        (contacts.edge_cells, contacts.edge_material),
        (contacts.vertex_cells, contacts.ball),
    ):
        index = np.stack(np.unravel_index(cells, decision.labels.shape)) - layers
        places = np.rint(2 * index.mean(axis=2) + 1).astype(int).T
        winners |= dict(zip(map(tuple, places.tolist()), material.tolist(), strict=True))
    padded = np.ascontiguousarray(decision.labels, dtype=np.int32)
    return predict_betti(padded, contacts, len(fractions.names)), winners


def votes_of(winners, material, shape):
    """Return where contacts have a material, on the doubled grid."""
    votes = np.zeros(tuple(2 * n + 1 for n in shape), dtype=bool)
    for place, winner in winners.items():
        votes[place] = winner == material
    return votes


def is_simple(fractions, labels, thresholds, cell, goal):
    """Return whether a relabelling is simple by definition, with gudhi, from all decisions."""
    own, after = labels[cell], labels.copy()
    after[cell] = goal
    void, at = fractions.void, tuple(i + 1 for i in cell)
    winners = [_inside_void(decide(fractions, w, thresholds)[1]) for w in (labels, after)]
    padded = [np.pad(which, 1, constant_values=void) for which in (labels, after)]
    middle = 2 * np.array(at) + 1
    near = [p for p in {*winners[0], *winners[1]} if np.abs(np.array(p) - middle).max() < 2]
    decided = {own: {}, goal: {}}
    for place in near:
        for k in np.unique(padded).tolist():
            pinched = [is_pinched(around(which == k, place)) for which in padded]
            have = [found.get(place, -1) == k for found in winners]
            if all(pinched) and have[0] != have[1]:
                return False
            if k in decided:
                decided[k][place] = k if have[0 if pinched[0] else 1] else -1
    return all(
        has_contractible_link(padded[0] == k, votes_of(decided[k], k, padded[0].shape), at)
        for k in decided
    )


def _inside_void(winners):
    """Return decisions by their places in the grid with a layer of void around it."""
    return {tuple(i + 2 for i in place): winner for place, winner in winners.items()}


def smooth_materials(rng, dim, largest):
    """Return fractions of two to four materials and the void with connected regions."""
    shape = tuple(int(n) for n in rng.integers(3, largest + 1, dim))
    m = int(rng.integers(2, 5))
    fields = rng.random((m + 1, *(2 * n + 1 for n in shape)))
    fields = ndimage.gaussian_filter(fields, (0, *(1.5,) * dim))
    fields = np.exp(25 * (fields - fields.max()))
    fields /= fields.sum(axis=0)
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0,) * dim)
    names = [f"material {k}" for k in range(m)]
    multiples = [np.floor(f * 2**20).astype(np.int32) for f in fields[:m]]
    return MaterialFractions.from_multiples(grid, names, multiples)


def some_case(seed, dim, largest):
    """Return random fractions of up to four materials and the void, a seed and a base."""
    rng = np.random.default_rng(seed)
    if seed % 2:
        fractions, named = smooth_materials(rng, dim, largest + 2), {}
    else:
        fractions, named = random_materials(seed, dim, largest)
    m = len(fractions.names)
    named = named or dict(zip(fractions.names, (rng.random(m) * 0.8 + 0.2).tolist(), strict=True))
    seeds = round_thresholds(fractions.names, named)
    base = np.maximum(2**18, (rng.random(m) * 2**20).astype(np.int64))
    return fractions, seeds, fractions.label_cells(seeds), fractions.label_cells(base)


def check(seed, dim, largest, *, by_flags, oracle=True):
    """Check a random field; return the numbers of relabelled cells, of those left, of materials."""
    fractions, thresholds, labels, base = some_case(seed, dim, largest)
    before, _ = decide(fractions, labels, thresholds)
    found = relabel_to_base(fractions, labels, base, thresholds)
    after, winners = decide(fractions, found, thresholds)
    assert after == before, seed
    named = dict(zip(fractions.names, (thresholds / 2**20).tolist(), strict=True))
    mesh = mesh_materials(fractions, thresholds=named, labels=found, with_void=True)
    assert mesh.is_as_predicted, seed
    assert [mesh.predicted[name] for name in fractions.names] == before
    for k in np.unique(found)[:-1].tolist() if by_flags else ():
        votes = votes_of(winners, k, found.shape)
        assert betti_by_flag_complex(found == k, votes) == tuple(before[k]), (seed, k)
    is_left = found != base
    assert (found[is_left] == labels[is_left]).all()
    if oracle:
        for cell in map(tuple, np.argwhere(is_left).tolist()):
            assert not is_simple(fractions, found, thresholds, cell, base[cell]), (seed, cell)
    return int((found != labels).sum()), int(is_left.sum()), len(np.unique(found))


@pytest.mark.parametrize(("dim", "largest", "n_fields"), [(2, 7, 40), (3, 4, 16)])
def test_relabelling_keeps_the_topology_of_every_material(dim, largest, n_fields):
    counts = [check(seed, dim, largest, by_flags=seed % 4 == 0) for seed in range(n_fields)]
    n_changed, n_left, n_materials = np.sum(counts, axis=0)
    assert n_changed > 2 * n_fields
    assert n_left > n_fields
    assert n_materials > 2 * n_fields


@pytest.mark.slow
@pytest.mark.parametrize(("dim", "largest", "n_fields"), [(2, 7, 2000), (3, 4, 1000)])
def test_relabelling_keeps_the_topology_in_many_fields(dim, largest, n_fields):
    for seed in range(1000, 1000 + n_fields):
        check(seed, dim, largest, by_flags=seed % 4 == 0)
