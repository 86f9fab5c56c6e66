"""Split blocks into three along each axis by sheets of elements, so that the mesh conforms.

A *sheet* around a set of elements gives each vertex on the boundary of the set a copy inside the
set, and each facet of that boundary an element between the facet and its copy.  The mesh
conforms whatever the set is (pillowing; Mitchell and Tautges 1995).  Here each block starts as one
element.  For each axis in turn, the blocks that are to be split along it get a sheet around each of
their layers, which makes three layers of one.  At the rim of a layer the sheet closes, so blocks
that are not split stay as they are, and blocks that are split along every axis with
everything around them become equal cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.grid.numbering import CORNERS
from tusqh.meshes.facets import Facets, find_facets

#: Cells of a split block along each axis.
CELLS = 3
#: How far the sheets of each axis lie inside the rim of their layer, in cells, by dimension: at a
#: straight rim, a convex corner of it and a concave one.  In the plane these are the final places.
_INSETS = {
    2: ((1.6, 1.6, 1.6), (0.6, 0.6, 0.6)),
    3: ((1.4, 1.35, 0.15), (0.95, 0.9, 0.15), (0.35, 0.15, 0.15)),
}


@dataclass(frozen=True)
class Split:
    """Elements of blocks, some of which are split.

    Parameters
    ----------
    points
        Coordinates, shape (n, dim), in units of which a block has `CELLS` along each axis.
    cells
        Corners of the elements, shape (m, 2**dim), VTK order.
    block
        The block in which each element lies, shape (m, dim).
    """

    points: FloatArray
    cells: IntArray
    block: IntArray


def split_blocks(chosen: BoolArray, split: list[BoolArray]) -> Split:
    """Return the elements of blocks after the sheets of every axis.

    Parameters
    ----------
    chosen
        The blocks, shape of the grid of blocks.  What is in the blocks at the rim of this set is
        not complete, because nothing beyond them is seen.
    split
        For each axis, the blocks that are split along it, of the same shape.
    """
    parts = _whole_blocks(chosen)
    for axis, blocks in enumerate(split):
        parts = _add_sheets(parts, blocks & chosen, axis)
    return parts


def _whole_blocks(chosen: BoolArray) -> Split:
    """Return each block as one element."""
    block = np.argwhere(chosen)
    shape = [n + 1 for n in chosen.shape]
    at = [np.ravel_multi_index(tuple((block + c).T), shape) for c in CORNERS[chosen.ndim]]
    used, cells = np.unique(np.stack(at, axis=1), return_inverse=True)
    points = CELLS * np.stack(np.unravel_index(used, shape), axis=1).astype(np.float64)
    return Split(points, cells.reshape(len(block), -1), block)


def _add_sheets(parts: Split, blocks: BoolArray, axis: int) -> Split:
    """Put a sheet around each layer, across an axis, of the elements in blocks."""
    cells, block = parts.cells, parts.block
    is_in = blocks[tuple(block.T)]
    facets = find_facets(cells)
    cell, other = facets.cell, _other_side(facets)
    is_inner = (other >= 0) & is_in[cell] & is_in[other] & (block[cell, axis] == block[other, axis])
    rows = np.flatnonzero(is_in[cell] & (other >= 0) & ~is_inner)
    if not len(rows):
        return parts
    on_boundary = np.zeros(len(parts.points), dtype=bool)
    on_boundary[facets.corners[rows]] = True
    fan = _fans(facets, is_inner, is_in, on_boundary)
    local = facets.local[rows % len(facets.local)]
    fans, copies = np.unique(fan[cell[rows][:, None], local], return_inverse=True)
    copies = copies.reshape(local.shape)
    outwards = block[other[rows]] - block[cell[rows]]
    original = np.empty(len(fans), dtype=np.int64)
    original[copies] = cells[cell[rows][:, None], local]
    flat = np.ravel_multi_index(tuple(block[cell[rows]].T), blocks.shape)
    inwards = _inwards(copies, outwards, flat, axis, len(fans))
    number = np.full(int(fan.max()) + 2, -1, dtype=np.int64)
    number[fans] = len(parts.points) + np.arange(len(fans))
    moved = np.where(number[fan] >= 0, number[fan], cells)
    inner, outer = number[fans][copies], cells[cell[rows][:, None], local]
    if cells.shape[1] == 4:
        new = np.concatenate([outer, inner[:, ::-1]], axis=1)
    else:
        new = np.concatenate([inner, outer], axis=1)
    return Split(
        np.concatenate([parts.points, parts.points[original] + inwards]),
        np.concatenate([moved, new]),
        np.concatenate([block, block[cell[rows]]]),
    )


def _other_side(facets: Facets) -> IntArray:
    """Return the element on the other side of each row; -1 if there is none."""
    both = np.bincount(facets.unique, weights=facets.cell)[facets.unique].astype(np.int64)
    return np.where(facets.on_boundary, -1, both - facets.cell)


def _fans(
    facets: Facets, is_inner: BoolArray, is_in: BoolArray, on_boundary: BoolArray
) -> IntArray:
    """Return the number of the fan of each corner, shape (m, 2**dim); -1 where it needs no copy.

    The corners of a fan are those at one vertex that are connected through inner facets.
    """
    cells = facets.cells
    needs = on_boundary[cells] & is_in[:, None]
    number = np.where(needs, np.cumsum(needs).reshape(needs.shape) - 1, -1)
    rows = np.flatnonzero(is_inner)
    pairs = rows[np.argsort(facets.unique[rows], kind="stable")].reshape(-1, 2)
    cell, side = np.divmod(pairs, len(facets.local))
    first, second = facets.local[side[:, 0]], facets.local[side[:, 1]]
    here = cells[cell[:, 0, None], first]
    there = cells[cell[:, 1, None], second]
    match = np.argmax(here[:, :, None] == there[:, None, :], axis=2)
    second = np.take_along_axis(second, match, axis=1)
    a, b = number[cell[:, 0, None], first].ravel(), number[cell[:, 1, None], second].ravel()
    a, b = a[a >= 0], b[a >= 0]
    n = int(needs.sum())
    joined = coo_matrix((np.ones(len(a), dtype=bool), (a, b)), shape=(n, n))
    _, label = connected_components(joined, directed=False)
    fan = np.full(needs.shape, -1, dtype=np.int64)
    fan[needs] = label
    return fan


def _inwards(
    copies: IntArray, outwards: IntArray, block: IntArray, axis: int, n_copies: int
) -> FloatArray:
    """Return how far each copy lies from its vertex, in cells, shape (c, dim)."""
    dim = outwards.shape[1]
    # Elements of blocks that meet in an edge may share a facet, on the plane between two layers.
    is_across = outwards[:, axis] != 0
    outwards = np.where(is_across[:, None] & (np.arange(dim) != axis), 0, outwards)
    is_towards = np.zeros((n_copies, dim, 2), dtype=bool)
    for k in range(dim):
        for side, sign in enumerate((-1, 1)):
            is_towards[copies[outwards[:, k] == sign].ravel(), k, side] = True
    straight, convex, concave = _INSETS[dim][axis]
    inset = np.full((n_copies, dim), straight)
    at_rim = is_towards[:, :, 0] | is_towards[:, :, 1]
    at_rim[:, axis] = False
    owner = np.unique(np.stack([copies.ravel(), np.repeat(block, copies.shape[1])]), axis=1)[0]
    is_convex = np.bincount(owner, minlength=n_copies) == 1
    is_corner = at_rim.sum(axis=1) == 2
    inset[is_corner & is_convex] = convex
    inset[is_corner & ~is_convex] = concave
    inset[:, axis] = 1.0
    return np.asarray((is_towards[:, :, 0].astype(float) - is_towards[:, :, 1]) * inset)
