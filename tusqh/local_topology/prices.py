"""What it costs to open, cut or fill each class of the diagram, in cells and volume."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Generic, NamedTuple

import numpy as np
import pandas as pd

from tusqh.local_topology.changeable import Changeable, Impossible, S
from tusqh.local_topology.changes import ADDED, LEFT_OUT
from tusqh.local_topology.features import Features
from tusqh.local_topology.wishes import CUT, FILL, OPEN, Wish

#: Columns of the table of prices, before the coordinates.
PRICE_COLUMNS = ["row", "class", "birth", "death", "do", "change", "cells", "volume"]
PRICE_COLUMNS += ["betti_0", "betti_1", "betti_2", "possible", "why"]

#: Largest product of the number of rows and that of the grid's cells for which prices are found.
_WORK = 6_000_000

#: Number of rows for which prices are found on any grid, if the diagram has as many.
_FEWEST = 20


class Tried(NamedTuple, Generic[S]):
    """A wish that was tried by itself.

    Parameters
    ----------
    wish
        The wish.
    adds
        Whether cells are added, not left out.
    done
        The cells afterwards; None if the wish is impossible.
    why
        Why it is impossible, in words.
    """

    wish: Wish
    adds: bool
    done: S | None
    why: str = ""


def tabulate_prices(features: Features, rows: Sequence[int] | None = None) -> pd.DataFrame:
    """Return the price of each way to change each class, by itself, at the base.

    Parameters
    ----------
    features
        The classes at the base.
    rows
        Rows of the classes; None: all, see `affordable_rows`.

    Returns
    -------
    prices
        One row per class and way: the `row` of the diagram, its `class`, `birth` and `death`; `do`;
        whether cells would be added or left out (`change`), their number, and their volume (model
        units**dim); the change of the Betti numbers, which is more than one if other features lie
        in the one that is removed or filled; whether it is `possible`, and `why` not; and the point
        of the class.  A class that the base has can be cut or filled, any other one opened.

    Examples
    --------
    A gap between two bars is closed at 1/2, by one cell:

    >>> from tusqh.antialias.cells import CellSets
    >>> from tusqh.grid import BackgroundGrid
    >>> from tusqh.sampling.fractions import VolumeFractions
    >>> values = np.zeros((3, 11))
    >>> values[1, 1::2] = [1, 1, 0.6, 0.9, 0.9]
    >>> grid = BackgroundGrid(shape=(1, 5), cell_size=1.0, origin=(0.0, 0.0))
    >>> cell_sets = CellSets(VolumeFractions.from_values(grid, 4, values))
    >>> found = tabulate_prices(Features(cell_sets, 0.5))
    >>> found.loc[found["possible"], ["row", "do", "change", "cells"]].values.tolist()
    [[1, 'open', 'left out', 1]]
    """
    start, found = features.start(), []
    for wish, adds, done, why in try_wishes(features, rows):
        about = features.classes.iloc[wish.row]
        known = [wish.row, about["class"], about["birth"], about["death"], wish.do]
        price = [pd.NA, np.nan, pd.NA, pd.NA, pd.NA, False, why]
        if done is not None:
            n = len(done.steps[0][1])
            volume = n * features.grid.cell_size**features.grid.dim
            price = [n, volume, *np.subtract(done.betti, start.betti).tolist(), True, ""]
        place = features.points[wish.row].tolist()
        found.append([*known, ADDED if adds else LEFT_OUT, *price, *place])
    table = pd.DataFrame(found, columns=no_prices(features.grid.dim).columns)
    counts = dict.fromkeys(("cells", "betti_0", "betti_1", "betti_2"), "Int64")
    return table.astype({"possible": bool, **counts})


def try_wishes(features: Changeable[S], rows: Sequence[int] | None = None) -> Iterator[Tried[S]]:
    """Yield each way to change each class at the base, tried by itself.

    Parameters
    ----------
    features
        The classes at the base.
    rows
        Rows of the classes; None: all.
    """
    start = features.start()
    is_there = features.classes["is_there"].to_numpy()
    for row in range(len(is_there)) if rows is None else rows:
        for do in (CUT, FILL) if is_there[row] else (OPEN,):
            wish, adds = Wish(row, do), do == FILL or (do == OPEN and features.is_below(row))
            try:
                yield Tried(wish, adds, features.apply(start, wish))
            except Impossible as why:
                yield Tried(wish, adds, None, str(why))


def no_prices(dim: int) -> pd.DataFrame:
    """Return a table of prices without rows.

    Parameters
    ----------
    dim
        Dimension of the grid.
    """
    return pd.DataFrame(columns=[*PRICE_COLUMNS, *"xyz"[:dim]])


def affordable_rows(features: Changeable[S]) -> list[int]:
    """Return the rows of the classes whose prices are found in a few seconds, in their order.

    Those are all classes on small grids; on large grids first those that the base has, then the
    longest-lived ones.

    Parameters
    ----------
    features
        The classes at the base.
    """
    n = max(_FEWEST, _WORK // features.grid.n_cells)
    table = features.classes
    first = np.lexsort((-table["persistence"].to_numpy(), ~table["is_there"].to_numpy()))
    return sorted(first[:n].tolist())
