"""Report polygons smaller than a grid cell, which a mesh may miss."""

from __future__ import annotations

import numpy as np

from tusqh.geometry.outline import Outline
from tusqh.geometry.outline_facts import OutlineFacts
from tusqh.geometry.remark import Remark
from tusqh.grid import BackgroundGrid, BoolArray


def remarks_on_small_polygons(
    outline: Outline, grid: BackgroundGrid, is_kept: BoolArray, *, is_outside: bool = False
) -> tuple[Remark, ...]:
    """Return a remark on the closed chains smaller than a cell that a mesh misses.

    The mesh shows a chain if the cell at the middle of its bounding box is kept, or, for a hole,
    is not kept.

    Parameters
    ----------
    outline
        The outline.
    grid
        The background grid.
    is_kept
        Cells of the mesh, shape n.
    is_outside
        Whether the mesh covers the region outside the outline.

    Returns
    -------
    tuple of Remark
        One remark, or none.

    Examples
    --------
    >>> ring = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])
    >>> outline = Outline.from_chains([ring * 0.1 + (2 * k + 0.4) for k in range(3)])
    >>> grid = BackgroundGrid.over_box((0, 0), (5, 5), cells=5)
    >>> str(remarks_on_small_polygons(outline, grid, np.zeros((5, 5), dtype=bool))[0])[:61]
    'left out: 3 of 3 polygons and holes, each smaller than a cell'
    """
    facts = OutlineFacts(outline)
    is_piece = np.abs(facts.areas) > facts.flat_area
    is_small = is_piece & (np.abs(facts.areas) < grid.cell_size**2)
    if not is_small.any():
        return ()
    ends = facts.points[facts.segments]
    low, high = np.full((facts.n_chains, 2), np.inf), np.full((facts.n_chains, 2), -np.inf)
    np.minimum.at(low, facts.chains, ends.min(axis=1))
    np.maximum.at(high, facts.chains, ends.max(axis=1))
    place = np.floor(grid.to_lattice((low + high) / 2)).astype(np.int64)
    is_small &= ((place >= 0) & (place < is_kept.shape)).all(axis=1)
    chosen = np.flatnonzero(is_small)
    hand = 1 if facts.areas.sum() >= 0 else -1
    is_material = (facts.areas[chosen] * hand > 0) ^ is_outside
    is_lost = is_kept[tuple(place[chosen].T)] != is_material
    lost = np.sqrt(np.abs(facts.areas[chosen[is_lost]]))
    if not len(lost):
        return ()
    what = f"of {is_piece.sum():,} polygons and holes, each smaller than a cell"
    remedy = f"half of them are as large as cells of {np.median(lost):.3g}"
    return (Remark("left out", what, len(lost), remedy),)
