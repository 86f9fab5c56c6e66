"""Count the Betti numbers of cells that are joined by one rule everywhere, without sub-cells.

Cells that are *closed* sets are joined wherever they touch; *open* ones, together with their shared
faces, edges and vertices, only by facets.  Both are counted on the doubled grid, whose places are
the cells, faces, edges and vertices (`tusqh.grid.doubled`).
"""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from tusqh.grid import BoolArray
from tusqh.topology.betti_numbers import BettiNumbers


def closed_betti(kept: BoolArray) -> BettiNumbers:
    """Return the Betti numbers of kept cells that are joined wherever they touch.

    Parameters
    ----------
    kept
        Whether each cell is kept, shape n.

    Examples
    --------
    >>> str(closed_betti(np.eye(3, dtype=bool)))
    '(1, 0, 0)'
    """
    return _betti(kept, kept.ndim, 1)


def open_betti(kept: BoolArray) -> BettiNumbers:
    """Return the Betti numbers of kept cells that are joined by shared facets only.

    Parameters
    ----------
    kept
        Whether each cell is kept, shape n.

    Examples
    --------
    >>> str(open_betti(np.eye(3, dtype=bool)))
    '(3, 0, 0)'
    """
    return _betti(kept, 1, kept.ndim)


def _betti(kept: BoolArray, reach: int, reach_of_empty: int) -> BettiNumbers:
    """Return the Betti numbers of cells joined if they differ along at most `reach` axes."""
    dim = kept.ndim
    _, n_components = ndimage.label(kept, ndimage.generate_binary_structure(dim, reach))
    structure = ndimage.generate_binary_structure(dim, reach_of_empty)
    _, n_empty = ndimage.label(~np.pad(kept, 1), structure)
    if dim == 2:
        return BettiNumbers(int(n_components), int(n_empty) - 1)
    euler = _count_euler_characteristic(kept, is_closed=reach == dim)
    return BettiNumbers(int(n_components), int(n_components + n_empty - 1) - euler, n_empty - 1)


def _count_euler_characteristic(kept: BoolArray, *, is_closed: bool) -> int:
    """Return the alternating sum of the places of the doubled grid that belong to the cells."""
    belongs = np.pad(kept, 1)
    for axis in range(kept.ndim):
        along = np.moveaxis(belongs, axis, 0)
        both = np.empty((2 * len(along) - 1, *along.shape[1:]), dtype=bool)
        both[::2] = along
        both[1::2] = along[:-1] | along[1:] if is_closed else along[:-1] & along[1:]
        belongs = np.moveaxis(both, 0, axis)
    # Even places are cells; a closed vertex has dimension 0, an open one codimension 0.
    n_odd = sum(np.ix_(*[np.arange(n) % 2 for n in belongs.shape]))
    dimension = kept.ndim - n_odd if is_closed else n_odd
    return int(np.where(belongs, 1 - 2 * (dimension % 2), 0).sum())
