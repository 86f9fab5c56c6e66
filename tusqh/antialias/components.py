"""Small components and holes: found after the pinches were decided, gone only with a record.

Paper: Anti-aliasing, the end of the paragraph on archipelagos.  Removing a component and filling
a hole (in 3D a void) are the same operation on the cells and on their complement.  Neither makes
a new pinch: the cells around a vertex other than a pinch are joined there, kept and empty ones
alike, so they stay or go together.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy import ndimage

from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Criteria

#: Columns of the table of removed components and filled holes, before the coordinates.
COLUMNS = ["feature", "cells", "volume", "persistence", "smallest_fraction", "largest_fraction"]
COLUMNS += ["interior_sub_cells"]


def drop_features(
    labels: IntArray,
    criteria: Criteria,
    fractions: VolumeFractions,
    persistence: FloatArray,
    *,
    threshold: float,
    feature: str,
) -> tuple[BoolArray, pd.DataFrame]:
    """Return the cells of the features that do not meet the criteria, and a row for each.

    Parameters
    ----------
    labels
        Feature that every cell belongs to, from 1, gaps allowed; 0 elsewhere, shape n.
    criteria
        What a feature needs to stay.
    fractions
        Volume fractions, for the record.
    persistence
        Persistence of the class that each cell creates (or, for holes, destroys), shape n; a
        feature lives as long as the longest-lived of its cells' classes.
    threshold
        Volume-fraction threshold, for counting interior sub-cells.
    feature
        ``"component"``, ``"hole"`` or ``"void"``, for the table.

    Returns
    -------
    is_dropped
        Their cells, shape n.
    table
        One row per dropped feature: what it is, cells, volume (model units**dim), persistence,
        smallest and largest cell fraction, interior edges and vertices among its cells'
        sub-cells, and its centre (model units).
    """
    n_cells = np.bincount(labels.ravel())
    grid = fractions.grid
    volume = n_cells * grid.cell_size**grid.dim
    lives = np.zeros(len(n_cells))
    np.maximum.at(lives, labels.ravel(), persistence.ravel())
    is_feature = (n_cells > 0) & (np.arange(len(n_cells)) > 0)
    is_small = (n_cells < criteria.min_cells) | (volume < criteria.min_volume)
    is_small |= lives < criteria.min_persistence
    if criteria.keep is not None:
        numbers = np.flatnonzero(is_feature)
        ranked = numbers[np.lexsort((numbers, -n_cells[numbers], -lives[numbers]))]
        is_small[ranked[criteria.keep :]] = True
    is_small &= is_feature
    dropped = np.flatnonzero(is_small)
    is_dropped = is_small[labels]
    centres = np.array(ndimage.center_of_mass(is_dropped, labels, dropped)).reshape(-1, grid.dim)
    places = grid.to_points(centres + 0.5)
    values = [
        np.full(len(dropped), feature),
        n_cells[dropped],
        volume[dropped],
        lives[dropped],
        np.array(ndimage.minimum(fractions.cells, labels, dropped)),
        np.array(ndimage.maximum(fractions.cells, labels, dropped)),
        _count_interior_sub_cells(np.where(is_dropped, labels, 0), fractions, threshold)[dropped],
    ]
    table = pd.DataFrame(dict(zip(COLUMNS, values, strict=True)))
    for axis in range(grid.dim):
        table["xyz"[axis]] = places[:, axis]
    return is_dropped, table


def _count_interior_sub_cells(
    labels: IntArray, fractions: VolumeFractions, threshold: float
) -> IntArray:
    """Count, for every feature, the sub-cells of its cells with ``F >= threshold``."""
    n = int(labels.max(initial=0)) + 1
    if n == 1:
        return np.zeros(1, dtype=np.int64)
    doubled = np.zeros(fractions.values.shape, dtype=np.int64)
    doubled[(slice(1, None, 2),) * labels.ndim] = labels
    is_cell = doubled > 0
    # Sub-cells between two features cannot tell them apart; they count for the later one.
    around = ndimage.grey_dilation(doubled, size=(3,) * labels.ndim)
    is_interior = (fractions.values >= threshold) & (around > 0) & ~is_cell
    return np.bincount(around[is_interior], minlength=n).astype(np.int64)
