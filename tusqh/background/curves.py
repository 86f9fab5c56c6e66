"""Betti numbers of the listed complex at every threshold, by union-find and counting.

As on a grid, one union-find counts the components of the kept nodes, a second one those of the
others, and the Euler characteristic gives the remaining Betti number.  An edge or vertex never
enters before the highest cell around it, so it joins that cell to each other cell around it, and
only cells are nodes of the union-find.  Each component of the rim is one more empty cell: what is
empty and reaches it is not enclosed.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numba
import numpy as np
import pandas as pd

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.background.node_values import NodeValues, clamp, find_around
from tusqh.grid import FloatArray, IndexArray, IntArray
from tusqh.meshes.facets import HEX_EDGES
from tusqh.sampling.doubled_grid import RESOLUTION, Multiples
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.clamping import FULL
from tusqh.topology.curves import combine_counts
from tusqh.topology.persistence import betti_at
from tusqh.topology.union_find import Merges


class Links(NamedTuple):
    """Pairs of cells that are joined from a value on, shape (n,) each.

    Parameters
    ----------
    one, other
        Numbers of the cells; components of the rim follow the cells.
    level
        Value from which they are joined, positive.
    place
        Node that joins them, numbered as in `tusqh.background.node_values.NodeValues.all`.
    """

    one: IndexArray
    other: IndexArray
    level: Multiples
    place: IndexArray


class BackgroundTopology:
    """The topology of the filtration of a background; each property is computed once.

    Parameters
    ----------
    background
        The background.
    values
        Values of its nodes; they are clamped.

    Examples
    --------
    A ring of eight quads around one that is empty has a hole.

    >>> from tusqh.background.makers import make_box
    >>> three = make_box((0.0, 0.0), (3.0, 3.0), (3, 3))
    >>> cells, none = np.full(9, FULL, dtype=np.int32), np.zeros(0, dtype=np.int32)
    >>> cells[4] = 0
    >>> values = NodeValues(cells, none, np.full(16, FULL, dtype=np.int32))
    >>> str(BackgroundTopology(three, values).betti_at(0.5))
    '(1, 1, 0)'
    """

    def __init__(self, background: BackgroundMesh, values: NodeValues) -> None:
        self.background = background
        self.values = clamp(background, values)

    @cached_property
    def curves(self) -> pd.DataFrame:
        """Betti numbers of every plateau, see `tusqh.topology.curves.tabulate_curves`."""
        background = self.background
        euler = count_euler(background, self.values)
        return combine_counts(
            self._levels,
            np.cumsum(euler[::-1])[::-1],
            (self.kept, self.empty),
            dim=background.dim,
            n_outside=background.n_components,
        )

    @cached_property
    def kept(self) -> Merges:
        """Components of the kept nodes."""
        return _merge_all(self.values.cells, _list_links(self.background, self.values))

    @cached_property
    def empty(self) -> Merges:
        """Components of the other nodes and the rim, with values from 1 to `FULL` + 1."""
        values = self.values
        swapped = NodeValues(
            *[
                (FULL + 1 - part).astype(np.int32)
                for part in (values.cells, values.edges, values.vertices)
            ]
        )
        links = _list_links(self.background, swapped)
        rim, n_rims = self.background.rim_of_vertex
        outside = _link_rim(self.background, swapped.cells, rim)
        joined = Links(*[np.concatenate(both) for both in zip(links, outside, strict=True)])
        # The rim is older than every cell, so no cell survives it.
        every = np.append(swapped.cells, np.full(n_rims, FULL + 2, dtype=np.int32))
        return _merge_all(every, joined)

    def betti_at(self, threshold: float) -> BettiNumbers:
        """Return the Betti numbers at a threshold in (0, 1].

        Parameters
        ----------
        threshold
            Volume fraction, dimensionless.
        """
        return betti_at(self.curves, threshold)

    @cached_property
    def _levels(self) -> IntArray:
        """The distinct values of all nodes inside, with 0 and FULL, from high to low."""
        is_there = np.zeros(FULL + 1, dtype=bool)
        is_there[[0, FULL]] = True
        is_there[self.values.all()] = True
        return np.flatnonzero(is_there)[::-1].astype(np.int64)

    @cached_property
    def persistence_by_cell(self) -> tuple[FloatArray, FloatArray]:
        """Persistence of the component that each cell creates, and of the hole or void it fills."""
        found = []
        for merges, never in ((self.kept, 0), (self.empty, 1)):
            lives = np.zeros(self.background.n_cells)
            is_cell = merges.birth_place < self.background.n_cells
            lived = merges.birth - np.maximum(merges.death, never)
            lives[merges.birth_place[is_cell]] = lived[is_cell]
            found.append(lives * RESOLUTION)
        return found[0], found[1]


def count_euler(background: BackgroundMesh, values: NodeValues) -> IntArray:
    """Return the change of the Euler characteristic at every value, shape (`FULL` + 1,).

    Parameters
    ----------
    background
        The background.
    values
        Clamped values of its nodes.
    """
    change = np.zeros(FULL + 1, dtype=np.int64)
    # What lies on the rim has the value 0, and level 0 is never asked for.
    both = background.facet_cells[~background.is_rim_facet]
    if background.dim == 2:
        ends = background.vertices_of_facets[~background.is_rim_facet]
        _count_in_plane(values.cells, values.vertices, background.cells, both, ends, change)
        return change
    edges = background.edges_of_facets[~background.is_rim_facet]
    parts = background.cells, background.edge_of, background.edge_ends
    _count_in_space(values.cells, values.edges, values.vertices, parts, HEX_EDGES, change)
    _count_at_faces(
        values.cells, values.edges, values.vertices, both, edges, background.edge_ends, change
    )
    return change


def _list_links(background: BackgroundMesh, values: NodeValues) -> Links:
    """Return the links through facets, edges and vertices."""
    both = background.facet_cells[~background.is_rim_facet]
    level = values.cells[both]
    lower = np.where(level[:, 0] <= level[:, 1], both[:, 0], both[:, 1])
    found = [Links(both[:, 0], both[:, 1], level.min(axis=1), lower)]
    parts = [(values.edges, background.edge_of, background.n_cells)]
    parts.append((values.vertices, background.cells, background.n_cells + background.n_edges))
    is_rim = (background.is_rim_edge, background.is_rim_vertex)
    for (own, of_cells, first), on_rim in zip(parts, is_rim, strict=True):
        if len(own) == 0:
            continue
        top = find_around(values.cells, of_cells, len(own)).highest
        cell = np.repeat(np.arange(background.n_cells, dtype=np.int32), of_cells.shape[1])
        part = of_cells.ravel()
        use = (top[part] != cell) & ~on_rim[part]
        cell, part = cell[use], part[use]
        joined = np.minimum(values.cells[cell], own[part])
        found.append(Links(cell, top[part], joined, part + first))
    links = Links(*[np.concatenate(column) for column in zip(*found, strict=True)])
    use = links.level > 0
    return Links(*[column[use] for column in links])


def _link_rim(background: BackgroundMesh, cells: Multiples, rim: IntArray) -> Links:
    """Return the links of every cell with a vertex on the rim to that component of the rim."""
    cell, corner = np.nonzero(rim[background.cells] >= 0)
    vertex = background.cells[cell, corner]
    first = background.n_cells + background.n_edges
    return Links(cell, background.n_cells + rim[vertex], cells[cell], first + vertex)


def _merge_all(values: Multiples, links: Links) -> Merges:
    """Return how the components of cells merge, see `tusqh.topology.union_find.Merges`."""
    order = np.argsort(-links.level, kind="stable")
    one, other = (np.asarray(ends, dtype=np.int64) for ends in links[:2])
    found = _merge(values, one, other, links.level, links.place, order)
    return Merges(*found)


@numba.njit(cache=True)
def _root(parent, cell):  # type: ignore[no-untyped-def]
    while parent[cell] != cell:
        parent[cell] = parent[parent[cell]]
        cell = parent[cell]
    return cell


@numba.njit(cache=True)
def _merge(values, one, other, level, place, order):  # type: ignore[no-untyped-def]
    """Return birth, death, birth place and death place of every component."""
    parent = np.arange(len(values))
    found, n = np.empty((4, len(values)), dtype=np.int64), 0
    for k in order:
        a, b = _root(parent, one[k]), _root(parent, other[k])
        if a == b:
            continue
        if values[a] < values[b] or (values[a] == values[b] and a > b):
            a, b = b, a
        parent[b] = a
        if values[b] > level[k]:
            found[0, n], found[1, n], found[2, n], found[3, n] = values[b], level[k], b, place[k]
            n += 1
    for cell in range(len(values)):
        if parent[cell] == cell and values[cell] > 0:
            found[0, n], found[1, n], found[2, n], found[3, n] = values[cell], 0, cell, -1
            n += 1
    return found[:, :n]


@numba.njit(cache=True)
def _count_in_plane(cells, vertices, corners, both, ends, change):  # type: ignore[no-untyped-def]
    """Add all simplices of quads."""
    for value in vertices:
        change[value] += 1
    for cell in range(len(cells)):
        change[cells[cell]] += 1
        for vertex in corners[cell]:
            change[min(cells[cell], vertices[vertex])] -= 1
    for facet in range(len(both)):
        pair = min(cells[both[facet, 0]], cells[both[facet, 1]])
        change[pair] -= 1
        for vertex in ends[facet]:
            change[min(pair, vertices[vertex])] += 1


@numba.njit(cache=True)
def _count_in_space(cells, edges, vertices, parts, local, change):  # type: ignore[no-untyped-def]
    """Add the simplices with at most one hex."""
    corners, edge_of, edge_ends = parts
    for value in vertices:
        change[value] += 1
    for edge in range(len(edges)):
        change[edges[edge]] += 1
        for vertex in edge_ends[edge]:
            change[min(edges[edge], vertices[vertex])] -= 1
    for cell in range(len(cells)):
        change[cells[cell]] += 1
        for vertex in corners[cell]:
            change[min(cells[cell], vertices[vertex])] -= 1
        for k in range(12):
            pair = min(cells[cell], edges[edge_of[cell, k]])
            change[pair] -= 1
            for end in range(2):
                change[min(pair, vertices[corners[cell, local[k, end]]])] += 1


@numba.njit(cache=True)
def _count_at_faces(cells, edges, vertices, both, edges_of, edge_ends, change):  # type: ignore[no-untyped-def]
    """Add the simplices with two hexes; each corner of a face ends two of its edges."""
    for facet in range(len(both)):
        pair = min(cells[both[facet, 0]], cells[both[facet, 1]])
        change[pair] -= 1
        for edge in edges_of[facet]:
            three = min(pair, edges[edge])
            change[three] += 1
            for vertex in edge_ends[edge]:
                change[min(three, vertices[vertex])] -= 1
        for k in range(4):
            here, after = edge_ends[edges_of[facet, k]], edge_ends[edges_of[facet, k - 1]]
            shared = here[0] if here[0] == after[0] or here[0] == after[1] else here[1]
            change[min(pair, vertices[shared])] += 1
