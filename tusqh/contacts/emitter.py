"""The emitter, which numbers the points of templates, collects elements, and makes the mesh."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.templates import TEMPLATES
from tusqh.grid.arrays import BoolArray, FloatArray, IntArray
from tusqh.grid.background import BackgroundGrid
from tusqh.grid.numbering import CORNERS
from tusqh.meshes.volume_mesh import VolumeMesh


class Emitted(NamedTuple):
    """A mesh with the materials of its elements.

    Parameters
    ----------
    mesh
        The mesh.
    material
        Material of every element, shape (m,).
    """

    mesh: VolumeMesh
    material: IntArray


class Emitter:
    """A collector of numbered points and elements.

    Points are numbered in three blocks: all grid vertices, the corners of all inner cells, and the
    points added with `add_points`.  `finish` leaves out unused points.

    Parameters
    ----------
    grid
        The background grid, of shape n.
    has_inner
        Cells with an inner cell, shape n.
    left_out
        A material whose elements are left out; None: all materials have elements.
    """

    def __init__(
        self, grid: BackgroundGrid, has_inner: BoolArray, *, left_out: int | None = None
    ) -> None:
        self.grid = grid
        self._left_out = left_out
        self.template = TEMPLATES[grid.dim]
        self.vertex_shape = tuple(n + 1 for n in grid.shape)
        self.n_vertices = int(np.prod(self.vertex_shape))
        self._with_inner = np.flatnonzero(has_inner)
        self._inner_number = np.full(grid.n_cells, -1, dtype=np.int64)
        self._inner_number[self._with_inner] = np.arange(len(self._with_inner))
        self._end_of_inner = self.n_vertices + self.template.n_corners * len(self._with_inner)
        self._corner_step = np.array(
            [np.ravel_multi_index(tuple(c), self.vertex_shape) for c in CORNERS[grid.dim]]
        )
        self._added: list[FloatArray] = []
        self._moved: list[tuple[IntArray, FloatArray]] = []
        self._n_points = self._end_of_inner
        self._elements: list[IntArray] = []
        self._owners: list[IntArray] = []
        self._kinds: list[IntArray] = []
        self._materials: list[IntArray] = []

    def outer(self, cells: IntArray) -> IntArray:
        """Return the grid vertices at the corners of flat cells, shape (m, 2**dim).

        Parameters
        ----------
        cells
            Flat cells, shape (m,).
        """
        lowest = np.ravel_multi_index(np.unravel_index(cells, self.grid.shape), self.vertex_shape)
        return np.asarray(lowest[:, None] + self._corner_step, dtype=np.int64)

    def inner(self, cells: IntArray) -> IntArray:
        """Return the corners of the inner cells of flat cells, shape (m, 2**dim).

        Parameters
        ----------
        cells
            Flat cells that have an inner cell, shape (m,).
        """
        n_corners = self.template.n_corners
        first = self.n_vertices + n_corners * self._inner_number[cells]
        return np.asarray(first[:, None] + np.arange(n_corners), dtype=np.int64)

    def add_points(self, positions: FloatArray) -> IntArray:
        """Add points at given positions and return their numbers.

        Parameters
        ----------
        positions
            Positions in cells from the grid's lowest corner, shape (m, dim).

        Returns
        -------
        numbers
            Shape (m,).
        """
        numbers = self._n_points + np.arange(len(positions), dtype=np.int64)
        self._added.append(positions)
        self._n_points += len(positions)
        return numbers

    def move(self, numbers: IntArray, positions: FloatArray) -> None:
        """Give points other positions.

        Parameters
        ----------
        numbers
            Numbers of the points, shape (m,).
        positions
            Positions in cells from the grid's lowest corner, shape (m, dim).
        """
        self._moved.append((numbers, positions))

    def add(
        self,
        elements: IntArray,
        owners: IntArray,
        kind: int | IntArray,
        materials: int | NDArray[np.integer] = 0,
    ) -> None:
        """Add elements.

        Parameters
        ----------
        elements
            Numbers of the elements' points, in VTK order, shape (m, 2**dim).
        owners
            Flat cells in which the elements lie, shape (m,).
        kind
            One of the kinds of `tusqh.meshes.volume_mesh`, for all of them or for each.
        materials
            The material, for all of them or for each.
        """
        kinds = np.broadcast_to(kind, len(elements))
        material = np.broadcast_to(materials, len(elements))
        if self._left_out is not None:
            stays = material != self._left_out
            elements, owners = elements[stays], owners[stays]
            kinds, material = kinds[stays], material[stays]
        self._elements.append(elements)
        self._owners.append(owners)
        self._kinds.append(kinds.astype(np.int64))
        self._materials.append(material.astype(np.int64))

    def finish(self, name: str) -> Emitted:
        """Return the mesh of all elements, in the order of their cells.

        Parameters
        ----------
        name
            The model, for messages.

        """
        owner = np.concatenate(self._owners)
        order = np.argsort(owner, kind="stable")
        cells, used = _renumber(np.concatenate(self._elements), order, self._n_points)
        mesh = VolumeMesh(
            points=self.grid.to_points(self._positions(used)),
            cells=cells,
            kind=np.concatenate(self._kinds)[order],
            grid_cell=owner[order],
            name=name,
        )
        return Emitted(mesh=mesh, material=np.concatenate(self._materials)[order])

    def _positions(self, points: IntArray) -> FloatArray:
        """Return the positions of ascending points, in cells from the grid's lowest corner."""
        bounds = np.searchsorted(points, [self.n_vertices, self._end_of_inner])
        vertices, inner, added = np.split(points, bounds)
        cell, corner = np.divmod(inner - self.n_vertices, self.template.n_corners)
        lowest = np.stack(np.unravel_index(self._with_inner[cell], self.grid.shape), axis=1)
        nothing = np.empty((0, self.grid.dim))
        found = np.concatenate(
            [
                np.stack(np.unravel_index(vertices, self.vertex_shape), axis=1),
                lowest + self.template.inner[corner],
                np.concatenate([nothing, *self._added])[added - self._end_of_inner],
            ]
        )
        for numbers, positions in self._moved:
            rows = np.searchsorted(points, numbers)
            is_used = points[np.minimum(rows, len(points) - 1)] == numbers
            found[rows[is_used]] = positions[is_used]
        return found


@numba.njit(cache=True)
def _renumber(elements, order, n_points):  # type: ignore[no-untyped-def]
    """Return ordered elements with consecutive numbers of the used points, and these points."""
    number = np.full(n_points, -1, dtype=np.int64)
    for element in elements:
        for point in element:
            number[point] = 0
    n_used = 0
    for point in range(n_points):
        if number[point] == 0:
            number[point] = n_used
            n_used += 1
    used = np.empty(n_used, dtype=np.int64)
    for point in range(n_points):
        if number[point] >= 0:
            used[number[point]] = point
    cells = np.empty_like(elements)
    for i in range(len(order)):
        for c in range(elements.shape[1]):
            cells[i, c] = number[elements[order[i], c]]
    return cells, used
