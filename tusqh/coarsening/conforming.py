"""Merge grid cells inside a mesh so that it stays conforming, by blocks of three cells a side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tusqh.coarsening.blocks import erode, find_plain_cells
from tusqh.coarsening.sheets import CELLS
from tusqh.coarsening.thirds import Level, find_level
from tusqh.coarsening.transition import Transition, fill_transition
from tusqh.grid import BackgroundGrid, BoolArray, FloatArray, IndexArray, IntArray
from tusqh.grid.arrays import as_indices
from tusqh.grid.numbering import CORNERS
from tusqh.meshes.jacobians import smallest_jacobians
from tusqh.meshes.volume_mesh import GRID_CELL, TRANSITION, VolumeMesh


@dataclass(frozen=True)
class ConformingMesh:
    """A conforming mesh whose inner elements are larger.

    Parameters
    ----------
    mesh
        Its elements: first those that were neither merged nor replaced, in their order, then level
        by level the elements of the transition and the blocks.  `grid_cell` of a block is its
        lowest cell, that of an element of a transition the lowest cell of its block.
    level
        Level of every element, shape (m,), int8: a block of level k has 3**k grid cells along each
        axis; elements between blocks of levels k - 1 and k have level k; all others have level 0.
    grid
        The grid of which the mesh was made.
    n_uniform
        Number of elements of the mesh from which it was made.
    """

    mesh: VolumeMesh
    level: NDArray[np.int8]
    grid: BackgroundGrid
    n_uniform: int

    @property
    def least_new(self) -> float:
        """Smallest scaled Jacobian of the elements that the mesh before did not have; 1 if none."""
        is_new = self.level > 0
        scaled = smallest_jacobians(self.mesh.points, self.mesh.cells[is_new]).scaled
        return float(scaled.min(initial=1.0))


def coarsen_conforming(
    mesh: VolumeMesh, grid: BackgroundGrid, *, layers: int = 1
) -> ConformingMesh:
    """Return the mesh with its inner grid cells merged, without hanging vertices.

    Parameters
    ----------
    mesh
        A staircase or a fitted mesh of one material.
    grid
        The grid of which it was made.
    layers
        Number of layers of grid cells that stay around everything that changes, at least 1.

    Returns
    -------
    ConformingMesh
        The same domain with the same boundary, with fewer and larger elements inside.  Every new
        element has a scaled Jacobian of at least `tusqh.coarsening.transition.LEAST`.
    """
    element = find_plain_cells(mesh, grid)
    may_merge = element >= 0
    for _ in range(layers):
        may_merge = erode(may_merge)
    levels = _find_levels(may_merge, grid)
    builder = _Builder(mesh, grid, element)
    for number, (level, transition) in enumerate(levels, start=1):
        above = levels[number][0] if number < len(levels) else None
        builder.add(number, level, transition, above)
    return builder.finish()


def _find_levels(may_merge: BoolArray, grid: BackgroundGrid) -> list[tuple[Level, Transition]]:
    """Return the blocks of every level with the elements of their transitions."""
    levels: list[tuple[Level, Transition]] = []
    size, start = 1, (0,) * grid.dim
    while True:
        found = _find_good_level(may_merge, size, start)
        if found is None:
            return levels
        levels.append(found)
        may_merge, size, start = found[0].is_whole, size * CELLS, found[0].start


def _find_good_level(
    may_merge: BoolArray, size: int, start: tuple[int, ...]
) -> tuple[Level, Transition] | None:
    """Return a level all of whose elements are good; blocks with bad ones stay divided."""
    while True:
        level = find_level(may_merge, size, start)
        if level is None:
            return None
        transition = fill_transition(level)
        bad = transition.bad_blocks
        if not len(bad):
            return level, transition
        offset = (np.array(level.start) - start) // size
        may_merge = may_merge.copy()
        may_merge[tuple((CELLS * bad + offset).T)] = False


class _Builder:
    """Collect the elements of a conforming mesh, level by level."""

    def __init__(self, mesh: VolumeMesh, grid: BackgroundGrid, element: IndexArray) -> None:
        self.mesh, self.grid, self.element = mesh, grid, element
        self.is_replaced = np.zeros(mesh.n_cells, dtype=bool)
        self.point_at = np.full([n + 1 for n in grid.shape], -1, dtype=np.int64)
        plain = np.argwhere(element >= 0)
        for corner, offset in enumerate(CORNERS[grid.dim]):
            self.point_at[tuple((plain + offset).T)] = mesh.cells[element[element >= 0], corner]
        self.points: list[FloatArray] = [mesh.points]
        self.n_points = len(mesh.points)
        self.cells: list[IntArray] = []
        self.kind: list[NDArray[np.int8]] = []
        self.grid_cell: list[IntArray] = []
        self.level: list[NDArray[np.int8]] = []

    def add(self, number: int, level: Level, transition: Transition, above: Level | None) -> None:
        """Add the elements of a level, without blocks that the level above merges or replaces."""
        start, size = np.array(level.start), level.size
        if number == 1:
            changed = np.argwhere(level.is_whole | level.is_transition)
            for offset in np.ndindex(*self.grid.dim * [CELLS]):
                at = tuple((start + CELLS * changed + offset).T)
                self.is_replaced[self.element[at]] = True
        places = start + size * np.round(transition.points).astype(np.int64)
        points = np.full(len(places), -1, dtype=np.int64)
        on_grid = transition.on_grid
        points[on_grid] = self.point_at[tuple(places[on_grid].T)]
        points[~on_grid] = self.n_points + np.arange((~on_grid).sum())
        new = self.grid.to_points(start + size * transition.points[~on_grid])
        self.points.append(new)
        self.n_points += len(new)
        lowest = start + CELLS * size * transition.block
        self._append(points[transition.cells], lowest, TRANSITION, number)
        stays = level.is_whole.copy()
        if above is not None:
            offset = (np.array(above.start) - start) // (CELLS * size)
            upper = np.argwhere(above.is_whole | above.is_transition)
            for within in np.ndindex(*self.grid.dim * [CELLS]):
                stays[tuple((offset + CELLS * upper + within).T)] = False
        lowest = start + CELLS * size * np.argwhere(stays)
        corners = lowest[:, None, :] + CELLS * size * CORNERS[self.grid.dim]
        self._append(self.point_at[tuple(np.moveaxis(corners, -1, 0))], lowest, GRID_CELL, number)

    def _append(self, cells: IntArray, lowest: IntArray, kind: int, number: int) -> None:
        assert cells.min(initial=0) >= 0, "an element has a corner without a point"
        self.cells.append(cells)
        self.kind.append(np.full(len(cells), kind, dtype=np.int8))
        self.grid_cell.append(np.ravel_multi_index(tuple(lowest.T), self.grid.shape))
        self.level.append(np.full(len(cells), number, dtype=np.int8))

    def finish(self) -> ConformingMesh:
        """Return the mesh, with the points that it needs."""
        mesh, stays = self.mesh, ~self.is_replaced
        cells = np.concatenate([mesh.cells[stays], *self.cells])
        points = np.concatenate(self.points)
        is_used = np.zeros(len(points), dtype=bool)
        is_used[cells] = True
        number = np.cumsum(is_used) - 1
        return ConformingMesh(
            VolumeMesh(
                points=points[is_used],
                cells=as_indices(number[cells]),
                kind=np.concatenate([mesh.kind[stays], *self.kind]),
                grid_cell=as_indices(np.concatenate([mesh.grid_cell[stays], *self.grid_cell])),
                name=mesh.name,
                unit=mesh.unit,
            ),
            np.concatenate([np.zeros(int(stays.sum()), dtype=np.int8), *self.level]),
            self.grid,
            mesh.n_cells,
        )
