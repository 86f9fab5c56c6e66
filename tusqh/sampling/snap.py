"""Put planes of the grid on plane faces of the geometry, where necessary with other cells."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tusqh.errors import SamplingError
from tusqh.geometry.kinds import Surface
from tusqh.grid import BackgroundGrid, FloatArray, IntArray
from tusqh.grid.frame import Frame
from tusqh.sampling.face_planes import LEAST_SHARE, FacePlane, find_face_planes
from tusqh.sampling.lattice import Box
from tusqh.sampling.placement import GridPlane, Placement

#: A face lies on a plane of the grid if it is this near to it, in cells.  The samples nearest to a
#: plane of the grid are much farther away, so such a face cuts no cell.
NEAR = 1e-3

#: Distances below this are rounding, in cells.
_EXACT = 1e-9

#: Cells become at most this many times as large or as small as requested.
_LARGEST_CHANGE = 1.5

#: Shares of the plane area that differ by less are equal; then the nearest size is chosen.
_EQUAL = 0.02


def snap_grid(
    grid: BackgroundGrid, surfaces: Sequence[Surface], box: Box, *, is_cubic: bool = True
) -> tuple[BackgroundGrid, Placement]:
    """Return a grid whose planes lie on as much plane area of a geometry as possible.

    Among the cell sizes that differ from the grid's by at most a factor of 1.5, the ones that put
    the most area of faces on planes of the grid are compared, and the nearest one is taken.  An
    axis without plane faces keeps its centred position.

    Parameters
    ----------
    grid
        The grid with the requested size of cells, laid over the box.
    surfaces
        The geometry, in the coordinates of the grid.
    box
        The box that the grid must cover, likewise.
    is_cubic
        Whether cells stay cubes in the coordinates of the grid; otherwise each axis has its own
        size, and the grid another frame.

    Returns
    -------
    grid
        The grid on the planes.
    placement
        The planes of the geometry, and how far each is from a plane of the grid.

    Raises
    ------
    SamplingError
        The geometry has no plane face across an axis.
    """
    planes = [
        plane
        for plane in find_face_planes(surfaces, grid.cell_size)
        if box[0][plane.axis] <= plane.at <= box[1][plane.axis]
    ]
    if not planes:
        raise SamplingError(
            "the geometry has no plane faces across an axis of the grid with at least "
            f"{100 * LEAST_SHARE:g} % of its area",
            where=f"{surfaces[0].name}, `snap`",
            expected="plane faces (2D: straight edges) parallel to planes of coordinates",
            remedy="leave out `snap`; `placement: auto` and `offset` move the grid, too",
        )
    by_axis = [[plane for plane in planes if plane.axis == k] for k in range(grid.dim)]
    if is_cubic:
        size, origins = _adjust(by_axis, _choose_size(by_axis, grid.cell_size))
        snapped = _cover(grid, [size] * grid.dim, origins, box)
    else:
        found = [_fit_axis(planes_of_axis, grid.cell_size) for planes_of_axis in by_axis]
        snapped = _cover(grid, [size for size, _ in found], [place for _, place in found], box)
    placement = Placement((0,) * grid.dim, 0, requested=grid.sides, taken=snapped.sides)
    return snapped, replace(placement, planes=_compare(planes, grid, snapped))


def _fit_axis(planes: list[FacePlane], wanted: float) -> tuple[float, float | None]:
    """Return the size and position of the cells along an axis, chosen for it alone."""
    if not planes:
        return wanted, None
    size, (place,) = _adjust([planes], _choose_size([planes], wanted))
    return size, place


def offset_grid(grid: BackgroundGrid, offset: Sequence[float], box: Box) -> BackgroundGrid:
    """Return a grid moved by fractions of a cell, with the cells that it needs to cover a box.

    Parameters
    ----------
    grid
        The grid at the corner.
    offset
        How far it is moved along each axis, in cells.
    box
        The box that the grid must cover, in model units.

    Examples
    --------
    >>> grid = BackgroundGrid((4, 4), 1.0, (0.0, 0.0))
    >>> offset_grid(grid, (0.25, 0), ((0.0, 0.0), (4.0, 4.0)))
    BackgroundGrid(shape=(5, 4), cell_size=1.0, origin=(-0.75, 0.0))
    """
    origins = [o + grid.cell_size * step for o, step in zip(grid.origin, offset, strict=True)]
    return _cover(grid, [grid.cell_size] * grid.dim, origins, box)


def _choose_size(by_axis: list[list[FacePlane]], wanted: float) -> float:
    """Return the nearest of the cell sizes that put the most area on planes of the grid."""
    sizes = np.concatenate([[wanted], *(_commensurate(planes, wanted) for planes in by_axis)])
    shares = sum(_share_on_planes(planes, sizes) for planes in by_axis if planes)
    total = sum(plane.share for planes in by_axis for plane in planes)
    is_best = shares >= np.max(shares) - _EQUAL * total
    change = np.abs(np.log(sizes / wanted))
    return float(sizes[is_best][np.argmin(change[is_best])])


def _commensurate(planes: list[FacePlane], wanted: float) -> FloatArray:
    """Return the sizes near the wanted one of which two planes are a whole number apart."""
    at = np.array([plane.at for plane in planes])
    apart = np.abs(at[:, None] - at)[np.triu_indices(len(at), 1)]
    sizes = [np.empty(0)]
    for distance in apart.tolist():
        first = np.ceil(distance / (wanted * _LARGEST_CHANGE) - NEAR)
        last = np.floor(distance / (wanted / _LARGEST_CHANGE) + NEAR)
        sizes.append(distance / np.arange(max(first, 1), last + 1))
    return np.concatenate(sizes)


def _share_on_planes(planes: list[FacePlane], sizes: FloatArray) -> FloatArray:
    """Return the largest share of area that a position of the grid puts on planes, by size."""
    at, shares = (np.array([getattr(plane, k) for plane in planes]) for k in ("at", "share"))
    best = np.zeros(len(sizes))
    for k in range(len(at)):
        cells = (at - at[k]) / sizes[:, None]
        is_on = np.abs(cells - np.rint(cells)) <= NEAR
        best = np.maximum(best, is_on @ shares)
    return best


def _adjust(by_axis: list[list[FacePlane]], size: float) -> tuple[float, list[float | None]]:
    """Return the size and the positions with the least squared distance from faces to planes."""
    numbers, places, axes = [], [], []
    origins: list[float | None] = [None] * len(by_axis)
    for axis, planes in enumerate(by_axis):
        if not planes:
            continue
        at = np.array([plane.at for plane in planes])
        anchor, number = _best_position(planes, size)
        is_on = np.abs((at - anchor) / size - number) <= NEAR
        origins[axis] = anchor
        numbers.append(number[is_on])
        places.append(at[is_on] - anchor)
        axes.append(np.full(int(is_on.sum()), axis))
    number, place, axis_of = (np.concatenate(some) for some in (numbers, places, axes))
    # Faces that fit up to the rounding of their file need no other position.
    if np.abs(place - number * size).max() > _EXACT * size:
        matrix = np.column_stack([number, *(axis_of == axis for axis in range(len(by_axis)))])
        found = np.linalg.lstsq(matrix, place, rcond=None)[0]
        size = float(found[0])
        origins = [None if o is None else o + float(found[1 + k]) for k, o in enumerate(origins)]
    return size, origins


def _best_position(planes: list[FacePlane], size: float) -> tuple[float, IntArray]:
    """Return the plane on which the most area is commensurate, and the cells to the others."""
    at, shares = (np.array([getattr(plane, k) for plane in planes]) for k in ("at", "share"))
    cells = (at - at[:, None]) / size
    on_planes = (np.abs(cells - np.rint(cells)) <= NEAR) @ shares
    best = int(np.argmax(on_planes))
    return float(at[best]), np.rint(cells[best]).astype(np.int64)


def _cover(
    grid: BackgroundGrid, sizes: Sequence[float], origins: Sequence[float | None], box: Box
) -> BackgroundGrid:
    """Return the grid with planes through given places that covers a box.

    Sizes, places and the box are in the coordinates of the given grid.  Where the sizes differ, the
    returned grid has another frame, in whose coordinates its cells are cubes.
    """
    shape, origin = [], []
    for axis, (size, place) in enumerate(zip(sizes, origins, strict=True)):
        low, high = box[0][axis], box[1][axis]
        if place is None:
            shape.append(max(1, math.ceil((high - low) / size - 1e-9)))
            origin.append(low - (shape[-1] * size - (high - low)) / 2)
            continue
        first = math.floor((low - place) / size + NEAR)
        last = math.ceil((high - place) / size - NEAR)
        shape.append(max(last - first, 1))
        origin.append(place + first * size)
    sides = grid.frame.sides or (1.0,) * grid.dim
    of_cell = tuple(size * side for size, side in zip(sizes, sides, strict=True))
    frame, cell_size = replace(grid.frame, sides=()), sizes[0]
    if len(set(sizes)) > 1 or grid.frame.sides:
        frame, cell_size = Frame.of_sides(None, of_cell)
        frame = replace(frame, axes=grid.frame.axes)
        origin = [o * cell_size / size for o, size in zip(origin, sizes, strict=True)]
    return replace(grid, shape=tuple(shape), cell_size=cell_size, origin=tuple(origin), frame=frame)


def _compare(
    planes: list[FacePlane], grid: BackgroundGrid, snapped: BackgroundGrid
) -> tuple[GridPlane, ...]:
    """Return the distance of every plane of the geometry from the nearest one of a snapped grid.

    The planes are in the coordinates of the grid before; the result is in model units.
    """
    found = []
    for plane in planes:
        at = plane.at * grid.sides[plane.axis] / grid.cell_size
        size = snapped.sides[plane.axis]
        cells = at / size - snapped.origin[plane.axis] / snapped.cell_size
        away = abs(cells - round(cells))
        away = 0.0 if away <= NEAR else round(away, 6)
        found.append(GridPlane("xyz"[plane.axis], at, plane.share, away))
    return tuple(found)
