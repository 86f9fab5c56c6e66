"""Find the blocks of three cells along each axis that become one element, and those in between.

The blocks start at the position that gives the most large elements.  A block may be merged if all
its cells may.  All others stay divided.  Those that may be merged but share a side, in space a face
or an edge, with one that stays divided hold the *transition*, and the rest become one element each.
These elements are the cells of the next level.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from tusqh.coarsening.blocks import erode
from tusqh.coarsening.sheets import CELLS
from tusqh.grid import BoolArray


@dataclass(frozen=True)
class Level:
    """The blocks of one level; arrays have the shape of the grid of blocks.

    Parameters
    ----------
    size
        Number of grid cells of a cell of this level, a third of a block, along each axis.
    start
        Lowest grid vertex of block (0, 0, ...).
    is_whole
        Whether a block is one element, or part of a larger one.
    is_transition
        Whether a block holds elements between small and large ones.
    """

    size: int
    start: tuple[int, ...]
    is_whole: BoolArray
    is_transition: BoolArray

    @property
    def split(self) -> list[BoolArray]:
        """For each axis, the blocks that are split along it."""
        divided = ~(self.is_whole | self.is_transition)
        return split_along_axes(divided)


def split_along_axes(divided: BoolArray) -> list[BoolArray]:
    """Return the blocks that are split along each axis: those beside divided ones across it.

    Parameters
    ----------
    divided
        The blocks that stay divided into cells.
    """
    return [
        ~erode(~divided, axes=[k for k in range(divided.ndim) if k != axis])
        for axis in range(divided.ndim)
    ]


def find_level(may_merge: BoolArray, size: int, start: tuple[int, ...]) -> Level | None:
    """Return the blocks of a level; None if no block becomes one element.

    Parameters
    ----------
    may_merge
        Whether a cell of the level below may be merged, shape of the grid of that level.
    size
        Number of grid cells of such a cell along each axis.
    start
        Lowest grid vertex of cell (0, 0, ...).

    Examples
    --------
    >>> level = find_level(np.ones((15, 15), dtype=bool), 1, (0, 0))
    >>> level.is_whole.sum(), level.is_transition.sum(), level.start
    (np.int64(9), np.int64(16), (-3, -3))
    """
    dim = may_merge.ndim
    all_three = may_merge
    for axis in range(dim):
        moved = np.moveaxis(all_three, axis, 0)
        if len(moved) < CELLS:
            return None
        all_three = np.moveaxis(moved[:-2] & moved[1:-1] & moved[2:], 0, axis)
    best: Level | None = None
    for offset in product(range(CELLS), repeat=dim):
        # One layer of blocks outside the grid, which stay divided.
        candidates = np.pad(all_three[tuple(slice(o, None, CELLS) for o in offset)], 1)
        is_whole = candidates & ~np.logical_or.reduce(split_along_axes(~candidates))
        if best is None or is_whole.sum() > best.is_whole.sum():
            lowest = [s + size * (o - CELLS) for s, o in zip(start, offset, strict=True)]
            best = Level(size, tuple(lowest), is_whole, candidates & ~is_whole)
    return best if best is not None and best.is_whole.any() else None
