"""List the cells that differ from the base, which are what the topology costs."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.grid import BoolArray, IntArray
from tusqh.sampling.fractions import VolumeFractions

#: Values of the column `change`.
ADDED, LEFT_OUT = "added", "left out"

#: Columns of the table of changes, before the coordinates.
CHANGE_COLUMNS = ["change", "cells", "volume", "smallest_fraction", "largest_fraction"]
CHANGE_COLUMNS += ["do", "class", "row"]


def tabulate_changes(
    kept: BoolArray, in_base: BoolArray, fractions: VolumeFractions
) -> pd.DataFrame:
    """Return one row per group of cells that were added to the base or left out of it.

    Cells of a group touch one another, at least at a vertex.  The largest groups come first.  Each
    row has the kind of change, the number of cells, their volume (model units**dim), the smallest
    and largest fraction among them, and the centre of the cell nearest to the middle of the group
    (model units).  `do`, `class` and `row` are empty, because no single feature was wished for.

    Parameters
    ----------
    kept, in_base
        Kept cells, and those of the base, shape n.
    fractions
        The volume fractions.

    Examples
    --------
    >>> from tusqh.grid import BackgroundGrid
    >>> grid = BackgroundGrid(shape=(1, 4), cell_size=1.0, origin=(0.0, 0.0))
    >>> fractions = VolumeFractions.from_values(grid, 4, np.full((3, 9), 0.5))
    >>> kept, base = np.array([[True, False, True, True]]), np.array([[True, True, False, False]])
    >>> tabulate_changes(kept, base, fractions)[["change", "cells", "x", "y"]].values.tolist()
    [['added', 2, 0.5, 2.5], ['left out', 1, 0.5, 1.5]]
    """
    from scipy import ndimage

    grid = fractions.grid
    touching = np.ones((3,) * grid.dim)
    rows = []
    for name, is_changed in ((ADDED, kept & ~in_base), (LEFT_OUT, in_base & ~kept)):
        groups, n_groups = ndimage.label(is_changed, touching)
        for k, box in enumerate(ndimage.find_objects(groups, n_groups), start=1):
            at = np.argwhere(groups[box] == k) + [along.start for along in box]
            group = describe_group(at, fractions)
            rows.append([name, *group[:4], "", "", pd.NA, *group[4:]])
    table = pd.DataFrame(rows, columns=[*CHANGE_COLUMNS, *"xyz"[: grid.dim]])
    table = table.sort_values("cells", ascending=False, kind="stable", ignore_index=True)
    return table.astype({"cells": np.int64, "row": "Int64"})


def describe_group(at: IntArray, fractions: VolumeFractions) -> list[float]:
    """Return the number of cells, their volume, smallest and largest fraction, and their middle.

    The middle is the centre of the cell nearest to the mean of all (model units).

    Parameters
    ----------
    at
        Indices of the cells, shape (r, dim).
    fractions
        The volume fractions.
    """
    grid, values = fractions.grid, fractions.cells[tuple(at.T)]
    middle = at[((at - at.mean(axis=0)) ** 2).sum(axis=1).argmin()]
    volume = len(at) * grid.cell_size**grid.dim
    return [len(at), volume, values.min(), values.max(), *grid.to_points(middle[None] + 0.5)[0]]
