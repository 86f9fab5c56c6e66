"""What it costs to open, cut or fill each class of several materials, in the volume of each."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.grid import FloatArray
from tusqh.local_topology.material_features import MaterialDone, MaterialFeatures
from tusqh.local_topology.prices import affordable_rows, try_wishes

#: Columns of the table of prices of several materials, before the coordinates.
PRICE_COLUMNS = ["material", "row", "class", "birth", "death", "do", "cells", "volume", "volumes"]
PRICE_COLUMNS += ["betti_0", "betti_1", "betti_2", "others", "possible", "why"]


def no_material_prices(dim: int) -> pd.DataFrame:
    """Return a table of prices without rows.

    Parameters
    ----------
    dim
        Dimension of the grid.
    """
    return pd.DataFrame(columns=[*PRICE_COLUMNS, *"xyz"[:dim]])


def tabulate_material_prices(features: MaterialFeatures) -> pd.DataFrame:
    """Return the price of each way to change each class, by itself, at the base.

    On large grids only some classes have one, see `tusqh.local_topology.prices.affordable_rows`.

    Parameters
    ----------
    features
        The classes at the base.

    Returns
    -------
    prices
        One row per class and way: the `material`, the `row` of the class among those of the
        material, its `class`, `birth` and `death` as shares of the score; `do`; the number of
        cells, and their volume (model units**dim); the change of the volume of every material, in
        words (`volumes`); the change of the Betti numbers of the material, and that of `others`;
        whether it is `possible`, and `why` not; and the point of the class.

    Examples
    --------
    >>> from tusqh.contacts import MaterialFractions
    >>> cells = {"ring": np.array([[1.0, 1, 1], [1, 0, 1], [1, 1, 1]])}
    >>> features = MaterialFeatures(
    ...     MaterialFractions.from_cells(cells), np.full(2, 2**20), ["ring"]
    ... )
    >>> found = tabulate_material_prices(features)
    >>> found.loc[found["possible"], ["class", "do", "cells", "volumes"]].values.tolist()
    [['hole', 'cut', 1, 'ring -1, void +1'], ['hole', 'fill', 1, 'ring +1, void -1']]
    """
    start, found = features.start(), []
    dim = features.grid.dim
    for wish, _, done, why in try_wishes(features, affordable_rows(features)):
        about = features.classes.iloc[wish.row]
        known = [about[name] for name in ("material", "row", "class", "birth", "death")]
        price = [pd.NA, np.nan, "", pd.NA, pd.NA, pd.NA, "", False, why]
        if done is not None:
            k = int(about["number"])
            n = int((done.labels != start.labels).sum())
            effect = np.subtract(done.of(k), start.of(k)).tolist()
            others = features.others(start.betti, done.betti, k)
            volume = n * features.grid.cell_size**dim
            price = [n, volume, describe_volumes(features, start, done), *effect, others, True, ""]
        found.append([*known, wish.do, *price, *features.points[wish.row].tolist()])
    table = pd.DataFrame(found, columns=no_material_prices(dim).columns)
    counts = dict.fromkeys(("cells", "betti_0", "betti_1", "betti_2"), "Int64")
    return table.astype({"possible": bool, **counts})


def describe_volumes(features: MaterialFeatures, start: MaterialDone, done: MaterialDone) -> str:
    """Return the changes of the volumes of all materials that change, in model units**dim.

    Parameters
    ----------
    features
        The classes at the base.
    start, done
        The cells before and after.
    """
    changed: FloatArray = (
        _volumes(features, done) - _volumes(features, start)
    ) * features.grid.cell_size**features.grid.dim
    names = features.fractions.names
    return ", ".join(f"{names[k]} {changed[k]:+.6g}" for k in np.flatnonzero(changed).tolist())


def _volumes(features: MaterialFeatures, done: MaterialDone) -> FloatArray:
    """Return the number of cells of every material."""
    n = len(features.fractions.names)
    return np.bincount(done.labels.ravel(), minlength=n).astype(np.float64)
