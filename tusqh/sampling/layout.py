"""Lay the background grid over a window, or over the geometry's bounding box."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from tusqh.errors import SamplingError
from tusqh.geometry.kinds import Surface
from tusqh.grid import BackgroundGrid
from tusqh.sampling.lattice import Box


def lay_grid(
    geometry: Surface,
    window: Box | None,
    *,
    cells: int | Sequence[int] | None = None,
    cell_size: float | None = None,
) -> BackgroundGrid:
    """Return the background grid for a geometry.

    Parameters
    ----------
    geometry
        The geometry.
    window
        Box to cover instead of the bounding box, in model units.
    cells
        Cells along the longest side, or along each axis, see `BackgroundGrid.over_box`.
    cell_size
        Edge length of a cell instead, in model units.

    Raises
    ------
    SamplingError
        The box has no extent along an axis, or its number of axes differs from the geometry's.
    """
    lower, upper = window or geometry.bounding_box()
    dim = len(geometry.bounding_box()[0])
    if isinstance(cells, Sequence):
        cells = tuple(cells)
    wrong = [
        f"`{key}` has {n} numbers"
        for key, n in (
            ("window", len(lower)),
            ("grid.cells", len(cells) if isinstance(cells, tuple) else dim),
        )
        if n != dim
    ]
    if wrong:
        raise SamplingError(
            f"{' and '.join(wrong)}, the geometry has {dim} dimensions",
            where=geometry.name,
            expected=f"{dim} numbers, one for each axis",
            remedy="give one number for each axis",
        )
    grid = BackgroundGrid.over_box(lower, upper, cells=cells, cell_size=cell_size)
    return replace(grid, unit=geometry.unit)
