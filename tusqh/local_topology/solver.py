"""Reach Betti numbers that no threshold has by the cheapest choice of cuts, fills and openings.

Each way to change a class has a price and an effect on the Betti numbers.  The choice with the
least total price whose effects add up to the target is found by a search over the numbers of
changes of each effect, because of each effect the cheapest ones are taken.  Then the changes are
made, one after the other.  One that the others made impossible is left out, and the search is
repeated from where it stands.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from tusqh.local_topology.features import Done, Features, Impossible
from tusqh.local_topology.wishes import CUT, FILL, OPEN, Wish
from tusqh.topology.betti_numbers import BettiNumbers

#: Largest number of choices that a search looks at.
_MOST_CHOICES = 20_000

#: Largest number of classes that are considered, and of the product with the cells of the grid.
MOST_CLASSES, _MOST_WORK = 300, 50_000_000

#: Distance of Betti numbers to the target; 0 if they are as wanted.
Distance = Callable[[BettiNumbers], float]

Effect = tuple[int, ...]


class Offer(NamedTuple):
    """A way to change a class, with its price.

    Parameters
    ----------
    cells
        Number of cells that change.
    wish
        What is done.
    effect
        The change of the Betti numbers.
    """

    cells: int
    wish: Wish
    effect: Effect


class Solution(NamedTuple):
    """The best that was found.

    Parameters
    ----------
    done
        The cells.
    distance
        Distance of their Betti numbers to the target.
    """

    done: Done
    distance: float


def solve(
    features: Features, start: Done, distance: Distance, held: frozenset[int] = frozenset()
) -> Solution:
    """Return the cells that are nearest to a target, and among these those with few changes.

    Parameters
    ----------
    features
        The classes at the base.
    start
        The cells to begin with.
    distance
        Distance of Betti numbers to the target.
    held
        Rows of classes that stay as they are.
    """
    rows = [row for row in nearest_to_base(features) if row not in held]
    refused: set[Wish] = set()
    best = Solution(start, distance(start.betti))
    done = start
    while distance(done.betti) > 0:
        useful = [row for row in rows if _may_help(features, done, row, distance)]
        offers = [o for o in find_offers(features, done, useful, held) if o.wish not in refused]
        plan = _cheapest(offers, done.betti, distance)
        if not plan:
            break
        done, failed = _carry_out(features, done, plan)
        if distance(done.betti) < best.distance:
            best = Solution(done, distance(done.betti))
        if not failed:
            continue
        refused |= failed
    return best


def _may_help(features: Features, done: Done, row: int, distance: Distance) -> bool:
    """Return whether a class may bring the Betti numbers nearer to the target.

    One that is removed or filled whole takes others along, so it always may.
    """
    dimension, is_there = int(features.classes["dimension"][row]), row in done.there
    if is_there and dimension in (0, features.grid.dim - 1):
        return True
    after = np.array(done.betti)
    after[dimension] += -1 if is_there else 1
    return distance(BettiNumbers(*after.tolist())) < distance(done.betti)


def nearest_to_base(features: Features) -> list[int]:
    """Return the rows of the classes that begin or end nearest to the base, which cost the least.

    There are at most `MOST_CLASSES`, and on large grids fewer.

    Parameters
    ----------
    features
        The classes at the base.
    """
    table, base = features.classes, features.base
    birth, death = table["birth"].to_numpy() - base, base - table["death"].to_numpy()
    away = np.minimum(np.abs(birth), np.abs(death))
    n = min(MOST_CLASSES, max(20, _MOST_WORK // features.grid.n_cells))
    return [int(k) for k in np.argsort(away, kind="stable")[:n]]


def find_offers(
    features: Features, done: Done, rows: list[int], held: frozenset[int] = frozenset()
) -> list[Offer]:
    """Return what each way to change a class costs, for all that are possible.

    Parameters
    ----------
    features
        The classes at the base.
    done
        The cells so far.
    rows
        Rows of the classes.
    held
        Rows of classes that must not end with others.
    """
    changed = {wish.row for wish, _ in done.steps}
    offers = []
    for row in rows:
        if row in changed:
            continue
        for do in (CUT, FILL) if row in done.there else (OPEN,):
            try:
                after = features.apply(done, Wish(row, do))
            except Impossible:
                continue
            if held & (done.there - after.there):
                continue
            effect = tuple(np.subtract(after.betti, done.betti).tolist())
            offers.append(Offer(len(after.steps[-1][1]), Wish(row, do), effect))
    return sorted(offers)


def _cheapest(offers: list[Offer], betti: BettiNumbers, distance: Distance) -> list[Offer]:
    """Return the offers with the least total price that come nearest to the target.

    A search takes, of the offers with the same effect, the cheapest ones first.
    """
    by_effect: dict[Effect, list[Offer]] = {}
    for offer in offers:
        by_effect.setdefault(offer.effect, []).append(offer)
    groups = list(by_effect.values())
    best: tuple[float, float, tuple[int, ...]] = (distance(betti), 0, (0,) * len(groups))
    queue, seen = [(0, best[2])], {best[2]}
    for _ in range(_MOST_CHOICES):
        if not queue:
            break
        cells, counts = heapq.heappop(queue)
        found = _add(betti, groups, counts)
        if min(found) >= 0 and distance(found) < best[0]:
            best = (distance(found), cells, counts)
            if best[0] == 0:
                break
        for more, counts_after in _with_one_more(groups, counts):
            if counts_after not in seen:
                seen.add(counts_after)
                heapq.heappush(queue, (cells + more, counts_after))
    chosen = [groups[k][:n] for k, n in enumerate(best[2])]
    return sorted(itertools.chain.from_iterable(chosen))


def _add(betti: BettiNumbers, groups: list[list[Offer]], counts: tuple[int, ...]) -> BettiNumbers:
    """Return Betti numbers after some offers of each group."""
    total = np.array(betti)
    for group, n in zip(groups, counts, strict=True):
        total = total + n * np.array(group[0].effect)
    return BettiNumbers(*total.tolist())


def _with_one_more(
    groups: list[list[Offer]], counts: tuple[int, ...]
) -> Iterator[tuple[int, tuple[int, ...]]]:
    """Yield the price of one more offer of each group, and the numbers of offers with it."""
    for k, (group, n) in enumerate(zip(groups, counts, strict=True)):
        rows = {o.wish.row for other, m in zip(groups, counts, strict=True) for o in other[:m]}
        if n < len(group) and group[n].wish.row not in rows:
            yield group[n].cells, (*counts[:k], n + 1, *counts[k + 1 :])


def _carry_out(features: Features, done: Done, plan: list[Offer]) -> tuple[Done, set[Wish]]:
    """Return the cells after the offers of a plan, and those that are not possible any more.

    An offer whose effect has changed is refused too, so that the next plan knows it.
    """
    failed: set[Wish] = set()
    for offer in plan:
        try:
            after = features.apply(done, offer.wish)
        except Impossible:
            failed.add(offer.wish)
            continue
        effect = tuple(np.subtract(after.betti, done.betti).tolist())
        if effect == offer.effect:
            done = after
        else:
            failed.add(offer.wish)
    return done, failed
