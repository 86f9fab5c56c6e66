"""The coarse mesh of a mesh, and the mesh of cells that it stands for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tusqh.coarsening.blocks import ON_GRID, find_blocks, find_plain_cells
from tusqh.coarsening.hanging import find_hanging
from tusqh.errors import MeshError
from tusqh.grid import BackgroundGrid, BoolArray, IndexArray, IntArray
from tusqh.grid.arrays import as_indices
from tusqh.grid.numbering import CORNERS
from tusqh.meshes.volume_mesh import GRID_CELL, VolumeMesh


@dataclass(frozen=True)
class CoarseMesh:
    """A mesh whose inner elements are blocks of grid cells, with hanging vertices.

    Parameters
    ----------
    mesh
        Its elements: first those that were not merged, in their order, then the blocks, from small
        to large.  `grid_cell` of a block is its lowest cell.
    level
        Level of every element, shape (m,), int8: a block of level k has 2**k grid cells along each
        axis; elements that were not merged have level 0.
    grid
        The grid of which the mesh was made.
    """

    mesh: VolumeMesh
    level: NDArray[np.int8]
    grid: BackgroundGrid

    @cached_property
    def is_block(self) -> BoolArray:
        """Whether each element is a block, shape (m,)."""
        return np.asarray(self.level > 0)

    @cached_property
    def starts(self) -> IntArray:
        """Lowest grid vertex of each block, shape (b, dim)."""
        flat = self.mesh.grid_cell[self.is_block]
        return np.stack(np.unravel_index(flat, self.grid.shape), axis=1).astype(np.int64)

    @cached_property
    def sizes(self) -> IntArray:
        """Number of grid cells of each block along an axis, shape (b,)."""
        return np.asarray(1 << self.level[self.is_block].astype(np.int64))

    @cached_property
    def point_at(self) -> IndexArray:
        """Point at each grid vertex that is a corner of a grid cell or of a block; elsewhere -1."""
        return _points_on_grid(self)

    @cached_property
    def hanging(self) -> IntArray:
        """The hanging vertices with their parents, see `tusqh.coarsening.hanging.find_hanging`."""
        return find_hanging(self.point_at, self.starts, self.sizes)

    @property
    def n_merged(self) -> int:
        """Number of grid cells that are in blocks."""
        return int((self.sizes**self.grid.dim).sum())

    @property
    def n_uniform(self) -> int:
        """Number of elements of the mesh that it stands for."""
        return int((~self.is_block).sum()) + self.n_merged

    @cached_property
    def uniform(self) -> VolumeMesh:
        """The mesh that it stands for, in which every block is made of its grid cells.

        Its first points are those of the coarse mesh, in the same order.

        Raises
        ------
        MeshError
            A block lies outside the grid or is not where its grid cell says, or two blocks overlap.
        """
        return _split(self)

    def first_in_uniform(self) -> IntArray:
        """Return the element of `uniform` that is the lowest cell of each element, shape (m,)."""
        n_stay = int((~self.is_block).sum())
        merged = self.uniform.grid_cell[n_stay:]
        lowest = n_stay + np.searchsorted(merged, self.mesh.grid_cell[self.is_block])
        return np.concatenate([np.arange(n_stay), lowest])


def coarsen(mesh: VolumeMesh, grid: BackgroundGrid, *, layers: int = 1) -> CoarseMesh:
    """Return the mesh with its inner grid cells merged to blocks.

    Parameters
    ----------
    mesh
        A staircase or a fitted mesh of one material.
    grid
        The grid of which it was made.
    layers
        Number of layers of grid cells that stay around every block, at least 1.

    Returns
    -------
    CoarseMesh
        The same domain with the same boundary and points, but fewer inside.
    """
    dim = grid.dim
    element = find_plain_cells(mesh, grid)
    is_merged = np.zeros(mesh.n_cells, dtype=bool)
    blocks, levels = [np.empty((0, 2**dim), dtype=mesh.cells.dtype)], [np.empty(0, dtype=np.int8)]
    lowest = [np.empty(0, dtype=mesh.grid_cell.dtype)]
    for level, found in enumerate(find_blocks(element >= 0, layers=layers), start=1):
        starts = np.argwhere(found) << level
        blocks.append(_corners_of_blocks(starts, 1 << level, element, mesh.cells))
        lowest.append(np.ravel_multi_index(tuple(starts.T), grid.shape))
        levels.append(np.full(len(starts), level, dtype=np.int8))
        is_merged[_elements_in(found, level, element)] = True
    stays = np.flatnonzero(~is_merged)
    corners = np.concatenate([mesh.cells[stays], *blocks])
    is_used = np.zeros(len(mesh.points), dtype=bool)
    is_used[corners] = True
    number = np.cumsum(is_used, dtype=mesh.cells.dtype) - 1
    n_blocks = len(corners) - len(stays)
    coarse = VolumeMesh(
        points=mesh.points[is_used],
        cells=as_indices(number[corners]),
        kind=np.concatenate([mesh.kind[stays], np.full(n_blocks, GRID_CELL, dtype=np.int8)]),
        grid_cell=as_indices(np.concatenate([mesh.grid_cell[stays], *lowest])),
        name=mesh.name,
        unit=mesh.unit,
    )
    zeros = np.zeros(len(stays), dtype=np.int8)
    return CoarseMesh(coarse, np.concatenate([zeros, *levels]), grid)


def _corners_of_blocks(
    starts: IntArray, size: int, element: IndexArray, cells: IndexArray
) -> IndexArray:
    """Return the points at the corners of blocks, from the grid cells in these corners."""
    dim = starts.shape[1]
    corners = np.empty((len(starts), 2**dim), dtype=cells.dtype)
    for corner, offset in enumerate(CORNERS[dim]):
        in_corner = element[tuple((starts + (size - 1) * offset).T)]
        corners[:, corner] = cells[in_corner, corner]
    return corners


def _elements_in(found: BoolArray, level: int, element: IndexArray) -> IndexArray:
    """Return the elements of the grid cells in blocks."""
    for axis in range(found.ndim):
        found = np.repeat(found, 1 << level, axis=axis)
    return element[tuple(slice(0, n) for n in found.shape)][found]


def _points_on_grid(coarse: CoarseMesh) -> IndexArray:
    mesh, grid, is_block = coarse.mesh, coarse.grid, coarse.is_block
    point_at = np.full([n + 1 for n in grid.shape], -1, dtype=mesh.cells.dtype)
    cells_only = replace(mesh, kind=np.where(is_block, -1, mesh.kind).astype(np.int8))
    plain = find_plain_cells(cells_only, grid)
    places, corners = np.argwhere(plain >= 0), mesh.cells[plain[plain >= 0]]
    for corner, offset in enumerate(CORNERS[grid.dim]):
        point_at[tuple((places + offset).T)] = corners[:, corner]
        at = coarse.starts + coarse.sizes[:, None] * offset
        point_at[tuple(at.T)] = mesh.cells[is_block, corner]
    return point_at


def _split(coarse: CoarseMesh) -> VolumeMesh:
    mesh, grid, stays = coarse.mesh, coarse.grid, ~coarse.is_block
    if stays.all():
        return mesh
    merged = _cells_of_blocks(coarse)
    places = np.stack(np.unravel_index(merged, grid.shape), axis=1)
    corners = [tuple((places + offset).T) for offset in CORNERS[grid.dim]]
    is_new = np.zeros(coarse.point_at.shape, dtype=bool)
    for at in corners:
        is_new[at] = True
    is_new &= coarse.point_at < 0
    point_at = coarse.point_at.astype(np.int64)
    point_at[is_new] = len(mesh.points) + np.arange(is_new.sum())
    inner = np.stack([point_at[at] for at in corners], axis=1)
    return VolumeMesh(
        points=np.concatenate([mesh.points, grid.to_points(np.argwhere(is_new))]),
        cells=as_indices(np.concatenate([mesh.cells[stays], inner])),
        kind=np.concatenate([mesh.kind[stays], np.full(len(merged), GRID_CELL, dtype=np.int8)]),
        grid_cell=as_indices(np.concatenate([mesh.grid_cell[stays], merged])),
        name=mesh.name,
        unit=mesh.unit,
    )


def _cells_of_blocks(coarse: CoarseMesh) -> IntArray:
    """Return the flat indices of the grid cells in blocks, ascending."""
    grid = coarse.grid
    is_covered = np.zeros(grid.shape, dtype=bool)
    if (coarse.starts + coarse.sizes[:, None] > np.array(grid.shape)).any():
        raise _wrong(coarse, f"has blocks outside the grid {grid.label}")
    for size in np.unique(coarse.sizes).tolist():
        inner = np.stack(np.meshgrid(*grid.dim * [np.arange(size)], indexing="ij"), axis=-1)
        starts = coarse.starts[coarse.sizes == size]
        places = (starts[:, None, :] + inner.reshape(1, -1, grid.dim)).reshape(-1, grid.dim)
        is_covered[tuple(places.T)] = True
    found = np.flatnonzero(is_covered)
    if len(found) != coarse.n_merged:
        raise _wrong(coarse, f"has {coarse.n_merged - len(found)} grid cells in two blocks")
    _require_places(coarse)
    return found


def _require_places(coarse: CoarseMesh) -> None:
    """Raise a `MeshError` if the corners of a block are not where its grid cell says."""
    corners = CORNERS[coarse.grid.dim]
    for corner, offset in enumerate(corners):
        wanted = coarse.grid.to_points(coarse.starts + coarse.sizes[:, None] * offset)
        found = coarse.mesh.points[coarse.mesh.cells[coarse.is_block, corner]]
        n_off = int((np.abs(found - wanted).max(axis=1) > ON_GRID * coarse.grid.cell_size).sum())
        if n_off:
            raise _wrong(coarse, f"has {n_off} blocks that are not where their grid cells say")


def _wrong(coarse: CoarseMesh, found: str) -> MeshError:
    return MeshError(
        found,
        where=coarse.mesh.name,
        expected="blocks of whole grid cells, none of which overlap",
        remedy="make the coarse mesh again",
    )
