"""Reach Betti numbers that no threshold has by the cheapest choice of cuts, fills and openings.

Each way to change a class has a price and an effect on the Betti numbers.  The choice with the
least total price whose effects add up to the target is found by a search over the numbers of
changes of each effect, because of each effect the cheapest ones are taken.  Then the changes are
made, one after the other, openings first.  One that the others made impossible, or that now does
something else, is left out, and the search is repeated from where it stands.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Iterator
from typing import Generic, NamedTuple

import numpy as np

from tusqh.local_topology.changeable import Changeable, Impossible, S
from tusqh.local_topology.wishes import CUT, FILL, OPEN, Wish

#: Largest number of choices that a search looks at.
_MOST_CHOICES = 20_000

#: Largest number of classes that are considered, and of the product with the cells of the grid.
MOST_CLASSES, _MOST_WORK = 300, 50_000_000

#: Distance of Betti numbers to the target; 0 if they are as wanted.
Distance = Callable[[tuple[int, ...]], float]

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


class Solution(NamedTuple, Generic[S]):
    """The best that was found.

    Parameters
    ----------
    done
        The cells.
    distance
        Distance of their Betti numbers to the target.
    """

    done: S
    distance: float


def solve(
    features: Changeable[S], start: S, distance: Distance, held: frozenset[int] = frozenset()
) -> Solution[S]:
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
        for considered in (useful, rows):
            offers = find_offers(features, done, considered, held)
            offers = [offer for offer in offers if offer.wish not in refused]
            plan = _cheapest(offers, done.betti, distance)
            if plan:
                break
        else:
            break
        after, failed = _carry_out(features, done, plan)
        refused |= {wish for wish, is_possible in failed if after is done or not is_possible}
        done = after
        if distance(done.betti) < best.distance:
            best = Solution(done, distance(done.betti))
    return best


def _may_help(features: Changeable[S], done: S, row: int, distance: Distance) -> bool:
    """Return whether a class may bring the Betti numbers nearer to the target.

    One that is removed or filled whole takes others along, so it always may.
    """
    dimension, is_there = int(features.classes["dimension"][row]), row in done.there
    if is_there and dimension in (0, features.grid.dim - 1):
        return True
    after = list(done.betti)
    after[features.position(row)] += -1 if is_there else 1
    return distance(tuple(after)) < distance(done.betti)


def nearest_to_base(features: Changeable[S]) -> list[int]:
    """Return the rows of the classes that begin or end nearest to the base, which cost the least.

    There are at most `MOST_CLASSES`, and on large grids fewer.

    Parameters
    ----------
    features
        The classes at the base.
    """
    table = features.classes
    birth, death = table["birth"] - table["base"], table["base"] - table["death"]
    away = np.minimum(birth.abs().to_numpy(), death.abs().to_numpy())
    n = min(MOST_CLASSES, max(20, _MOST_WORK // features.grid.n_cells))
    return [int(k) for k in np.argsort(away, kind="stable")[:n]]


def find_offers(
    features: Changeable[S], done: S, rows: list[int], held: frozenset[int] = frozenset()
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


def _cheapest(offers: list[Offer], betti: tuple[int, ...], distance: Distance) -> list[Offer]:
    """Return the offers with the least total price that come nearest to the target.

    A search takes, of the offers with the same effect, the cheapest ones first, and goes on with
    the choice whose price and least further price are together the smallest (A*).
    """
    per_step = min((o.cells / sum(map(abs, o.effect)) for o in offers if any(o.effect)), default=0)
    by_effect: dict[Effect, list[Offer]] = {}
    for offer in offers:
        by_effect.setdefault(offer.effect, []).append(offer)
    groups = list(by_effect.values())
    best: tuple[float, float, tuple[int, ...]] = (distance(betti), 0, (0,) * len(groups))
    queue, seen = [(0.0, 0, best[2])], {best[2]}
    for _ in range(_MOST_CHOICES):
        if not queue:
            break
        _, cells, counts = heapq.heappop(queue)
        found = _add(betti, groups, counts)
        if min(found) >= 0 and distance(found) < best[0]:
            best = (distance(found), cells, counts)
            if best[0] == 0:
                break
        for more, counts_after in _with_one_more(groups, counts):
            if counts_after not in seen:
                seen.add(counts_after)
                left = per_step * distance(_add(betti, groups, counts_after))
                heapq.heappush(queue, (cells + more + left, cells + more, counts_after))
    chosen = [groups[k][:n] for k, n in enumerate(best[2])]
    return sorted(itertools.chain.from_iterable(chosen))


def _add(
    betti: tuple[int, ...], groups: list[list[Offer]], counts: tuple[int, ...]
) -> tuple[int, ...]:
    """Return Betti numbers after some offers of each group."""
    total = np.array(betti)
    for group, n in zip(groups, counts, strict=True):
        total = total + n * np.array(group[0].effect)
    return tuple(total.tolist())


def _with_one_more(
    groups: list[list[Offer]], counts: tuple[int, ...]
) -> Iterator[tuple[int, tuple[int, ...]]]:
    """Yield the price of one more offer of each group, and the numbers of offers with it."""
    for k, (group, n) in enumerate(zip(groups, counts, strict=True)):
        rows = {o.wish.row for other, m in zip(groups, counts, strict=True) for o in other[:m]}
        if n < len(group) and group[n].wish.row not in rows:
            yield group[n].cells, (*counts[:k], n + 1, *counts[k + 1 :])


def _carry_out(
    features: Changeable[S], done: S, plan: list[Offer]
) -> tuple[S, list[tuple[Wish, bool]]]:
    """Return the cells after the offers of a plan, and those that failed, openings first.

    An offer fails if it is impossible after the others, or possible with another effect.
    """
    failed: list[tuple[Wish, bool]] = []
    for offer in sorted(plan, key=lambda o: (o.wish.do != OPEN, o)):
        try:
            after = features.apply(done, offer.wish)
        except Impossible:
            failed.append((offer.wish, False))
            continue
        effect = tuple(np.subtract(after.betti, done.betti).tolist())
        if effect == offer.effect:
            done = after
        else:
            failed.append((offer.wish, True))
    return done, failed
