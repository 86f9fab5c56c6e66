"""What one material and several have in common: classes at a base that wishes can change."""

from __future__ import annotations

from typing import Protocol, TypeVar

import pandas as pd

from tusqh.grid import BackgroundGrid, FloatArray, IntArray
from tusqh.local_topology.wishes import Wish


class Impossible(Exception):  # noqa: N818
    """A wish that cannot be met, with the reason."""


class State(Protocol):
    """Cells after some wishes."""

    @property
    def betti(self) -> tuple[int, ...]:
        """Their Betti numbers; of several materials, those of one after the other."""

    @property
    def there(self) -> frozenset[int]:
        """Rows of the classes that are there."""

    @property
    def steps(self) -> tuple[tuple[Wish, IntArray], ...]:
        """Each wish that changed cells, with the cells it changed, on the flat grid."""


S = TypeVar("S", bound=State)


class Changeable(Protocol[S]):
    """The classes at a base, each of which can be opened, cut or filled."""

    grid: BackgroundGrid

    @property
    def classes(self) -> pd.DataFrame:
        """The classes, see `tusqh.local_topology.classes.list_classes`, and `is_there`."""

    @property
    def points(self) -> FloatArray:
        """The points at which wishes look for the classes, shape (r, dim), in model units."""

    @property
    def where(self) -> str:
        """The base, in words."""

    def start(self) -> S:
        """Return the cells of the base."""

    def apply(self, done: S, wish: Wish) -> S:
        """Return the cells after one more wish, or raise `Impossible`.

        Parameters
        ----------
        done
            The cells so far.
        wish
            The wish; it changes nothing if the class is as wished.
        """

    def describe(self, row: int) -> str:
        """Return a class in words.

        Parameters
        ----------
        row
            Row of the class.
        """

    def nearest(self, row: int, done: S, n: int = 3) -> list[int]:
        """Return the rows of the classes nearest to another one that are there.

        Parameters
        ----------
        row
            Row of the other class.
        done
            The cells so far.
        n
            Largest number of rows.
        """

    def rows_of(self, material: str | None) -> IntArray:
        """Return the rows of the classes of a material, in the order in which wishes number them.

        Parameters
        ----------
        material
            Its name; None: there is only one.

        Raises
        ------
        ConfigError
            The material does not exist, is missing although the model has several, or is given
            although the model has only one.
        """

    def position(self, row: int) -> int:
        """Return the place of the number of a class's dimension in `State.betti`.

        Parameters
        ----------
        row
            Row of the class.
        """

    def is_below(self, row: int) -> bool:
        """Return whether a class begins below the base.

        Parameters
        ----------
        row
            Row of the class.
        """
