"""Lay the background grid over a window, or over the geometry's bounding box."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tusqh.errors import SamplingError
from tusqh.geometry.framed import box_to_frame, to_frame
from tusqh.geometry.kinds import Surface
from tusqh.grid import BackgroundGrid
from tusqh.grid.frame import Frame
from tusqh.sampling.directions import find_directions
from tusqh.sampling.inside_lengths import box_of_inside
from tusqh.sampling.lattice import Box
from tusqh.sampling.placement import Placement
from tusqh.sampling.snap import offset_grid, snap_grid
from tusqh.settings.grid import Grid
from tusqh.settings.sampling import Sampling


@dataclass(frozen=True)
class Laid:
    """A grid where the settings lay it, and the geometry in its coordinates.

    Parameters
    ----------
    grid
        The grid.
    surfaces
        The geometry in the coordinates of the grid, one surface for each material.
    window
        The box to mesh in, likewise; None: there is none.
    covered
        The box that the grid covers, likewise.
    placement
        How `snap` or `offset` placed the grid; None if they are not set.
    """

    grid: BackgroundGrid
    surfaces: list[Surface]
    window: Box | None
    covered: Box
    placement: Placement | None


def lay_as_set(
    surfaces: Sequence[Surface],
    window: Box | None,
    settings: Grid,
    sampling: Sampling | None = None,
) -> Laid:
    """Return the background grid for a geometry where the settings lay it.

    Parameters
    ----------
    surfaces
        The geometry, one surface for each material.
    window
        Box to mesh in, in model units; None: the box around the surfaces.
    settings
        The settings of the grid.
    sampling
        What is inside; None: with the defaults.

    Raises
    ------
    SamplingError
        Box, settings and geometry do not match, or there are no faces to lay the grid on.
    """
    first, dim = surfaces[0], len(surfaces[0].bounding_box()[0])
    cell_size, axes = settings.cell_size, find_directions(surfaces, settings)
    frame, size = Frame() if axes is None else Frame.of_sides(axes, (1.0,))[0], cell_size
    if isinstance(cell_size, tuple):
        _require_numbers(first, dim, {"grid.cell_size": cell_size})
        frame, size = Frame.of_sides(axes, cell_size)
    size = None if size is None else float(size)  # type: ignore[arg-type]
    laid = _lay(surfaces, window, frame, replace(settings, cell_size=size), sampling)
    if settings.snap:
        grid, placement = snap_grid(
            laid.grid, laid.surfaces, laid.covered, is_cubic=not isinstance(cell_size, tuple)
        )
        if grid.frame != laid.grid.frame:
            fitted = replace(settings, cell_size=grid.cell_size)
            laid = _lay(surfaces, window, grid.frame, fitted, sampling)
        return replace(laid, grid=grid, placement=placement)
    if settings.offset is None:
        return laid
    _require_numbers(first, dim, {"grid.offset": settings.offset})
    placement = Placement((0,) * dim, 0, offset=settings.offset)
    grid = offset_grid(laid.grid, settings.offset, laid.covered)
    return replace(laid, grid=grid, placement=placement)


def _lay(
    surfaces: Sequence[Surface],
    window: Box | None,
    frame: Frame,
    settings: Grid,
    sampling: Sampling | None,
) -> Laid:
    """Return the grid of cubes in the coordinates of a frame, centred on the box."""
    placed = [to_frame(surface, frame) for surface in surfaces]
    window = box_to_frame(window, frame)
    if window is None:
        covered = box_of_inside(placed[0], box_around(placed), sampling or Sampling(), settings)
    else:
        covered = window
    size = settings.cell_size
    assert not isinstance(size, tuple)
    grid = lay_grid(placed[0], covered, cells=settings.cells, cell_size=size)
    return Laid(replace(grid, frame=frame), placed, window, covered, None)


def box_around(surfaces: Sequence[Surface]) -> Box:
    """Return the box around all surfaces.

    Parameters
    ----------
    surfaces
        The surfaces, of one dimension.
    """
    low, high = zip(*(surface.bounding_box() for surface in surfaces), strict=True)
    return tuple(np.min(low, axis=0).tolist()), tuple(np.max(high, axis=0).tolist())


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
