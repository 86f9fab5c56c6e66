"""The list of the classes of one material at a base: their rows, places and words."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.errors import ConfigError
from tusqh.grid import BackgroundGrid, FloatArray, IntArray
from tusqh.local_topology.changeable import State


class LocatedClasses:
    """Classes with the points at which wishes look for them.

    Parameters
    ----------
    grid
        The background grid.
    classes
        The classes, see `tusqh.local_topology.classes.list_classes`, with the threshold of the base
        (`base`), and whether it has each one (`is_there`).
    """

    def __init__(self, grid: BackgroundGrid, classes: pd.DataFrame) -> None:
        self.grid = grid
        #: The classes.
        self.classes = classes

    @property
    def points(self) -> FloatArray:
        """The points at which wishes look for the classes, shape (r, dim), in model units."""
        return self.classes[[*"xyz"[: self.grid.dim]]].to_numpy(dtype=float)

    def nearest(self, row: int, done: State, n: int = 3) -> list[int]:
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
        rows = np.array(sorted(done.there - {row}), dtype=np.int64)
        distance = ((self.points[rows] - self.points[row]) ** 2).sum(axis=1)
        return [int(k) for k in rows[np.argsort(distance, kind="stable")[:n]]]

    def is_below(self, row: int) -> bool:
        """Return whether a class begins below the base.

        Parameters
        ----------
        row
            Row of the class.
        """
        return bool(self.classes["birth"][row] < self.classes["base"][row])


class ListedClasses(LocatedClasses):
    """The classes of one material at a base.

    Parameters
    ----------
    grid, classes
        See `LocatedClasses`.
    base
        Threshold of the base in (0, 1].
    """

    def __init__(self, grid: BackgroundGrid, classes: pd.DataFrame, base: float) -> None:
        super().__init__(grid, classes)
        self.base = base

    @property
    def where(self) -> str:
        """The base, in words."""
        return f"the threshold {self.base:.6g}"

    def rows_of(self, material: str | None) -> IntArray:
        """Return all rows; there is one material, which has no name.

        Parameters
        ----------
        material
            None.

        Raises
        ------
        ConfigError
            A material is named.
        """
        if material is not None:
            raise ConfigError(
                f"a wish for a feature of the material {material!r}",
                where="features",
                expected="wishes without a material, because there is only one",
                remedy="leave the material out, or mesh several with `--materials`",
            )
        return np.arange(len(self.classes), dtype=np.int64)

    def position(self, row: int) -> int:
        """Return the dimension of a class, the place of its number in the Betti numbers.

        Parameters
        ----------
        row
            Row of the class.
        """
        return int(self.classes["dimension"][row])

    def describe(self, row: int) -> str:
        """Return a class in words.

        Parameters
        ----------
        row
            Row of the class.
        """
        about = self.classes.iloc[row]
        at = ", ".join(f"{about[axis]:.4g}" for axis in "xyz"[: self.grid.dim])
        return (
            f"row {row}: {about['class']} at ({at}), {about['birth']:.4g} to {about['death']:.4g}"
        )
