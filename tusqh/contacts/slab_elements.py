"""Emit the elements of one slab of a decided grid, numbered as in the mesh of the whole grid.

The whole mesh numbers its points in blocks: grid vertices, corners of inner cells, points of balls,
and small quads in the faces normal to each axis.  In each block the numbers ascend with the layer
of cells along x.  An element uses points of its own layer and of both neighbouring layers only, so
a window with some more layers on both sides shows which points of these layers are used.  A point
is numbered by its block and by its place in it, counted from the first point of the slab; the place
in the whole mesh follows from the number of points that all slabs have in each block.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.emit_spatial import emit_elements
from tusqh.contacts.emitter import Emitter
from tusqh.contacts.side_balls import name_side_balls
from tusqh.contacts.spatial import SpatialDecision
from tusqh.contacts.spatial_votes import LAYERS
from tusqh.contacts.stick_field import Field
from tusqh.grid import BackgroundGrid, FloatArray, IndexArray, IntArray
from tusqh.grid.slabs import Slab

#: Blocks of points in the numbering of a mesh.
BLOCKS = 6

#: Layers of cells on both sides of a slab in its window.
_AROUND = 6


@dataclass(frozen=True)
class SlabElements:
    """The elements of a slab.

    Parameters
    ----------
    points
        Coordinates of the points that they use, in model units, shape (n, 3).
    block, place
        Block of each point, and its place in it, counted from the first point of the slab in that
        block, shape (n,); places below 0 are in the slab before, and those that are at least the
        number of points in the slab after.
    counts
        Number of points of the slab in each block, shape (`BLOCKS`,).
    cells
        Points of every element, shape (m, 8).
    kind
        Kind of every element, shape (m,).
    grid_cell
        Flat cell of the whole grid in which each element lies; -1 outside the grid, shape (m,).
    """

    points: FloatArray
    block: NDArray[np.int8]
    place: IntArray
    counts: IntArray
    cells: IndexArray
    kind: NDArray[np.int8]
    grid_cell: IntArray


def emit_slab(
    decision: SpatialDecision, grid: BackgroundGrid, slab: Slab, *, left_out: int | None = None
) -> SlabElements:
    """Return the elements of a slab of a decided grid.

    Parameters
    ----------
    decision
        The decision of the whole grid.
    grid
        The whole background grid, of shape n, without layers of void.
    slab
        The slab; the first and the last one also have the elements in the layers of void.
    left_out
        A material without elements; None: all have elements.
    """
    return emit_window(window_of(decision, grid, slab), grid, slab, left_out=left_out)


def window_of(decision: SpatialDecision, grid: BackgroundGrid, slab: Slab) -> SpatialDecision:
    """Return the part of the decision of a whole grid that the elements of a slab depend on.

    Parameters
    ----------
    decision, grid, slab
        See `emit_slab`.
    """
    return _cut(decision, *_bounds(grid, slab)[2:])


def emit_window(
    window: SpatialDecision, grid: BackgroundGrid, slab: Slab, *, left_out: int | None = None
) -> SlabElements:
    """Return the elements of a slab from its part of the decision.

    Parameters
    ----------
    window
        What `window_of` returns.
    grid, slab, left_out
        See `emit_slab`.
    """
    begin, end, low, high = _bounds(grid, slab)
    is_first, is_last = slab.begin == 0, slab.end == grid.shape[0]
    whole = grid.padded().padded()
    part = replace(whole, shape=(high - low, *whole.shape[1:]))
    emitter = emit_elements(window, part, left_out=left_out, first=low)
    found = emitter.collect()
    per_layer = int(np.prod(part.shape[1:]))
    is_used = np.zeros(emitter.n_points, dtype=bool)
    is_used[found.elements] = True
    bounds = None if is_first else begin - low, None if is_last else end - low
    block, place, counts = _number(emitter, is_used, bounds)
    own = slice(*np.searchsorted(found.owner, [(begin - low) * per_layer, (end - low) * per_layer]))
    elements, owner = found.elements[found.order[own]], found.owner[own]
    is_here = np.zeros(emitter.n_points, dtype=bool)
    is_here[elements] = True
    points = np.flatnonzero(is_here).astype(emitter.index)
    number = np.cumsum(is_here, dtype=emitter.index) - 1
    return SlabElements(
        points=emitter.place(points),
        block=block[points],
        place=place[points],
        counts=counts,
        cells=number[elements],
        kind=name_side_balls(found.kind, found.owner, window.field, part)[own],
        grid_cell=_cells_of_grid(owner, part.shape, low, grid.shape),
    )


def _bounds(grid: BackgroundGrid, slab: Slab) -> tuple[int, int, int, int]:
    """Return the layers of a slab and of its window in the grid with layers of void."""
    n = grid.shape[0] + 2 * LAYERS
    begin = 0 if slab.begin == 0 else slab.begin + LAYERS
    end = n if slab.end == grid.shape[0] else slab.end + LAYERS
    return begin, end, max(begin - _AROUND, 0) // 2 * 2, min(end + _AROUND, n)


def _cut(decision: SpatialDecision, low: int, high: int) -> SpatialDecision:
    """Return the decision of a range of layers along x; nothing is marked near its ends."""
    field, n = decision.field, decision.labels.shape[0]
    step = int(field.steps[0])
    some = slice(low * step, (high + 1) * step)
    parts = {}
    for name in Field._fields:
        array = getattr(field, name)
        is_table = name in ("steps", "octant", "face")
        parts[name] = array if is_table else array[..., some]
    for name in ("marked", "has_ball"):
        parts[name] = parts[name].copy()
        # Their neighbours beyond the ends are not known, but none matters for the slab.
        if low > 0:
            parts[name][: 2 * step] = False
        if high < n:
            parts[name][-step:] = False
    bridged = None if decision.bridged is None else decision.bridged[:, some]
    labels = decision.labels[low:high]
    return replace(decision, labels=labels, field=Field(**parts), bridged=bridged)


def _number(
    emitter: Emitter, is_used: NDArray[np.bool_], bounds: tuple[int | None, int | None]
) -> tuple[NDArray[np.int8], IntArray, IntArray]:
    """Return block and place of every point, and the number of points of the slab by block.

    The bounds are the layers of the slab in the window; None at an end of the whole grid.
    """
    per_layer = int(np.prod(emitter.vertex_shape[1:]))
    per_cells = int(np.prod(emitter.grid.shape[1:]))
    sizes = [emitter.n_vertices, emitter.end_of_inner - emitter.n_vertices]
    sizes += [len(layers) for layers in emitter.layers]
    starts = np.concatenate([[0], np.cumsum(sizes)])
    before = np.concatenate([[0], np.cumsum(is_used, dtype=np.int64)])
    block = np.repeat(np.arange(BLOCKS, dtype=np.int8), sizes)
    counts = np.zeros(BLOCKS, dtype=np.int64)
    firsts = np.zeros(BLOCKS, dtype=np.int64)
    for k in range(BLOCKS):
        ends = [0, sizes[k]]
        for side, layer in enumerate(bounds):
            if layer is None:
                continue
            if k == 0:
                ends[side] = layer * per_layer
            elif k == 1:
                ends[side] = emitter.template.n_corners * int(
                    np.searchsorted(emitter.with_inner, layer * per_cells)
                )
            else:
                ends[side] = int(np.searchsorted(emitter.layers[k - 2], layer))
        firsts[k], last = before[starts[k] + np.array(ends)]
        counts[k] = last - firsts[k]
    place = before[:-1] - firsts[block]
    return block, place, counts


def _cells_of_grid(
    owner: IndexArray, shape: tuple[int, ...], low: int, of_grid: tuple[int, ...]
) -> IntArray:
    """Return the flat cells of the grid without layers for cells of a window; -1 outside it."""
    place = np.stack(np.unravel_index(owner, shape)) - LAYERS
    place[0] += low
    limit = np.array(of_grid)[:, None]
    is_inside = ((place >= 0) & (place < limit)).all(axis=0)
    flat = np.ravel_multi_index(tuple(place * is_inside), of_grid)
    return np.asarray(np.where(is_inside, flat, -1), dtype=np.int64)
