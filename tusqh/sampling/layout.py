"""Lay the background grid over a window, or over the geometry's bounding box."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from tusqh.errors import SamplingError
from tusqh.geometry.kinds import Surface
from tusqh.grid import BackgroundGrid
from tusqh.sampling.lattice import Box
from tusqh.sampling.placement import Placement
from tusqh.sampling.snap import offset_grid, snap_grid
from tusqh.settings.grid import Grid


def lay_as_set(
    surfaces: Sequence[Surface], box: Box | None, grid: Grid
) -> tuple[BackgroundGrid, Placement | None]:
    """Return the background grid for a geometry where the settings lay it.

    Parameters
    ----------
    surfaces
        The geometry, one surface for each material.
    box
        Box to cover, in model units; None: the bounding box of the first surface.
    grid
        The settings of the grid.

    Returns
    -------
    grid
        The grid.
    placement
        How `snap` or `offset` placed it; None if they are not set.

    Raises
    ------
    SamplingError
        Box, settings and geometry do not match, or there are no faces to lay the grid on.
    """
    found = lay_grid(surfaces[0], box, cells=grid.cells, cell_size=grid.cell_size)
    box = box or surfaces[0].bounding_box()
    if grid.snap:
        return snap_grid(found, surfaces, box)
    if grid.offset is None:
        return found, None
    _require_numbers(surfaces[0], found.dim, {"grid.offset": grid.offset})
    placement = Placement((0,) * found.dim, 0, offset=grid.offset)
    return offset_grid(found, grid.offset, box), placement


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
    given = {"window": lower, "grid.cells": cells}
    _require_numbers(geometry, dim, {k: v for k, v in given.items() if isinstance(v, tuple)})
    grid = BackgroundGrid.over_box(lower, upper, cells=cells, cell_size=cell_size)
    return replace(grid, unit=geometry.unit)


def _require_numbers(geometry: Surface, dim: int, given: Mapping[str, Sequence[float]]) -> None:
    """Raise an error if a setting does not have one number for each axis."""
    wrong = [f"`{key}` has {len(v)} numbers" for key, v in given.items() if len(v) != dim]
    if wrong:
        raise SamplingError(
            f"{' and '.join(wrong)}, the geometry has {dim} dimensions",
            where=geometry.name,
            expected=f"{dim} numbers, one for each axis",
            remedy="give one number for each axis",
        )
