"""What each way to tell inside from outside gives for a geometry, on a coarse grid."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.errors import SamplingError
from tusqh.geometry.kinds import Surface
from tusqh.pipeline.sample import BASE_THRESHOLD, sample
from tusqh.settings.grid import Grid
from tusqh.settings.model import Settings
from tusqh.settings.sampling import Inside

#: Cells along the longest side.
COARSE = 32

#: The columns of the table.
INSIDE_COLUMNS = ("inside", "volume", "components", "holes", "voids", "note")


def compare_insides(geometry: Surface, settings: Settings, *, cells: int = COARSE) -> pd.DataFrame:
    """Return one row for each `inside`: the volume, and the Betti numbers at the threshold 1/2.

    Sizes that the settings do not give are those of the coarse grid: the ball is half a cell wide,
    the shell one cell thick.

    Parameters
    ----------
    geometry
        An outline or a soup.
    settings
        The settings of a mesh; of the grid only the window matters.
    cells
        Cells along the longest side.

    Returns
    -------
    table
        Columns `INSIDE_COLUMNS`; Betti numbers are missing where nothing is inside, which `note`
        explains.

    Examples
    --------
    >>> import numpy as np
    >>> from tusqh.geometry.outline import Outline
    >>> side = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    >>> doubled = Outline.from_chains([side, side[::-1]])
    >>> table = compare_insides(doubled, Settings(), cells=8).set_index("inside")
    >>> table.loc[["winding", "envelope"], "volume"].tolist()
    [0.0, 4.0]
    """
    rows = []
    for inside in get_args(Inside):
        sampling = replace(settings.sampling, inside=inside)
        try:
            fractions = sample(
                geometry,
                grid=Grid(cells=cells, placement="corner"),
                sampling=sampling,
                window=settings.window,
            )
        except SamplingError as error:
            rows.append((inside, 0.0, None, None, None, error.found))
            continue
        cell_set = CellSets(fractions, settings.policy).at(BASE_THRESHOLD)
        betti = tuple(cell_set.predicted) if cell_set.kept.any() else (0, 0, 0)
        rows.append((inside, fractions.volume(), *betti, ""))
    table = pd.DataFrame(rows, columns=list(INSIDE_COLUMNS))
    return table.astype(dict.fromkeys(("components", "holes", "voids"), "Int64"))
