"""Measure every region of a mesh alone, all in one pass.

The regions are separated: a point is copied for each region at it, so that facets between two
regions become boundary.  Every count of the separated mesh is then taken by region, which gives the
same numbers as meshes of the single regions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numba
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.grid import IntArray
from tusqh.meshes.element_mesh import ElementMesh
from tusqh.meshes.facets import HEX_EDGES, Facets, find_facets
from tusqh.meshes.manifold import find_non_manifold_points
from tusqh.meshes.measure import Measurement
from tusqh.topology.betti_numbers import BettiNumbers

#: A function that counts entries by region.
Count = Callable[[IntArray], IntArray]


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
    facets = find_facets(cells)

    def count(regions: IntArray) -> IntArray:
        return np.bincount(regions, minlength=n_regions).astype(np.int64)

    volumes = np.bincount(region, weights=mesh.volumes, minlength=n_regions)
    smallest = np.ones(n_regions)
    np.minimum.at(smallest, region, mesh.jacobians.scaled)
    bad = count(of_point[find_non_manifold_points(facets)])
    n_cells = count(region)
    euler = _by_euler(cells, facets, of_point, count)
    boundary = _by_boundary(facets, region, of_point, count)
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


def _by_euler(cells: IntArray, facets: Facets, of_point: IntArray, count: Count) -> IntArray:
    """Return Betti numbers of all regions as `tusqh.meshes.betti.betti_by_euler` does."""
    betti_0 = count(of_point[_first_of_components(cells, len(of_point))])
    n_facets = count(of_point[_first_rows(facets)])
    n_cells = count(of_point[cells[:, 0]])
    n_points = count(of_point)
    if cells.shape[1] == 4:
        betti_1 = betti_0 - (n_points - n_facets + n_cells)
        return np.stack([betti_0, betti_1, 0 * betti_0], axis=1)
    n_edges = count(of_point[_edge_points(cells, len(of_point))])
    surfaces = count(of_point[_first_of_components(facets.boundary, len(of_point))])
    betti_2 = surfaces - betti_0
    betti_1 = betti_0 + betti_2 - (n_points - n_edges + n_facets - n_cells)
    return np.stack([betti_0, betti_1, betti_2], axis=1)


def _by_boundary(facets: Facets, region: IntArray, of_point: IntArray, count: Count) -> IntArray:
    """Return Betti numbers of all regions as `tusqh.meshes.betti.betti_by_boundary` does."""
    betti_0 = count(region[_first_by_facets(facets, len(region))])
    boundary = facets.boundary
    if boundary.shape[1] == 2:
        loops = count(of_point[_first_of_components(boundary, len(of_point))])
        return np.stack([betti_0, loops - betti_0, 0 * betti_0], axis=1)
    sides = facets.boundary_edges
    of_face = of_point[boundary[:, 0]]
    surfaces = count(of_face[_first_by_facets(sides, len(boundary))])
    n_edges = count(of_point[_first_rows(sides)])
    euler = count(of_point[np.unique(boundary)]) - n_edges + count(of_face)
    return np.stack([betti_0, surfaces - euler // 2, surfaces - betti_0], axis=1)


def _first_rows(facets: Facets) -> IntArray:
    """Return a point of every distinct facet."""
    first = np.empty(facets.n_unique, dtype=np.int64)
    first[facets.unique] = facets.corners[:, 0]
    return first


def _edge_points(cells: IntArray, n_points: int) -> IntArray:
    """Return a point of every distinct edge of hexes."""
    ends = [(cells[:, a], cells[:, b]) for a, b in HEX_EDGES.tolist()]
    keys = np.concatenate([np.minimum(a, b) * n_points + np.maximum(a, b) for a, b in ends])
    keys.sort()
    first: IntArray = keys[np.append(True, keys[1:] != keys[:-1])] // n_points
    return first


def _first_of_components(groups: IntArray, n: int) -> IntArray:
    """Return one entry of every component of rows; rows that share an entry are joined."""
    first = np.repeat(groups[:, 0], groups.shape[1] - 1)
    graph = coo_array((np.ones(len(first), dtype=bool), (first, groups[:, 1:].ravel())), (n, n))
    labels = connected_components(graph, directed=False)[1]
    is_used = np.zeros(n, dtype=bool)
    is_used[groups] = True
    used = np.flatnonzero(is_used)
    return np.asarray(used[np.unique(labels[used], return_index=True)[1]])


def _first_by_facets(facets: Facets, n_cells: int) -> IntArray:
    """Return one element of every component of elements that share facets."""
    order = np.argsort(facets.unique, kind="stable")
    same = facets.unique[order[1:]] == facets.unique[order[:-1]]
    pairs = (facets.cell[order[:-1]][same], facets.cell[order[1:]][same])
    graph = coo_array((np.ones(len(pairs[0]), dtype=bool), pairs), shape=(n_cells, n_cells))
    labels = connected_components(graph, directed=False)[1]
    return np.unique(labels, return_index=True)[1]
