"""Find the base: a given threshold, or the one whose cells have the volume of the geometry."""

from __future__ import annotations

import numpy as np

from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.goal import Base


def find_base(fractions: VolumeFractions, base: Base, *, volume: float) -> float:
    """Return the threshold of the base.

    Parameters
    ----------
    fractions
        Volume fractions.
    base
        A threshold in (0, 1], returned as it is; or ``"match"`` for the threshold whose cells have
        the volume nearest to the given one, in the middle between two fractions of cells.
    volume
        The volume (2D: area) that the cells should have, in model units.

    Examples
    --------
    >>> from tusqh.grid import BackgroundGrid
    >>> values = np.zeros((3, 9))
    >>> values[1, 1::2] = [1, 0.75, 0.25, 0.125]
    >>> grid = BackgroundGrid(shape=(1, 4), cell_size=2.0, origin=(0.0, 0.0))
    >>> fractions = VolumeFractions.from_values(grid, 4, values)
    >>> find_base(fractions, 0.5, volume=8.0), find_base(fractions, "match", volume=12.5)
    (0.5, 0.1875)
    """
    if base != "match":
        return base
    cells = np.clip(fractions.cells.ravel(), 0.0, 1.0)
    levels, n_cells = np.unique(cells[cells > 0], return_counts=True)
    if len(levels) == 0:
        return 0.5
    volumes = np.cumsum(n_cells[::-1])[::-1] * fractions.grid.cell_size**fractions.grid.dim
    nearest = int(np.abs(volumes - volume)[::-1].argmin())  # In a tie the higher threshold.
    upper = levels[::-1][nearest]
    below = levels[levels < upper]
    return float((upper + (below[-1] if len(below) else 0.0)) / 2)
