"""Cells of one material after some wishes, and a class as plain values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from tusqh.grid import BoolArray, IntArray
from tusqh.local_topology.wishes import Wish
from tusqh.topology.betti_numbers import BettiNumbers


class Row(NamedTuple):
    """A class as plain values, see `tusqh.local_topology.features.Features.classes`."""

    dimension: int
    birth: float
    death: float
    birth_place: int
    death_place: int
    is_there: bool


@dataclass(frozen=True)
class Done:
    """Cells after some wishes.

    Parameters
    ----------
    kept
        Kept cells of the flat grid.
    betti
        Their Betti numbers.
    there
        Rows of the classes that are there.
    steps
        Each wish that changed cells, with the cells it changed, on the flat grid.
    """

    kept: BoolArray
    betti: BettiNumbers
    there: frozenset[int]
    steps: tuple[tuple[Wish, IntArray], ...] = ()
