r"""Build bridges that join an archipelago along edges whose sub-cells are interior.

Paper: Anti-aliasing, "for resolving archipelagos"; algorithm 5.  There are two kinds of bridge:

* A *path* of grid edges runs through empty cells from one component to another; all its edges, and
  the vertices between them, are interior (``F >= threshold``).
* A *pinch* was separated because its own sub-cell is exterior, although its two edges beside one of
  its empty cells are interior; now its cluster connects instead.

Pinches are joined first, then paths in order of length.  A path needs room: the cells that it
touches must be empty and free of other templates, and at each end it attaches to a side of a kept
cell whose vertices are not separated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from tusqh.antialias.clusters import CONNECT, SEPARATE, label_clusters
from tusqh.grid import BackgroundGrid, BoolArray, FloatArray, IntArray
from tusqh.grid.neighbourhoods import around_vertices
from tusqh.settings.policy import BridgeMode
from tusqh.topology.effective import label_components

if TYPE_CHECKING:
    from scipy.cluster.hierarchy import DisjointSet

#: Columns of the table of bridges.
BRIDGE_COLUMNS = [
    "kind",
    "edges",
    "length",
    "cells_a",
    "cells_b",
    "x_a",
    "y_a",
    "x_b",
    "y_b",
    "status",
]

ACCEPTED = "accepted"
NO_ROOM = "not joined: no room for templates"
REJECTED = "not joined: the mesh disagreed"


@dataclass(frozen=True)
class Bridge:
    """A path of grid edges between two components.

    Parameters
    ----------
    vertices
        Grid vertices of the path in order, shape (m, 2).
    cells
        Flat indices of a kept cell of each component that it joins, shape (2,).
    row
        Its row in the table of bridges.
    """

    vertices: IntArray
    cells: IntArray
    row: int


@dataclass(frozen=True)
class _Edges:
    """Interior grid edges between two empty cells, given by flat vertices and cells."""

    ends: IntArray
    beside: IntArray
    attaches: BoolArray


def join_components(
    kept: BoolArray,
    at_vertex: NDArray[np.int8],
    values: FloatArray,
    grid: BackgroundGrid,
    *,
    threshold: float,
    mode: BridgeMode,
) -> tuple[NDArray[np.int8], list[Bridge], pd.DataFrame]:
    """Return pinch decisions and paths that join components of a 2D grid, and a table of bridges.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    at_vertex
        Decision at every pinch, shape ``n + 1``.
    values
        Fractions on the doubled grid, shape ``2 n + 1``.
    grid
        The background grid.
    threshold
        Volume-fraction threshold, dimensionless.
    mode
        `forest` joins only components that are still separate, so no hole appears; `all` follows
        every path between components that were different at the start.

    Returns
    -------
    at_vertex
        Decisions with the joined pinches connected.
    bridges
        The paths.
    table
        One row per bridge: kind, number of edges, length (model units), cells of the two
        components, end points, and whether it was accepted.
    """
    if mode == "none" or kept.ndim != 2:
        return at_vertex, [], pd.DataFrame(columns=BRIDGE_COLUMNS)
    labels, n_components = label_components(kept, at_vertex == CONNECT)
    joiner = _Joiner(labels, n_components, grid, joins_all=mode == "all")
    at_vertex = _join_pinches(joiner, kept, at_vertex, values >= threshold)
    edges = _interior_edges(kept, at_vertex, values >= threshold)
    bridges = _join_paths(joiner, kept, at_vertex, edges)
    _report_unjoined(joiner, edges)
    return at_vertex, bridges, pd.DataFrame(joiner.rows, columns=BRIDGE_COLUMNS)


class _Joiner:
    """The components, the record of which are already joined, and the rows of the table."""

    def __init__(
        self, labels: IntArray, n_components: int, grid: BackgroundGrid, *, joins_all: bool
    ) -> None:
        self.label = np.pad(labels, 1)
        self.n_cells = np.bincount(labels.ravel(), minlength=n_components + 1)
        self.joined = _disjoint_set(range(n_components + 1))
        self.grid = grid
        self.joins_all = joins_all
        self.rows: list[dict[str, object]] = []

    def component_at_vertex(self) -> IntArray:
        """Return the component of the kept cells around every flat vertex, 0 if there is none."""
        around = around_vertices(self.label[1:-1, 1:-1])
        return np.asarray(np.maximum.reduce(around).ravel(), dtype=np.int64)

    def may_join(self, a: int, b: int) -> bool:
        """Return whether a bridge between two components is wanted."""
        return a != b and (self.joins_all or not self.joined.connected(a, b))

    def may_join_all(self, pairs: list[tuple[int, int]]) -> bool:
        """Return whether bridges are wanted between all these pairs if built one after another."""
        if self.joins_all:
            return all(a != b for a, b in pairs)
        together = _disjoint_set({self.joined[label] for pair in pairs for label in pair})
        return all(together.merge(self.joined[a], self.joined[b]) for a, b in pairs)

    def add_row(self, kind: str, a: int, b: int, vertices: IntArray, status: str) -> int:
        """Add a bridge to the table and return its row."""
        ends = self.grid.to_points(vertices[[0, -1]])
        n_edges = len(vertices) - 1
        numbers = [n_edges, n_edges * self.grid.cell_size, self.n_cells[a], self.n_cells[b]]
        row = [kind, *numbers, *ends.ravel().tolist(), status]
        self.rows.append(dict(zip(BRIDGE_COLUMNS, row, strict=True)))
        return len(self.rows) - 1


def _disjoint_set(items: Iterable[int]) -> DisjointSet:
    """Return the initial sets of union-find, one for each item."""
    # Import here, because few meshes have bridges and the import takes 0.1 s.
    from scipy.cluster.hierarchy import DisjointSet

    return DisjointSet(items)


def _join_pinches(
    joiner: _Joiner, kept: BoolArray, at_vertex: NDArray[np.int8], is_interior: BoolArray
) -> NDArray[np.int8]:
    """Connect the clusters of separated pinches with two interior edges around an empty cell."""
    edge = np.pad(is_interior, 1)
    left, right = edge[:-2:2, 1:-1:2], edge[2::2, 1:-1:2]
    down, up = edge[1:-1:2, :-2:2], edge[1:-1:2, 2::2]
    lower_left, lower_right, upper_left, upper_right = (~k for k in around_vertices(kept))
    around_empty = (
        (lower_left & left & down)
        | (lower_right & right & down)
        | (upper_left & left & up)
        | (upper_right & right & up)
    )
    clusters, n_clusters = label_clusters(at_vertex != 0)
    has_way = around_empty & (at_vertex == SEPARATE)
    n_ways = np.bincount(clusters[has_way], minlength=n_clusters + 1)
    size = np.bincount(clusters.ravel(), minlength=n_clusters + 1)
    at_vertex = at_vertex.copy()
    for cluster in np.flatnonzero((n_ways == size) & (size > 0)):
        places = np.argwhere(clusters == cluster)
        around = [joiner.label[i : i + 2, j : j + 2].ravel() for i, j in places]
        pairs = [(int(labels.max()), int(labels[labels > 0].min())) for labels in around]
        if joiner.may_join_all(pairs):
            for place, (a, b) in zip(places, pairs, strict=True):
                joiner.joined.merge(a, b)
                joiner.add_row("pinch", a, b, place[None], ACCEPTED)
            at_vertex[clusters == cluster] = CONNECT
    return at_vertex


def _interior_edges(kept: BoolArray, at_vertex: NDArray[np.int8], is_interior: BoolArray) -> _Edges:
    """Return the interior edges between two empty cells of the grid, and where they attach."""
    vertex = np.arange(at_vertex.size, dtype=np.int64).reshape(at_vertex.shape)
    cell = np.arange(kept.size, dtype=np.int64).reshape(kept.shape)
    padded, is_separated = np.pad(kept, 1), at_vertex == SEPARATE
    # A path may pass only interior vertices, but it may end at any vertex of a kept cell.
    touches = np.logical_or.reduce(around_vertices(kept))
    usable = is_interior[::2, ::2] | touches
    ends, beside, attaches = [], [], []
    for axis in range(2):
        # Move the axis first, and leave out edges on the border of the grid.
        interior = np.moveaxis(is_interior, axis, 0)[1::2, 2:-2:2]
        empty = ~np.moveaxis(kept, axis, 0)
        at_ends = np.moveaxis(usable, axis, 0)[:, 1:-1]
        mask = interior & empty[:, :-1] & empty[:, 1:] & at_ends[:-1] & at_ends[1:]
        vertices, cells = np.moveaxis(vertex, axis, 0), np.moveaxis(cell, axis, 0)
        ends.append(np.stack([vertices[:-1, 1:-1][mask], vertices[1:, 1:-1][mask]], axis=1))
        beside.append(np.stack([cells[:, :-1][mask], cells[:, 1:][mask]], axis=1))
        # A kept cell behind an end offers its side if no vertex of the side is separated.
        behind, taken = np.moveaxis(padded, axis, 0), np.moveaxis(is_separated, axis, 0)
        free = ~taken[:, :-1] & ~taken[:, 1:]
        offers = [
            (c[:, 1:-2] & f[:, :-1]) | (c[:, 2:-1] & f[:, 1:])
            for c, f in ((behind[:-2], free[:-1]), (behind[2:], free[1:]))
        ]
        attaches.append(np.stack([offer[mask] for offer in offers], axis=1))
    return _Edges(np.concatenate(ends), np.concatenate(beside), np.concatenate(attaches))


def _join_paths(
    joiner: _Joiner, kept: BoolArray, at_vertex: NDArray[np.int8], edges: _Edges
) -> list[Bridge]:
    """Accept paths that share no cells, the shortest first."""
    around_vertex = _cells_at_vertices(kept.shape)
    is_taken = np.zeros(kept.size + 1, dtype=bool)  # The last entry is outside the grid.
    is_taken[around_vertex[at_vertex.ravel() == CONNECT].ravel()] = True
    component = joiner.component_at_vertex()
    is_end = component > 0
    bridges: list[Bridge] = []
    while True:
        is_free = ~is_taken[edges.beside].any(axis=1)
        is_open = is_end | ~is_taken[around_vertex].any(axis=1)
        usable = is_free & is_open[edges.ends].all(axis=1)
        usable &= (edges.attaches | ~is_end[edges.ends]).all(axis=1)
        path = _shortest_path(component, edges.ends[usable], joiner.may_join)
        if path is None:
            return bridges
        a, b = component[path[[0, -1]]]
        vertices = np.stack(np.unravel_index(path, at_vertex.shape), axis=1)
        row = joiner.add_row("path", int(a), int(b), vertices, ACCEPTED)
        joiner.joined.merge(int(a), int(b))
        at_ends = around_vertex[path[[0, -1]]]
        cells = np.array([c[c < kept.size][kept.ravel()[c[c < kept.size]]][0] for c in at_ends])
        bridges.append(Bridge(vertices, cells, row))
        inner = around_vertex[path[1:-1]]
        steps = np.sort(np.stack([path[:-1], path[1:]], axis=1), axis=1)
        on_path = (edges.ends[:, None] == steps[None]).all(axis=2).any(axis=1)
        is_taken[inner.ravel()] = is_taken[edges.beside[on_path].ravel()] = True


def _shortest_path(
    component_at_vertex: IntArray, ends: IntArray, may_join: Callable[[int, int], bool]
) -> IntArray | None:
    """Return the flat vertices of a shortest wanted path along edges, or None."""
    nodes, compact = np.unique(ends, return_inverse=True)
    compact = compact.reshape(-1, 2)
    component = component_at_vertex[nodes]
    sources = np.flatnonzero(component)
    if len(sources) < 2:
        return None
    graph = coo_array((np.ones(len(compact)), tuple(compact.T)), shape=(len(nodes),) * 2).tocsr()
    distance, before, source = dijkstra(
        graph,
        directed=False,
        indices=sources,
        unweighted=True,
        min_only=True,
        return_predecessors=True,
    )
    reached = compact[np.isfinite(distance[compact]).all(axis=1)]
    a, b = component[source[reached]].T
    length = distance[reached].sum(axis=1) + 1
    for k in np.argsort(length, kind="stable"):
        if may_join(int(a[k]), int(b[k])):
            low, high = ([int(node)] for node in reached[k])
            for walk in (low, high):
                while before[walk[-1]] >= 0:
                    walk.append(int(before[walk[-1]]))
            return np.asarray(nodes[low[::-1] + high], dtype=np.int64)
    return None


def _report_unjoined(joiner: _Joiner, edges: _Edges) -> None:
    """Add a row for interior paths between components that stay separate."""
    component = joiner.component_at_vertex()

    def is_separate(a: int, b: int) -> bool:
        return not joiner.joined.connected(a, b)

    while (path := _shortest_path(component, edges.ends, is_separate)) is not None:
        a, b = (int(c) for c in component[path[[0, -1]]])
        vertices = np.stack(np.unravel_index(path, np.add(joiner.grid.shape, 1)), axis=1)
        joiner.add_row("path", a, b, vertices, NO_ROOM)
        joiner.joined.merge(a, b)


def _cells_at_vertices(shape: tuple[int, ...]) -> IntArray:
    """Return the flat cells around every flat vertex, shape (n_vertices, 4).

    Cells outside the grid have the index ``n_cells``.
    """
    n_cells = int(np.prod(shape))
    from_end = np.arange(n_cells).reshape(shape) - n_cells  # 0 outside the grid.
    return np.stack([cells.ravel() for cells in around_vertices(from_end)], axis=1) + n_cells
