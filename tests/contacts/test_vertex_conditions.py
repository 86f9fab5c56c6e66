"""The good sticks in all neighbourhoods of a vertex in 3D."""

import itertools

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from tusqh.contacts.octants import BITS, octants
from tusqh.contacts.planar import find_diagonals
from tusqh.contacts.stick_field import Field, faces_of_kites, find_pinched
from tusqh.contacts.sticks import judge

TABLES = octants()
#: A block of 3 x 3 x 3 vertices with one in the middle; blocks follow one another.
STEPS = np.array([9, 3, 1], dtype=np.int64)
MIDDLE, N_BLOCK = 13, 27


def partitions(n):
    """Return all labellings of n things up to names: a label is at most one above those before."""
    found = np.zeros((1, 0), dtype=np.int32)
    for _ in range(n):
        top = found.max(axis=1, initial=-1) + 1
        found = np.concatenate(
            [np.column_stack([found[top >= k], np.full((top >= k).sum(), k)]) for k in range(n)]
        ).astype(np.int32)
    return found


def judge_sticks(labels, sticks, ball, *, tables=TABLES):
    """Judge vertices with the given octants, sticks and balls; sticks of pinched edges decide."""
    n = len(labels)
    field = Field(
        labels=np.zeros(n * N_BLOCK, dtype=np.int32),
        inside=np.ones(n * N_BLOCK, dtype=bool),
        between=np.zeros(n * N_BLOCK, dtype=np.uint8),
        ball=np.full(n * N_BLOCK, -1, dtype=np.int32),
        is_pinched=np.zeros((3, n * N_BLOCK), dtype=bool),
        marked=np.zeros(n * N_BLOCK, dtype=bool),
        has_ball=np.zeros(n * N_BLOCK, dtype=bool),
        sticks=np.full((3, n * N_BLOCK), -1, dtype=np.int32),
        sides=np.zeros((3, n * N_BLOCK), dtype=np.uint8),
        stale=np.zeros(n * N_BLOCK, dtype=bool),
        verdict=np.full(n * N_BLOCK, -1, dtype=np.int8),
        steps=STEPS,
        octant=(BITS - 1) @ STEPS,
        face=faces_of_kites(STEPS, TABLES.kites),
    )
    middle = MIDDLE + N_BLOCK * np.arange(n)
    for a in range(8):
        field.labels[middle + (BITS[a] - 1) @ STEPS] = labels[:, a]
    for axis in range(3):
        field.between[field.labels != np.roll(field.labels, STEPS[axis])] |= 1 << axis
    for e in range(6):
        axis, end = divmod(e, 2)
        edges = middle - (1 - end) * STEPS[axis]
        field.sticks[axis, edges] = sticks[:, e]
        field.is_pinched[axis, edges] = find_diagonals(labels[:, TABLES.around[e]].T)
    field.marked[middle] = True
    field.ball[middle] = ball
    return judge(middle, field, tables)


def choices_at(labels):
    """Return all sticks and balls that a vertex with some octants may have."""
    four = [np.unique(labels[around]) for around in TABLES.around]
    is_pinched = any(TABLES.is_pinched[(labels == k) @ (1 << np.arange(8))] for k in labels)
    ball = np.unique(labels) if is_pinched else [-1]
    chosen = np.array(list(itertools.product(*four, ball)), dtype=np.int32)
    return chosen[:, :6], chosen[:, 6]


def is_manifold(labels, sticks):
    """Return whether every material and its complement around a vertex are a disc, by a graph."""
    sectors = {}
    for a, b, e, f in TABLES.kites.tolist():
        for octant, half_edge in itertools.product((a, b), (e, f)):
            ring = labels[a] if labels[a] == labels[b] else sticks[half_edge]
            sectors[octant, frozenset((a, b)), half_edge] = ring
    corners, rings = list(sectors), np.array(list(sectors.values()))
    n_shared = [[sum(x == y for x, y in zip(s, t, strict=True)) for t in corners] for s in corners]
    beside = np.array(n_shared) == 2
    parts = [part for k in set(rings) for part in (rings == k, rings != k) if part.any()]
    return all(
        connected_components(csr_array(beside[np.ix_(part, part)]))[0] == 1 for part in parts
    )


def check_choices(labellings):
    """Every labelling has good sticks for some votes; return how many choices are good."""
    n_all = n_good = 0
    for labels in labellings:
        sticks, ball = choices_at(labels)
        good = judge_sticks(np.repeat(labels[None], len(sticks), axis=0), sticks, ball)
        assert good.any(), labels
        n_all += len(sticks)
        n_good += int(good.sum())
    return n_good, n_all


def test_all_labellings_of_a_vertex_by_the_table_and_by_definition():
    """There are 4140 labellings up to names, of which 3246 are pinched."""
    assert len(partitions(8)) == 4140
    masks = (partitions(8)[:, :, None] == partitions(8)[:, None]) @ (1 << np.arange(8))
    assert TABLES.is_pinched[masks].any(axis=1).sum() == 3246
    for labels in partitions(8)[::20]:
        cube = labels[[0, 4, 2, 6, 1, 5, 3, 7]].reshape(2, 2, 2)
        flat = np.zeros((3, 3, 3), dtype=np.int32)
        flat[:2, :2, :2] = cube
        shape = np.array([2, 2, 2])
        found = len(find_pinched(flat.ravel(), shape, STEPS, TABLES)) > 0
        sets = [{a for a in range(8) if labels[a] == k} for k in set(labels.tolist())]
        sets += [set(range(8)) - s for s in sets]
        assert found == any(count_pieces(s) > 1 for s in sets)


def count_pieces(some):
    """Count the pieces of a set of octants that share faces."""
    n, left = 0, set(some)
    while left:
        n += 1
        stack = [left.pop()]
        while stack:
            a = stack.pop()
            beside = {a ^ 1 << k for k in range(3)} & left
            left -= beside
            stack += beside
    return n


def test_labellings_have_good_sticks():
    n_good, n_all = check_choices(partitions(8)[::60])
    assert 0.1 < n_good / n_all < 0.9


@pytest.mark.slow
def test_all_labellings_have_good_sticks():
    check_choices(partitions(8))


def test_good_sticks_are_manifold_by_a_graph():
    """Sticks may also be bad because of the topology, so the graph allows at least as many."""
    rng = np.random.default_rng(0)
    n_good = n_not_manifold = n_of_mutant = 0
    # A mutant that takes every set of sectors to be connected.
    mutant = TABLES._replace(next_to=np.full((6, 256), (1 << 48) - 1))
    for labels in partitions(8)[::70]:
        sticks, ball = choices_at(labels)
        some = rng.choice(len(sticks), min(len(sticks), 12), replace=False)
        several = np.repeat(labels[None], len(some), axis=0)
        good = judge_sticks(several, sticks[some], ball[some])
        n_of_mutant += int(judge_sticks(several, sticks[some], ball[some], tables=mutant).sum())
        manifold = np.array([is_manifold(labels, s) for s in sticks[some]])
        assert (manifold | ~good).all(), labels
        n_good += int(good.sum())
        n_not_manifold += int((~manifold).sum())
    assert n_good > 100
    assert n_not_manifold > 20
    assert n_of_mutant > n_good
