"""Betti numbers as a value."""

from __future__ import annotations

from typing import NamedTuple


class BettiNumbers(NamedTuple):
    """Components, holes and voids (paper: Homology).

    Examples
    --------
    >>> annulus = BettiNumbers(1, 1)
    >>> annulus.euler_characteristic, str(annulus)
    (0, '(1, 1, 0)')
    """

    betti_0: int
    betti_1: int
    betti_2: int = 0

    @property
    def euler_characteristic(self) -> int:
        """Alternating sum of the Betti numbers."""
        return self.betti_0 - self.betti_1 + self.betti_2

    def __str__(self) -> str:
        return f"({self.betti_0}, {self.betti_1}, {self.betti_2})"
