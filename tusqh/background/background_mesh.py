"""A mesh of quads or hexes that is the background, with what its cells share."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property

import numba
import numpy as np

from tusqh.fitting.moving import list_corners
from tusqh.geometry.remark import Remark
from tusqh.grid import BoolArray, FloatArray, IndexArray, IntArray
from tusqh.grid.components import label_components
from tusqh.meshes.element_mesh import ElementMesh
from tusqh.meshes.facets import HEX_EDGES, HEX_FACETS, QUAD_FACETS
from tusqh.meshes.numbering import number_rows


def _edges_of_faces() -> IntArray:
    """Return the local edges of every face of a hex, shape (6, 4)."""
    number = {frozenset(ends): k for k, ends in enumerate(HEX_EDGES.tolist())}
    rows = [[number[frozenset((q[a], q[(a + 1) % 4]))] for a in range(4)] for q in HEX_FACETS]
    return np.array(rows, dtype=np.int64)


#: Local edges of every face of a hex, in the order of `HEX_FACETS`.
FACE_EDGES = _edges_of_faces()


@dataclass(frozen=True)
class BackgroundMesh(ElementMesh):
    """Quads in the plane or hexes in space that take the place of the grid.

    A *facet* is a side of a quad or a face of a hex.  The *rim* is the boundary of the background.
    Facets, edges and vertices on it have no value: nothing lies outside.

    Parameters
    ----------
    points
        Coordinates, shape (n, dim), in the units of the model; every one belongs to a cell.
    cells
        Corners of every cell, shape (m, 2**dim), VTK order, positively oriented.
    name
        The file or model, for messages.
    unit
        Unit of length; empty if it is not known.
    remarks
        What reading left out or changed.

    Examples
    --------
    >>> points = np.array([[x, y] for x in range(3) for y in range(2)], dtype=float)
    >>> two = BackgroundMesh(points, np.array([[0, 2, 3, 1], [2, 4, 5, 3]]))
    >>> two.n_cells, two.facet_cells.tolist()[1], int(two.is_rim_vertex.sum())
    (2, [0, 1], 6)
    """

    points: FloatArray
    cells: IndexArray
    name: str = "background"
    unit: str = ""
    remarks: tuple[Remark, ...] = ()

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the points and cells, in hexadecimal."""
        found = hashlib.sha256(repr((self.points.shape, self.cells.shape)).encode())
        found.update(self.points.astype("<f8").tobytes())
        found.update(self.cells.astype("<i8").tobytes())
        return found.hexdigest()

    @property
    def facet_of(self) -> IndexArray:
        """Number of every facet of every cell, shape (m, number of facets of a cell)."""
        return self.facets.unique.reshape(self.n_cells, -1)

    @cached_property
    def facet_cells(self) -> IndexArray:
        """The two cells at every facet, shape (f, 2); -1 for the second one on the rim."""
        both: IndexArray = np.full((self.facets.n_unique, 2), -1, dtype=self.facets.unique.dtype)
        _list_both(self.facet_of, both)
        return both

    @cached_property
    def is_rim_facet(self) -> BoolArray:
        """Whether each facet lies on the rim, shape (f,)."""
        return np.asarray(self.facet_cells[:, 1] < 0)

    @cached_property
    def is_rim_vertex(self) -> BoolArray:
        """Whether each vertex lies on the rim, shape (n,)."""
        is_on = np.zeros(self.n_points, dtype=bool)
        is_on[self.facets.boundary] = True
        return is_on

    @cached_property
    def rim_of_vertex(self) -> tuple[IntArray, int]:
        """Component of the rim of every vertex, shape (n,), -1 inside; number of components."""
        sides = self.facets.boundary
        k = sides.shape[1] - 1
        first, second = np.repeat(sides[:, 0], k), sides[:, 1:].ravel()
        label, _ = label_components(first, second, self.n_points)
        used, number = np.unique(label[self.is_rim_vertex], return_inverse=True)
        component = np.full(self.n_points, -1, dtype=np.int64)
        component[self.is_rim_vertex] = number.ravel()
        return component, len(used)

    @cached_property
    def n_components(self) -> int:
        """Number of parts of the background that do not touch."""
        both = self.facet_cells[~self.is_rim_facet]
        return label_components(both[:, 0], both[:, 1], self.n_cells)[1]

    @cached_property
    def _edge_numbers(self) -> tuple[IndexArray, int]:
        """Number of every edge of every hex, and how many there are; none in the plane."""
        if self.dim == 2:
            return np.zeros(0, dtype=np.int32), 0
        return number_rows(self.cells, HEX_EDGES)

    @property
    def edge_of(self) -> IndexArray:
        """Number of every edge of every hex, shape (m, 12); shape (m, 0) in the plane."""
        return self._edge_numbers[0].reshape(self.n_cells, -1)

    @property
    def n_edges(self) -> int:
        """Number of edges of hexes; 0 in the plane, where edges are facets."""
        return self._edge_numbers[1]

    @cached_property
    def edge_ends(self) -> IndexArray:
        """The two vertices of every edge of hexes, shape (e, 2)."""
        ends: IndexArray = np.zeros((self.n_edges, 2), dtype=self.cells.dtype)
        if self.dim == 3:
            ends[self.edge_of.ravel()] = self.cells[:, HEX_EDGES].reshape(-1, 2)
        return ends

    @cached_property
    def is_rim_edge(self) -> BoolArray:
        """Whether each edge of hexes lies on the rim, shape (e,)."""
        is_on = np.zeros(self.n_edges, dtype=bool)
        if self.dim == 3:
            is_on[self.edges_of_facets[self.is_rim_facet]] = True
        return is_on

    @cached_property
    def edges_of_facets(self) -> IndexArray:
        """The four edges of every face of hexes, shape (f, 4)."""
        edges: IndexArray = np.empty((self.facets.n_unique, 4), dtype=np.int64)
        edges[self.facet_of.ravel()] = self.edge_of[:, FACE_EDGES].reshape(-1, 4)
        return edges

    @cached_property
    def vertices_of_facets(self) -> IndexArray:
        """The corners of every facet, shape (f, 2**(dim - 1))."""
        corners = self.facets.corners
        found: IndexArray = np.empty((self.facets.n_unique, corners.shape[1]), dtype=np.int64)
        found[self.facets.unique] = corners
        return found

    @cached_property
    def corners_at(self) -> tuple[IntArray, IntArray]:
        """Corners at every vertex, see `tusqh.fitting.moving.list_corners`."""
        return list_corners(self.cells, self.n_points)

    @cached_property
    def shortest_edge(self) -> FloatArray:
        """Length of the shortest edge at every vertex, shape (n,), in model units."""
        local = QUAD_FACETS if self.dim == 2 else HEX_EDGES
        ends = self.cells[:, local].reshape(-1, 2)
        lengths = np.linalg.norm(self.points[ends[:, 0]] - self.points[ends[:, 1]], axis=1)
        shortest = np.full(self.n_points, np.inf)
        for side in range(2):
            np.minimum.at(shortest, ends[:, side], lengths)
        return shortest

    def centre_of(self, cell: int) -> tuple[float, ...]:
        """Return the mean of the corners of a cell, for messages.

        Parameters
        ----------
        cell
            Number of the cell.

        Returns
        -------
        centre
            Coordinates, in model units.
        """
        return tuple(float(f"{x:.6g}") for x in self.points[self.cells[cell]].mean(axis=0))


@numba.njit(cache=True)
def _list_both(facet_of, both):  # type: ignore[no-untyped-def]
    """Write the cells at every facet; only the first two of an overfull one."""
    for cell in range(len(facet_of)):
        for facet in facet_of[cell]:
            if both[facet, 0] < 0:
                both[facet, 0] = cell
            elif both[facet, 1] < 0:
                both[facet, 1] = cell
