"""Find the blocks of grid cells that become one element.

A cell is *plain* if its element is the whole cell, and *safe* if only plain cells are around it.
Two safe cells along each axis make a block of level 1, from even positions on.  Two blocks of a
level along each axis make a block of the next level if all blocks around each of them are blocks of
that level or parts of larger ones.  So elements that share as much as a vertex differ by at most
one level.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product

import numba
import numpy as np

from tusqh.grid import BackgroundGrid, BoolArray, IndexArray
from tusqh.grid.numbering import CORNERS
from tusqh.meshes.volume_mesh import GRID_CELL, VolumeMesh

#: Largest distance of a corner from its grid vertex in a plain cell, in cells.
ON_GRID = 1e-9


def find_plain_cells(mesh: VolumeMesh, grid: BackgroundGrid) -> IndexArray:
    """Return the element that is a whole grid cell, for each cell of the grid; -1 elsewhere.

    Parameters
    ----------
    mesh
        The mesh.
    grid
        The grid of which it was made.

    Returns
    -------
    IndexArray
        Shape of the grid.
    """
    element = np.full(grid.shape, -1, dtype=mesh.cells.dtype)
    _mark_plain(
        mesh.points,
        mesh.cells,
        mesh.kind == GRID_CELL,
        mesh.grid_cell,
        np.array(grid.shape),
        np.array(grid.origin),
        grid.cell_size,
        CORNERS[grid.dim],
        element.reshape(-1),
    )
    return element


@numba.njit(cache=True)
def _mark_plain(points, cells, is_cell, grid_cell, shape, origin, size, corners, element):  # type: ignore[no-untyped-def]
    """Enter the elements whose corners are those of their grid cell."""
    dim = len(shape)
    for number in range(len(cells)):
        flat = grid_cell[number]
        if not is_cell[number] or flat < 0:
            continue
        is_plain = True
        rest = flat
        for axis in range(dim - 1, -1, -1):
            position = rest % shape[axis]
            rest //= shape[axis]
            for corner in range(len(corners)):
                there = origin[axis] + size * (position + corners[corner, axis])
                if abs(points[cells[number, corner], axis] - there) > ON_GRID * size:
                    is_plain = False
        if is_plain:
            element[flat] = number


def find_blocks(is_plain: BoolArray, *, layers: int = 1) -> list[BoolArray]:
    """Return the blocks of every level that are not part of a larger one.

    Parameters
    ----------
    is_plain
        Whether a cell may be merged or be beside a merged one, shape of the grid.
    layers
        Number of layers of plain cells around every block, at least 1.

    Returns
    -------
    list of BoolArray
        Entry k: blocks of 2**(k + 1) cells along each axis; block (i, j, ...) starts at cell
        (i, j, ...) * 2**(k + 1).

    Examples
    --------
    >>> [int(level.sum()) for level in find_blocks(np.ones((10, 10), dtype=bool))]
    [9]
    >>> [int(level.sum()) for level in find_blocks(np.ones((18, 18), dtype=bool))]
    [33, 4]
    """
    may_merge = is_plain
    for _ in range(layers):
        may_merge = erode(may_merge)
    levels: list[BoolArray] = []
    while True:
        blocks = _all_of_eight(may_merge)
        if levels:
            levels[-1] &= ~_spread(blocks, levels[-1].shape)
        if not blocks.any():
            return levels
        levels.append(blocks)
        may_merge = erode(blocks)


def erode(inside: BoolArray, axes: Iterable[int] | None = None) -> BoolArray:
    """Return where all neighbours, across corners too, are inside; nothing outside the array is.

    Parameters
    ----------
    inside
        What is inside.
    axes
        Axes along which neighbours differ; None: all.
    """
    for axis in range(inside.ndim) if axes is None else axes:
        moved = np.moveaxis(inside, axis, 0)
        eroded = np.zeros_like(moved)
        eroded[1:-1] = moved[:-2] & moved[1:-1] & moved[2:]
        inside = np.moveaxis(eroded, 0, axis)
    return inside


def _all_of_eight(inside: BoolArray) -> BoolArray:
    """Return the blocks of two along each axis that are inside; incomplete blocks are not."""
    ends = [n - n % 2 for n in inside.shape]
    parts = [
        inside[tuple(slice(k, end, 2) for k, end in zip(start, ends, strict=True))]
        for start in product((0, 1), repeat=inside.ndim)
    ]
    return np.asarray(np.logical_and.reduce(parts))


def _spread(blocks: BoolArray, shape: tuple[int, ...]) -> BoolArray:
    """Return which entries of the level below are parts of blocks."""
    for axis in range(blocks.ndim):
        blocks = np.repeat(blocks, 2, axis=axis)
    padding = [(0, n - m) for n, m in zip(shape, blocks.shape, strict=True)]
    return np.pad(blocks, padding)
