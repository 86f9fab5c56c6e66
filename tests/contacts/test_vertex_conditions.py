"""The good sticks and the order rule in all neighbourhoods of a vertex in 3D."""

import itertools

import numpy as np
import pytest

from tusqh.contacts.octants import BITS, octants
from tusqh.contacts.stick_field import Field, find_pinched
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


def all_orders(labellings):
    """Return the labellings with their labels renamed in all orders."""
    found = []
    n_labels = labellings.max(axis=1) + 1
    for m in range(1, 9):
        some = labellings[n_labels == m]
        found += [np.array(p, dtype=np.int32)[some] for p in itertools.permutations(range(m))]
    return np.concatenate(found)


def judge_sticks(labels, sticks, *, tables=TABLES, by_link=False):
    """Judge vertices with the given octants and sticks; `by_link` by the general condition.

    The general condition holds at unmarked vertices, whose six neighbours are marked, which
    refines the same faces.
    """
    n = len(labels)
    field = Field(
        labels=np.zeros(n * N_BLOCK, dtype=np.int32),
        marked=np.zeros(n * N_BLOCK, dtype=bool),
        sticks=np.full((3, n * N_BLOCK), -1, dtype=np.int32),
        sides=np.zeros((3, n * N_BLOCK), dtype=np.uint8),
        steps=STEPS,
    )
    middle = MIDDLE + N_BLOCK * np.arange(n)
    for a in range(8):
        field.labels[middle + (BITS[a] - 1) @ STEPS] = labels[:, a]
    for e in range(6):
        axis, end = divmod(e, 2)
        field.sticks[axis, middle - (1 - end) * STEPS[axis]] = sticks[:, e]
        if by_link:
            field.marked[middle + (2 * end - 1) * STEPS[axis]] = True
    field.marked[middle] = not by_link
    return judge(middle, field, tables)


def choices_of_sticks(labels):
    """Return all sticks that a vertex with some octants may have."""
    four = [np.unique(labels[around]) for around in TABLES.around]
    return np.array(list(itertools.product(*four)), dtype=np.int32)


def check_choices(labellings):
    """Every labelling has good sticks; the closed form agrees with the link of the vertex."""
    n_all = n_good = n_mutant = 0
    mutant = TABLES._replace(splits=np.zeros(64, dtype=bool))
    for labels in labellings:
        sticks = choices_of_sticks(labels)
        several = np.repeat(labels[None], len(sticks), axis=0)
        good = judge_sticks(several, sticks)
        assert good.any(), labels
        assert (good == judge_sticks(several, sticks, by_link=True)).all(), labels
        # A mutant that lets one material have two opposite sticks, or exactly the other four.
        n_mutant += int((judge_sticks(several, sticks, tables=mutant) != good).sum())
        n_all += len(sticks)
        n_good += int((good > 0).sum())
    assert n_mutant > 0
    assert 0.5 < n_good / n_all < 1


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


def test_labellings_have_good_sticks_and_the_closed_form_agrees_with_the_link():
    check_choices(partitions(8)[::60])


@pytest.mark.slow
def test_all_labellings_have_good_sticks_and_the_closed_form_agrees_with_the_link():
    check_choices(partitions(8))


def check_orders(labels):
    first = labels[:, TABLES.around].min(axis=2)
    assert (judge_sticks(labels, first) > 0).all()
    # In the mutants, one of two opposite sticks has the last of its materials instead.
    last = first.copy()
    last[:, 0] = labels[:, TABLES.around[0]].max(axis=1)
    assert (judge_sticks(labels, last) == 0).any()


def test_the_order_rule_is_good_at_a_marked_vertex():
    check_orders(all_orders(partitions(8)[::50]))


@pytest.mark.slow
def test_the_order_rule_is_good_at_a_marked_vertex_in_all_545835_orders():
    everything = all_orders(partitions(8))
    assert len(everything) == 545_835
    for some in np.array_split(everything, 8):
        check_orders(some)
