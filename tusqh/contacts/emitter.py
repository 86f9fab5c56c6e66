"""The emitter, which numbers the points of templates, collects elements, and makes the mesh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.templates import TEMPLATES
from tusqh.grid.arrays import BoolArray, FloatArray, IntArray
from tusqh.grid.background import BackgroundGrid
from tusqh.grid.numbering import CORNERS
from tusqh.meshes.volume_mesh import VolumeMesh


class Emitted(NamedTuple):
    """A mesh with the grid vertices of its points and the materials of its elements.

    Parameters
    ----------
    mesh
        The mesh.
    grid_vertex
        Flat grid vertex of every point of the mesh, -1 for other points, shape (n,).
    material
        Material of every element, shape (m,).
    """

    mesh: VolumeMesh
    grid_vertex: IntArray
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
    """

    def __init__(self, grid: BackgroundGrid, has_inner: BoolArray) -> None:
        self.grid = grid
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
        self._elements.append(elements)
        self._owners.append(owners)
        each = np.zeros(len(elements), dtype=np.int64)
        self._kinds.append(each + kind)
        self._materials.append(each + materials)

    def add_cells(self, cells: BoolArray, kind: int) -> None:
        """Add whole cells, shape n, as elements of one kind.

        Parameters
        ----------
        cells
            Cells, shape n.
        kind
            One of the kinds of `tusqh.meshes.volume_mesh`.
        """
        flat = np.flatnonzero(cells)
        self.add(self.outer(flat), flat, kind)

    def add_inner_cells(self, cells: BoolArray, kind: int) -> None:
        """Add the inner cells of cells, shape n, as elements of one kind.

        Parameters
        ----------
        cells
            Cells that have an inner cell, shape n.
        kind
            One of the kinds of `tusqh.meshes.volume_mesh`.
        """
        flat = np.flatnonzero(cells)
        self.add(self.inner(flat), flat, kind)

    def add_frusta(self, face: int, cells: BoolArray, kind: int) -> None:
        """Add the frusta at one face of cells, shape n, as elements of one kind.

        Parameters
        ----------
        face
            Number of the face, see `tusqh.grid.numbering.FACES`.
        cells
            Cells that have an inner cell, shape n.
        kind
            One of the kinds of `tusqh.meshes.volume_mesh`.
        """
        flat = np.flatnonzero(cells)
        corners = np.concatenate([self.outer(flat), self.inner(flat)], axis=1)
        self.add(corners[:, self.template.frusta[face]], flat, kind)

    def finish(self, name: str) -> Emitted:
        """Return the mesh of all elements, in the order of their cells.

        Parameters
        ----------
        name
            The model, for messages.

        """
        owner = np.concatenate(self._owners)
        order = np.argsort(owner, kind="stable")
        elements = np.concatenate(self._elements)[order]
        is_used = np.zeros(self._n_points, dtype=bool)
        is_used[elements.ravel()] = True
        used = np.flatnonzero(is_used)
        number = np.cumsum(is_used, dtype=np.int64) - 1
        mesh = VolumeMesh(
            points=self.grid.to_points(self._positions(used)),
            cells=number[elements],
            kind=np.concatenate(self._kinds)[order],
            grid_cell=owner[order],
            name=name,
        )
        return Emitted(
            mesh=mesh,
            grid_vertex=np.where(used < self.n_vertices, used, -1),
            material=np.concatenate(self._materials)[order],
        )

    def _positions(self, points: IntArray) -> FloatArray:
        """Return the positions of ascending points, in cells from the grid's lowest corner."""
        bounds = np.searchsorted(points, [self.n_vertices, self._end_of_inner])
        vertices, inner, added = np.split(points, bounds)
        cell, corner = np.divmod(inner - self.n_vertices, self.template.n_corners)
        lowest = np.stack(np.unravel_index(self._with_inner[cell], self.grid.shape), axis=1)
        nothing = np.empty((0, self.grid.dim))
        return np.concatenate(
            [
                np.stack(np.unravel_index(vertices, self.vertex_shape), axis=1),
                lowest + self.template.inner[corner],
                np.concatenate([nothing, *self._added])[added - self._end_of_inner],
            ]
        )
