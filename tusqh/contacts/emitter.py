"""The emitter, which numbers the points of templates, collects elements, and makes the mesh."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.templates import TEMPLATES
from tusqh.grid.arrays import BoolArray, FloatArray, IndexArray, IntArray
from tusqh.grid.background import BackgroundGrid
from tusqh.grid.numbering import CORNERS
from tusqh.meshes.volume_mesh import VolumeMesh

#: Most points that a split cell has: corners of its inner cell, and its share of the points in
#: faces and of balls.
_MOST_POINTS = 256

#: How many points get their positions at a time, which bounds memory.
_AT_A_TIME = 4_000_000


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
    material: NDArray[np.int32]


class Collected(NamedTuple):
    """All elements of an emitter.

    Parameters
    ----------
    elements
        Numbers of the elements' points, in the order in which they were added, shape (m, 2**dim).
    order
        The rows of `elements` in the order of their cells, shape (m,).
    owner, kind, material
        The flat cell, kind and material of each element, in the order of their cells, shape (m,).
    """

    elements: IndexArray
    order: IndexArray
    owner: IndexArray
    kind: NDArray[np.int8]
    material: NDArray[np.int32]


class Emitter:
    """A collector of numbered points and elements.

    Points are numbered in three blocks: all grid vertices, the corners of all inner cells, and the
    points added with `add_points`.  `finish` leaves out unused points.  Numbers are 32-bit unless
    there may be too many points.

    Parameters
    ----------
    grid
        The background grid, of shape n.
    has_inner
        Cells with an inner cell, shape n.
    left_out
        A material whose elements are left out; None: all materials have elements.
    first
        Where the grid begins along x, in cells from its origin, if it is a part of a larger one.
    """

    def __init__(
        self,
        grid: BackgroundGrid,
        has_inner: BoolArray,
        *,
        left_out: int | None = None,
        first: int = 0,
    ) -> None:
        self.grid = grid
        self._first = np.eye(grid.dim, dtype=np.int64)[0] * first
        self._left_out = left_out
        self.template = TEMPLATES[grid.dim]
        self.vertex_shape = tuple(n + 1 for n in grid.shape)
        self.n_vertices = int(np.prod(self.vertex_shape))
        self.with_inner = np.flatnonzero(has_inner)
        most = self.n_vertices + _MOST_POINTS * len(self.with_inner)
        self.index = np.dtype(np.int32 if most < 2**31 else np.int64)
        self.end_of_inner = self.n_vertices + self.template.n_corners * len(self.with_inner)
        self._corner_step = np.array(
            [np.ravel_multi_index(tuple(c), self.vertex_shape) for c in CORNERS[grid.dim]]
        )
        self._added: list[FloatArray] = []
        self.layers: list[IntArray] = []
        self._moved: list[tuple[IndexArray, FloatArray]] = []
        self.n_points = self.end_of_inner
        self._elements: list[IndexArray] = []
        self._owners: list[IndexArray] = []
        self._kinds: list[NDArray[np.int8]] = []
        self._materials: list[NDArray[np.int32]] = []

    def outer(self, cells: IntArray) -> IndexArray:
        """Return the grid vertices at the corners of flat cells, shape (m, 2**dim).

        Parameters
        ----------
        cells
            Flat cells, shape (m,).
        """
        corners = np.empty((len(cells), len(self._corner_step)), dtype=self.index)
        _corners(cells, np.array(self.grid.shape), self._corner_step, corners)
        return corners

    def inner(self, cells: IntArray) -> IndexArray:
        """Return the corners of the inner cells of flat cells, shape (m, 2**dim).

        Parameters
        ----------
        cells
            Flat cells that have an inner cell, shape (m,).
        """
        n_corners = self.template.n_corners
        first = self.n_vertices + n_corners * np.searchsorted(self.with_inner, cells)
        return (first[:, None] + np.arange(n_corners)).astype(self.index)

    def place_of_cells(self, cells: IntArray) -> IntArray:
        """Return the lowest corners of flat cells, in cells from the origin, shape (m, dim).

        Parameters
        ----------
        cells
            Flat cells, shape (m,).
        """
        index = np.unravel_index(cells, self.grid.shape)
        return np.asarray(np.stack(index, axis=1) + self._first, dtype=np.int64)

    def place_of_vertices(self, vertices: IntArray) -> IntArray:
        """Return the places of flat grid vertices, in cells from the origin, shape (m, dim).

        Parameters
        ----------
        vertices
            Flat grid vertices, shape (m,).
        """
        index = np.unravel_index(vertices, self.vertex_shape)
        return np.asarray(np.stack(index, axis=1) + self._first, dtype=np.int64)

    def add_points(self, positions: FloatArray, layers: IntArray | None = None) -> IndexArray:
        """Add points at given positions and return their numbers.

        Parameters
        ----------
        positions
            Positions in cells from the grid's origin, shape (m, dim).
        layers
            In space, the layer of cells along x with which each point is numbered, ascending,
            shape (m,).

        Returns
        -------
        numbers
            Shape (m,).
        """
        numbers = (self.n_points + np.arange(len(positions))).astype(self.index)
        self._added.append(positions)
        if layers is not None:
            self.layers.append(layers)
        self.n_points += len(positions)
        return numbers

    def move(self, numbers: IndexArray, positions: FloatArray) -> None:
        """Give points other positions.

        Parameters
        ----------
        numbers
            Numbers of the points, shape (m,).
        positions
            Positions in cells from the grid's origin, shape (m, dim).
        """
        self._moved.append((numbers, positions))

    def add(
        self,
        elements: IndexArray,
        owners: IntArray,
        kind: int | NDArray[np.integer],
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
            if not stays.all():
                elements, owners = elements[stays], owners[stays]
                kinds, material = kinds[stays], material[stays]
        self._elements.append(elements.astype(self.index, copy=False))
        self._owners.append(owners.astype(self.index))
        self._kinds.append(kinds.astype(np.int8))
        self._materials.append(material.astype(np.int32))

    def collect(self) -> Collected:
        """Return all elements in the order of their cells, and forget them here."""
        owner = np.concatenate(self._owners)
        order = np.argsort(owner, kind="stable").astype(self.index)
        found = Collected(
            np.concatenate(self._elements),
            order,
            owner[order],
            np.concatenate(self._kinds)[order],
            np.concatenate(self._materials)[order],
        )
        for chunks in (self._owners, self._materials, self._kinds, self._elements):
            chunks.clear()
        return found

    def finish(self, name: str) -> Emitted:
        """Return the mesh of all elements, in the order of their cells.

        Parameters
        ----------
        name
            The model, for messages.

        """
        elements, order, owner, kind, material = self.collect()
        number = np.full(self.n_points, -1, dtype=self.index)
        used = _number_used(elements, number)
        cells = np.empty_like(elements)
        _renumber(elements, order, number, cells)
        del elements, number, order
        mesh = VolumeMesh(
            self.place(used),
            cells,
            kind=kind,
            grid_cell=owner,
            name=name,
            unit=self.grid.unit,
            sides=self.grid.frame.sides,
        )
        return Emitted(mesh=mesh, material=material)

    def place(self, points: IndexArray) -> FloatArray:
        """Return the coordinates of ascending points, in model units, shape (m, dim).

        Parameters
        ----------
        points
            Numbers of points, shape (m,).
        """
        added = np.concatenate([np.empty((0, self.grid.dim)), *self._added])
        found = np.empty((len(points), self.grid.dim))
        for start in range(0, len(points), _AT_A_TIME):
            some = slice(start, start + _AT_A_TIME)
            found[some] = self.grid.to_points(self._positions(points[some], added))
        return found

    def _positions(self, points: IndexArray, placed: FloatArray) -> FloatArray:
        """Return the positions of ascending points, in cells from the grid's origin."""
        bounds = np.searchsorted(points, [self.n_vertices, self.end_of_inner])
        vertices, inner, added = np.split(points, bounds)
        cell, corner = np.divmod(inner - self.n_vertices, self.template.n_corners)
        lowest = self.place_of_cells(self.with_inner[cell])
        found = np.concatenate(
            [
                self.place_of_vertices(vertices),
                lowest + self.template.inner[corner],
                placed[added - self.end_of_inner],
            ]
        )
        for numbers, positions in self._moved:
            rows = np.searchsorted(points, numbers)
            is_used = points[np.minimum(rows, len(points) - 1)] == numbers
            found[rows[is_used]] = positions[is_used]
        return found


@numba.njit(cache=True)
def _corners(cells, shape, steps, corners):  # type: ignore[no-untyped-def]
    """Write the grid vertices at the corners of flat cells."""
    for row in range(len(cells)):
        rest, lowest, stride = cells[row], 0, 1
        for axis in range(len(shape) - 1, -1, -1):
            lowest += rest % shape[axis] * stride
            rest //= shape[axis]
            stride *= shape[axis] + 1
        for c in range(len(steps)):
            corners[row, c] = lowest + steps[c]


@numba.njit(cache=True)
def _number_used(elements, number):  # type: ignore[no-untyped-def]
    """Give used points consecutive numbers, and return these points; `number` has -1 at first."""
    for element in elements:
        for point in element:
            number[point] = 0
    n_used = 0
    for point in range(len(number)):
        if number[point] == 0:
            number[point] = n_used
            n_used += 1
    used = np.empty(n_used, dtype=number.dtype)
    for point in range(len(number)):
        if number[point] >= 0:
            used[number[point]] = point
    return used


@numba.njit(cache=True)
def _renumber(elements, order, number, cells):  # type: ignore[no-untyped-def]
    """Write elements in an order, with other numbers of their points."""
    for i in range(len(order)):
        for c in range(elements.shape[1]):
            cells[i, c] = number[elements[order[i], c]]
