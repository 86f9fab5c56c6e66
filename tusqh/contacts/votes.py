"""Count the votes of contacts, which determine the best material among the cells at a place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tusqh.grid import BackgroundGrid, FloatArray, IntArray


class Fractions(Protocol):
    """The fractions of all materials on a background grid, of one or of many."""

    @property
    def grid(self) -> BackgroundGrid:
        """The background grid, of shape n."""

    @property
    def void(self) -> int:
        """Label of the void, the last material."""

    def multiples_at(self, places: IntArray, labels: NDArray[np.int32]) -> IntArray:
        """Return the fractions of chosen materials at some places, in multiples of 2**-20.

        Parameters
        ----------
        places
            Flat places of the doubled grid, shape (r,).
        labels
            Materials to look up at each of them, shape (r, c).
        """


@dataclass(frozen=True)
class Votes:
    """The material for which each place votes, and the price of each alternative.

    Parameters
    ----------
    winner
        Material for which each place votes, shape (r,), int32.
    price
        Price of every candidate, shape (r, c): 0 for the winner, otherwise 1 plus half of its
        relative loss of score against the winner, which is between 0 (a tie) and 1.
    """

    winner: NDArray[np.int32]
    price: FloatArray


def count_votes(
    fractions: Fractions,
    places: IntArray,
    candidates: NDArray[np.int32],
    thresholds: IntArray,
) -> Votes:
    """Return the votes of places of the doubled grid.

    The score of a material is the ratio of its fraction to its threshold.  Scores are compared
    exactly, as products of multiples of 2**-20; in a tie the first material wins.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    places
        Flat places of the doubled grid; -1 for places outside it, which are void, shape (r,).
    candidates
        Materials of the cells around each place, shape (r, c).
    thresholds
        Threshold of every material, in multiples of 2**-20, shape (m,).
    """
    multiples = fractions.multiples_at(np.maximum(places, 0), candidates)
    multiples[places < 0] = candidates[places < 0] == fractions.void
    rows = np.arange(len(places))
    t = thresholds[candidates]
    best = np.zeros(len(places), dtype=np.int64)
    for c in range(1, candidates.shape[1]):
        f, g = multiples[:, c], multiples[rows, best]
        both = (f > 0) & (g > 0)
        left = np.where(both, f * t[rows, best], f)
        right = np.where(both, g * t[:, c], g)
        is_first = candidates[:, c] < candidates[rows, best]
        best = np.where((left > right) | ((left == right) & is_first), c, best)
    winner = candidates[rows, best]
    own = multiples * t[rows, best][:, None]
    others = multiples[rows, best][:, None] * t
    with np.errstate(invalid="ignore", divide="ignore"):
        loss = np.where(others > 0, 1.0 - own / others, 0.0)
    price = 1.0 + 0.5 * np.clip(loss, 0.0, 1.0)
    price[candidates == winner[:, None]] = 0.0
    return Votes(winner=winner.astype(np.int32), price=price)
