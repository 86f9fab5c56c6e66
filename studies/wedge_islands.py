"""Follow the islands of a wedge as the grid gets finer (paper: Convergence).

Where a wedge is about one cell wide, the kept cells form an archipelago, which lies between
cot(a) / 2 and cot(a) cells from the apex for an opening angle ``a``.  Refinement moves it towards
the apex and never removes it.  An island of one grid *continues* an island of the next coarser grid
if their ranges of distance from the apex overlap; this is the zigzag of components through the
sequence of grids.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
from scipy import ndimage

from studies.aliasing import wedge
from studies.methods.exact_fractions import exact_fractions
from tusqh.antialias.cells import CellSets
from tusqh.grid import QUAD_CORNERS, BackgroundGrid, BoolArray

APEX = (0.3, 0.7)
DEGREES, TURN, LENGTH = 4.0, 22.0, 40.0

#: Number of grids per halving of the cell size.
GRIDS_PER_HALVING = 4


def follow_islands(n_halvings: int) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the components of every grid, and its islands before and after anti-aliasing.

    Parameters
    ----------
    n_halvings
        Number of halvings of the cell size, which starts at 1; `GRIDS_PER_HALVING` grids each.

    Returns
    -------
    components
        One row per grid and component of cells joined by faces: cell size, start and stop along the
        wedge measured from the apex (units of the model), number of cells, whether it is the main
        body (the largest), and the rank from the apex of the component that it continues (-1: new).
    grids
        One row per grid: number of islands of the raw cells and of the mesh; the distances from the
        apex, in cells, at which they begin and end; the numbers born and gone since the last grid.
    """
    polygon = wedge(APEX, DEGREES, TURN, LENGTH)
    tables, counts = [], []
    last: pd.DataFrame | None = None
    for step in range(n_halvings * GRIDS_PER_HALVING + 1):
        size = 2.0 ** (-step / GRIDS_PER_HALVING)
        grid = _grid_of(size)
        fractions = exact_fractions([polygon], grid)
        table = _components(fractions.cells >= 0.5, grid)
        table.insert(0, "cell_size", size)
        table.insert(0, "grid", step)
        table["continues"] = -1 if last is None else _continue(last, table)
        tables.append(table)
        antialiased = CellSets(fractions).at(0.5).predicted
        counts.append(_count(table, last, antialiased.betti_0))
        last = table
    return pd.concat(tables, ignore_index=True), pd.DataFrame(counts)


def _grid_of(size: float) -> BackgroundGrid:
    """Return the grid over the wedge whose lowest vertex is the origin."""
    reach = LENGTH / math.cos(math.radians(DEGREES / 2))
    angles = [math.radians(TURN + side * DEGREES / 2) for side in (-1, 1)]
    far = (APEX[0] + reach * math.cos(angles[0]), APEX[1] + reach * math.sin(angles[1]))
    shape = tuple(math.ceil(x / size) for x in far)
    return BackgroundGrid(shape=shape, cell_size=size, origin=(0.0, 0.0))


def _components(kept: BoolArray, grid: BackgroundGrid) -> pd.DataFrame:
    """Return the components of kept cells joined by faces, from the apex outwards."""
    labels, n = ndimage.label(kept)
    places = np.argwhere(kept)
    of_place = labels[kept]
    corners = grid.to_points((places[:, None] + QUAD_CORNERS).reshape(-1, 2)) - APEX
    turn = math.radians(TURN)
    along = (corners @ [math.cos(turn), math.sin(turn)]).reshape(-1, 4)
    index = np.arange(1, n + 1)
    table = pd.DataFrame(
        {
            "start": ndimage.minimum(along.min(axis=1), of_place, index),
            "stop": ndimage.maximum(along.max(axis=1), of_place, index),
            "cells": np.bincount(of_place, minlength=n + 1)[1:],
        }
    )
    table = table.sort_values(["start", "stop"], ignore_index=True)
    table["is_main"] = table["cells"] == table["cells"].max()
    return table


def _continue(before: pd.DataFrame, now: pd.DataFrame) -> list[int]:
    """Return the component of the last grid that each component overlaps most, -1 if none."""
    low = np.maximum.outer(now["start"].to_numpy(), before["start"].to_numpy())
    high = np.minimum.outer(now["stop"].to_numpy(), before["stop"].to_numpy())
    overlap = high - low
    best = overlap.argmax(axis=1)
    return [int(b) if row[b] > 0 else -1 for b, row in zip(best, overlap, strict=True)]


def _count(table: pd.DataFrame, last: pd.DataFrame | None, after: int) -> dict[str, Any]:
    islands = table[~table["is_main"]]
    size = float(table["cell_size"].iloc[0])
    continued = set(table["continues"])
    return {
        "grid": int(table["grid"].iloc[0]),
        "cell_size": size,
        "islands": len(islands),
        "islands_of_mesh": after - 1,
        "first_in_cells": float(islands["start"].min() / size),
        "last_in_cells": float(islands["stop"].max() / size),
        "born": 0 if last is None else int((table["continues"] == -1).sum()),
        "gone": 0 if last is None else sum(k not in continued for k in range(len(last))),
    }
