"""Small components: found after the pinches were decided, removed only with a record.

Paper: Anti-aliasing, the end of the paragraph on archipelagos.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy import ndimage

from tusqh.antialias.clusters import CONNECT, Decisions
from tusqh.grid import BoolArray
from tusqh.sampling.fractions import VolumeFractions
from tusqh.topology.effective import label_components


def remove_small_components(
    kept: BoolArray,
    decisions: Decisions,
    fractions: VolumeFractions,
    *,
    threshold: float,
    min_cells: int,
) -> tuple[BoolArray, pd.DataFrame]:
    """Return the cells without components of fewer than `min_cells` cells, and what went.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    decisions
        Pinch decisions; connected pinches make one component of two.
    fractions
        Volume fractions, for the record.
    threshold
        Volume-fraction threshold, for counting interior sub-cells.
    min_cells
        Components with fewer background-grid cells go; 1 removes nothing.

    Returns
    -------
    remaining
        Kept cells without the removed ones, shape n.
    removed
        One row per removed component: its number, cells, volume (model units**dim), largest
        cell fraction, interior edges and vertices among its cells' sub-cells, and its centre.
    """
    labels, n_components = label_components(kept, decisions.at_vertex == CONNECT)
    n_cells = np.bincount(labels.ravel(), minlength=n_components + 1)
    is_small = n_cells < min_cells
    is_small[0] = False
    numbers = np.flatnonzero(is_small)
    is_removed = is_small[labels]
    grid = fractions.grid
    centres = np.array(ndimage.center_of_mass(kept, labels, numbers)).reshape(-1, grid.dim)
    places = grid.to_points(centres + 0.5)
    table = pd.DataFrame(
        {
            "component": numbers,
            "cells": n_cells[numbers],
            "volume": n_cells[numbers] * grid.cell_size**grid.dim,
            "largest_fraction": np.array(ndimage.maximum(fractions.cells, labels, numbers)),
            "interior_sub_cells": _count_interior_sub_cells(
                np.where(is_removed, labels, 0), fractions, threshold
            )[numbers],
            **{axis: places[:, k] for k, axis in enumerate("xyz"[: grid.dim])},
        }
    )
    return kept & ~is_removed, table


def _count_interior_sub_cells(
    labels: np.ndarray[tuple[int, ...], np.dtype[np.int64]],
    fractions: VolumeFractions,
    threshold: float,
) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Count, for every component, the sub-cells of its cells with ``F >= threshold``."""
    doubled = np.zeros(fractions.values.shape, dtype=np.int64)
    doubled[(slice(1, None, 2),) * labels.ndim] = labels
    is_cell = doubled > 0
    # Sub-cells between two components cannot tell them apart; they count for the later one.
    around = ndimage.grey_dilation(doubled, size=(3,) * labels.ndim)
    is_interior = (fractions.values >= threshold) & (around > 0) & ~is_cell
    return np.bincount(around[is_interior], minlength=int(labels.max(initial=0)) + 1).astype(
        np.int64
    )
