"""Measure every region of a mesh alone, all in one pass.

The regions are separated: a point is copied for each region at it, so that facets between two
regions become boundary.  Every count of the separated mesh is then taken by region, which gives the
same numbers as meshes of the single regions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid import IntArray
from tusqh.meshes.element_mesh import ElementMesh
from tusqh.meshes.facets import HEX_EDGES, Facets, find_facets
from tusqh.meshes.manifold import find_non_manifold_points
from tusqh.meshes.measure import Measurement
from tusqh.meshes.numbering import number_rows
from tusqh.topology.betti_numbers import BettiNumbers


@dataclass(frozen=True)
class RegionMeasurement:
    """Properties of the elements of one region, measured as a mesh of their own.

    Parameters
    ----------
    n_cells
        Number of elements.
    volume
        Area or volume of all elements, model units**dim.
    smallest_scaled_jacobian
        The smallest scaled Jacobian of all corners.
    n_non_manifold
        Number of boundary points at which the boundary is not a manifold.
    by_euler, by_boundary
        Betti numbers by two methods, see `tusqh.meshes.betti`.
    """

    n_cells: int
    volume: float
    smallest_scaled_jacobian: float
    n_non_manifold: int
    by_euler: BettiNumbers
    by_boundary: BettiNumbers

    @classmethod
    def of(cls, measured: Measurement) -> RegionMeasurement:
        """Return the same properties of a whole mesh.

        Parameters
        ----------
        measured
            Its measurement.
        """
        return cls(
            measured.mesh.n_cells,
            measured.volume,
            measured.smallest_scaled_jacobian,
            measured.n_non_manifold,
            measured.by_euler,
            measured.by_boundary,
        )

    def has_topology(self, predicted: BettiNumbers) -> bool:
        """Return whether both methods measure the predicted Betti numbers.

        Parameters
        ----------
        predicted
            The Betti numbers predicted before meshing.
        """
        return self.by_euler == self.by_boundary == predicted


def measure_regions(mesh: ElementMesh, region: IntArray, n_regions: int) -> list[RegionMeasurement]:
    """Return the measurement of every region of a mesh.

    Parameters
    ----------
    mesh
        The mesh.
    region
        Region of every element, shape (m,).
    n_regions
        Number of regions.

    Examples
    --------
    Of four squares in a row, the first and the third belong to one region:

    >>> from tusqh.meshes.volume_mesh import VolumeMesh
    >>> points = np.array([[x, y] for x in range(5) for y in range(2)], dtype=float)
    >>> squares = 2 * np.arange(4)[:, None] + [0, 2, 3, 1]
    >>> row = VolumeMesh.from_arrays(points, squares)
    >>> found = measure_regions(row, np.array([0, 1, 0, 1]), 2)
    >>> [(str(part.by_euler), part.volume) for part in found]
    [('(2, 0, 0)', 2.0), ('(2, 0, 0)', 2.0)]
    """
    cells, of_point = separate(mesh.cells, region)
    facets, regions = find_facets(cells), _Regions(region, of_point, n_regions)
    volumes = np.bincount(region, weights=mesh.volumes, minlength=n_regions)
    smallest = np.ones(n_regions)
    np.minimum.at(smallest, region, mesh.jacobians.scaled)
    bad = regions.count(of_point[find_non_manifold_points(facets)])
    n_cells = regions.count(region)
    euler = _by_euler(cells, facets, regions)
    boundary = _by_boundary(facets, regions)
    return [
        RegionMeasurement(
            n_cells=int(n_cells[k]),
            volume=float(volumes[k]),
            smallest_scaled_jacobian=float(smallest[k]),
            n_non_manifold=int(bad[k]),
            by_euler=BettiNumbers(*(int(n) for n in euler[k])),
            by_boundary=BettiNumbers(*(int(n) for n in boundary[k])),
        )
        for k in range(n_regions)
    ]


def separate(cells: IntArray, region: IntArray) -> tuple[IntArray, IntArray]:
    """Return elements with a copy of every point for each region at it, and the copies' regions.

    Parameters
    ----------
    cells
        Corners of every element, shape (m, 2**dim).
    region
        Region of every element, shape (m,).

    Returns
    -------
    cells
        Corners by number of the copies, shape (m, 2**dim).
    of_point
        Region of every copy, shape (n_copies,).

    Examples
    --------
    >>> cells, of_point = separate(np.array([[0, 2, 3, 1], [2, 4, 5, 3]]), np.array([7, 8]))
    >>> cells.tolist(), of_point.tolist()
    ([[0, 1, 2, 3], [4, 5, 6, 7]], [7, 7, 7, 7, 8, 8, 8, 8])
    """
    separated = np.empty(cells.shape, dtype=np.int64)
    of_point = _separate(cells, region.astype(np.int64), int(cells.max(initial=-1)) + 1, separated)
    return separated, np.asarray(of_point)


@numba.njit(cache=True)
def _separate(cells, region, n_points, separated):  # type: ignore[no-untyped-def]
    """Fill in the copies at corners; those of a point are a linked list from its last one."""
    last = np.full(n_points, -1, dtype=np.int64)
    before = np.empty(cells.size, dtype=np.int64)
    of_copy = np.empty(cells.size, dtype=np.int64)
    n = 0
    for e in range(len(cells)):
        for c in range(cells.shape[1]):
            point = cells[e, c]
            copy = last[point]
            while copy >= 0 and of_copy[copy] != region[e]:
                copy = before[copy]
            if copy < 0:
                copy = n
                before[copy], of_copy[copy], last[point] = last[point], region[e], copy
                n += 1
            separated[e, c] = copy
    return of_copy[:n].copy()


def _by_euler(cells: IntArray, facets: Facets, regions: _Regions) -> IntArray:
    """Return Betti numbers of all regions as `tusqh.meshes.betti.betti_by_euler` does."""
    betti_0 = regions.count_components(cells)
    n_facets = regions.count_parts(facets.unique, facets.n_unique)
    n_points, n_cells = regions.count(regions.of_point), regions.count(regions.of_cell)
    if cells.shape[1] == 4:
        betti_1 = betti_0 - (n_points - n_facets + n_cells)
        return np.stack([betti_0, betti_1, 0 * betti_0], axis=1)
    n_edges = regions.count_parts(*number_rows(cells, HEX_EDGES))
    betti_2 = regions.count_components(facets.boundary) - betti_0
    betti_1 = betti_0 + betti_2 - (n_points - n_edges + n_facets - n_cells)
    return np.stack([betti_0, betti_1, betti_2], axis=1)


def _by_boundary(facets: Facets, regions: _Regions) -> IntArray:
    """Return Betti numbers of all regions as `tusqh.meshes.betti.betti_by_boundary` does."""
    betti_0 = regions.count_joined(facets)
    boundary = facets.boundary
    if boundary.shape[1] == 2:
        loops = regions.count_components(boundary)
        return np.stack([betti_0, loops - betti_0, 0 * betti_0], axis=1)
    of_face = replace(regions, of_cell=regions.of_point[boundary[:, 0]])
    surfaces = of_face.count_joined(facets.boundary_edges)
    n_edges = of_face.count_parts(facets.boundary_edges.unique, facets.boundary_edges.n_unique)
    n_points = regions.count(regions.of_point[np.unique(boundary)])
    euler = n_points - n_edges + regions.count(of_face.of_cell)
    return np.stack([betti_0, surfaces - euler // 2, surfaces - betti_0], axis=1)


@dataclass(frozen=True)
class _Regions:
    """Counts by region of a separated mesh.

    Parameters
    ----------
    of_cell, of_point
        Region of every element and of every point.
    n
        Number of regions.
    """

    of_cell: IntArray
    of_point: IntArray
    n: int

    def count(self, regions: IntArray) -> IntArray:
        """Return how often every region occurs."""
        return np.bincount(regions, minlength=self.n).astype(np.int64)

    def count_parts(self, numbers: NDArray[np.signedinteger], n_parts: int) -> IntArray:
        """Return the number of different parts of elements, which `number_rows` numbered."""
        of_part = np.empty(n_parts, dtype=np.int64)
        of_part[numbers] = np.repeat(self.of_cell, len(numbers) // max(len(self.of_cell), 1))
        return self.count(of_part)

    def count_components(self, groups: IntArray) -> IntArray:
        """Return the number of components of rows of points; rows that share one are joined."""
        parent = np.arange(len(self.of_point), dtype=np.int64)
        is_used = np.zeros(len(parent), dtype=np.bool_)
        _join_rows(groups, parent, is_used)
        is_first = is_used & (parent == np.arange(len(parent)))
        return self.count(self.of_point[is_first])

    def count_joined(self, facets: Facets) -> IntArray:
        """Return the number of components of elements that share facets."""
        parent = np.arange(len(self.of_cell), dtype=np.int64)
        holder = np.full(facets.n_unique, -1, dtype=np.int64)
        _join_holders(facets.unique, len(facets.local), holder, parent)
        return self.count(self.of_cell[parent == np.arange(len(parent))])


@numba.njit(cache=True)
def _root(parent, a):  # type: ignore[no-untyped-def]
    while parent[a] != a:
        parent[a] = parent[parent[a]]
        a = parent[a]
    return a


@numba.njit(cache=True)
def _join_rows(groups, parent, is_used):  # type: ignore[no-untyped-def]
    """Join the entries of every row, and mark those that occur."""
    for i in range(len(groups)):
        a = _root(parent, groups[i, 0])
        is_used[groups[i, 0]] = True
        for c in range(1, groups.shape[1]):
            is_used[groups[i, c]] = True
            b = _root(parent, groups[i, c])
            # The lower entry is the root; both are used.
            if b < a:
                a, b = b, a
            parent[b] = a


@numba.njit(cache=True)
def _join_holders(numbers, n_local, holder, parent):  # type: ignore[no-untyped-def]
    """Join the elements that hold the same part."""
    for row in range(len(numbers)):
        element, part = row // n_local, numbers[row]
        if holder[part] < 0:
            holder[part] = element
        else:
            a, b = _root(parent, holder[part]), _root(parent, element)
            parent[max(a, b)] = min(a, b)
