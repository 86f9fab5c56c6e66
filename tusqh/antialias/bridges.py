r"""Build bridges that join an archipelago along edges whose sub-cells are interior.

Paper: Anti-aliasing, "for resolving archipelagos"; algorithm 5.  There are two kinds of bridge:

* A *path* of grid edges runs through empty cells from one component to another; all its edges, and
  the vertices between them, are interior (``F >= threshold``).
* A *pinch* was separated because its own sub-cell is exterior, although its two edges beside one of
  its empty cells are interior; now it connects instead.

Pinches are joined first, then paths in order of length.  Every vertex of a path gets a ball, and
both quads of each of its edges belong to the material (see `tusqh.contacts.planar`)::

    kept |  \___________/  | kept      v: ends of the path; the strip is half a cell wide
    -----v-----path------v-----
    kept |  /           \  | kept

Balls and edges fit together whatever surrounds them; paths only have no inner vertex in common.

In space only paths are built, and none ends at a pinch that votes to separate.  Every vertex of a
path gets a ball, and every edge a stick of the material (see `tusqh.contacts.spatial`).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from tusqh.antialias.components import label_kept
from tusqh.antialias.pinches import find_pinches
from tusqh.contacts.one_material import MATERIAL
from tusqh.contacts.one_material_contacts import find_contacts, label_cells
from tusqh.contacts.planar import PlanarDecision
from tusqh.grid import BackgroundGrid, BoolArray, IntArray, doubled
from tusqh.grid.neighbourhoods import around_vertices
from tusqh.settings.policy import BridgeMode

if TYPE_CHECKING:
    from scipy.cluster.hierarchy import DisjointSet


def bridge_columns(dim: int) -> list[str]:
    """Return the columns of the table of bridges.

    Parameters
    ----------
    dim
        Dimension of the grid.
    """
    ends = [f"{axis}_{end}" for end in "ab" for axis in "xyz"[:dim]]
    return ["kind", "edges", "length", "cells_a", "cells_b", *ends, "status"]


ACCEPTED = "accepted"
NO_ROOM = "not joined: another bridge is in the way"


@dataclass(frozen=True)
class Bridge:
    """A path of grid edges between two components.

    Parameters
    ----------
    vertices
        Grid vertices of the path in order, shape (m, dim).
    cells
        Flat indices of a kept cell of each component that it joins, shape (2,).
    row
        Its row in the table of bridges.
    """

    vertices: IntArray
    cells: IntArray
    row: int

    @property
    def edges(self) -> tuple[IntArray, IntArray]:
        """In 2D the lower end of every edge and the step across it, shape (m - 1, 2) each."""
        low = np.minimum(self.vertices[:-1], self.vertices[1:])
        return low, 1 - np.abs(np.diff(self.vertices, axis=0))

    def is_needed(self, kept: BoolArray) -> bool:
        """Return whether both its ends are kept and all cells beside its edges are empty.

        Parameters
        ----------
        kept
            Kept cells, shape n.
        """
        low = np.minimum(self.vertices[:-1], self.vertices[1:])
        is_across = np.diff(self.vertices, axis=0) == 0
        corners = np.indices((2,) * kept.ndim).reshape(kept.ndim, -1).T
        beside = (low[:, None] - corners * is_across[:, None]).reshape(-1, kept.ndim)
        return bool(kept.ravel()[self.cells].all() and not kept[tuple(beside.T)].any())


def join_components(
    kept: BoolArray, is_interior: BoolArray, grid: BackgroundGrid, *, mode: BridgeMode
) -> tuple[BoolArray, list[Bridge], pd.DataFrame]:
    """Return pinches to connect and paths to build between components, and a table of bridges.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    is_interior
        Whether the fraction is at least the threshold, on the doubled grid, shape ``2 n + 1``.
    grid
        The background grid.
    mode
        `forest` joins only components that are still separate, so no hole appears; `all` follows
        every path between components that were different at the start.

    Returns
    -------
    is_joined
        Separated pinches that are to connect, shape ``n + 1``.
    bridges
        The paths.
    table
        One row per bridge: kind, number of edges, length (model units), cells of the two
        components, end points, and whether it was accepted.
    """
    is_joined = np.zeros(tuple(n + 1 for n in kept.shape), dtype=bool)
    columns = bridge_columns(kept.ndim)
    if mode == "none":
        return is_joined, [], pd.DataFrame(columns=columns)
    labels = label_kept(label_cells(kept), find_contacts(kept, is_interior))
    joiner = _Joiner(labels, int(labels.max(initial=0)), grid, joins_all=mode == "all")
    separates = find_pinches(kept) & ~is_interior[doubled.vertices(kept.ndim)]
    if kept.ndim == 2:
        _join_pinches(joiner, kept, separates, is_joined, is_interior)
        separates = np.zeros_like(separates)
    ends = _interior_edges(kept, is_interior, separates)
    bridges = _join_paths(joiner, kept, ends)
    _report_unjoined(joiner, ends)
    return is_joined, bridges, pd.DataFrame(joiner.rows, columns=columns)


def lay_bridges(decision: PlanarDecision, bridges: list[Bridge]) -> PlanarDecision:
    """Return a decision with balls at the vertices of paths and their edges bridged.

    Parameters
    ----------
    decision
        The decisions at the contacts of kept cells.
    bridges
        Paths through empty cells.
    """
    ball = decision.ball.copy()
    bridged = np.zeros((2, *decision.labels.shape), dtype=bool)
    for bridge in bridges:
        ball[tuple(bridge.vertices.T + 1)] = MATERIAL
        low, across = bridge.edges
        below = low + 1 - across
        bridged[(across.argmax(axis=1), *below.T)] = True
    return replace(decision, ball=ball, bridged=bridged)


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
        around = around_vertices(self.label[(slice(1, -1),) * self.label.ndim])
        return np.asarray(np.maximum.reduce(around).ravel(), dtype=np.int64)

    def may_join(self, a: int, b: int) -> bool:
        """Return whether a bridge between two components is wanted."""
        return a != b and (self.joins_all or not self.joined.connected(a, b))

    def add_row(self, kind: str, a: int, b: int, vertices: IntArray, status: str) -> int:
        """Add a bridge to the table and return its row."""
        ends = self.grid.to_points(vertices[[0, -1]])
        n_edges = len(vertices) - 1
        numbers = [n_edges, n_edges * self.grid.cell_size, self.n_cells[a], self.n_cells[b]]
        row = [kind, *numbers, *ends.ravel().tolist(), status]
        self.rows.append(dict(zip(bridge_columns(self.label.ndim), row, strict=True)))
        return len(self.rows) - 1


def _disjoint_set(items: Iterable[int]) -> DisjointSet:
    """Return the initial sets of union-find, one for each item."""
    # Import here, because few meshes have bridges and the import takes 0.1 s.
    from scipy.cluster.hierarchy import DisjointSet

    return DisjointSet(items)


def _join_pinches(
    joiner: _Joiner,
    kept: BoolArray,
    is_separated: BoolArray,
    is_joined: BoolArray,
    is_interior: BoolArray,
) -> None:
    """Mark as joined separated pinches with two interior edges around an empty cell, in place."""
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
    for i, j in np.argwhere(around_empty & is_separated):
        around = joiner.label[i : i + 2, j : j + 2]
        a, b = int(around.max()), int(around[around > 0].min())
        if joiner.may_join(a, b):
            joiner.joined.merge(a, b)
            joiner.add_row("pinch", a, b, np.array([[i, j]]), ACCEPTED)
            is_joined[i, j] = True


def _interior_edges(kept: BoolArray, is_interior: BoolArray, is_barred: BoolArray) -> IntArray:
    """Return the ends of the interior edges between empty cells of the grid, shape (m, 2).

    No edge may end at a vertex that is barred.
    """
    others = (slice(1, -1),) * (kept.ndim - 1)
    vertex_shape = tuple(n + 1 for n in kept.shape)
    vertex = np.arange(np.prod(vertex_shape), dtype=np.int64).reshape(vertex_shape)
    # A path may pass only interior vertices, but it may end at any vertex of a kept cell.
    usable = is_interior[doubled.vertices(kept.ndim)]
    usable = (usable | np.logical_or.reduce(around_vertices(kept))) & ~is_barred
    ends = []
    for axis in range(kept.ndim):
        # Move the axis first, and leave out edges on the border of the grid.
        of_edges = (slice(1, None, 2), *(slice(2, -2, 2),) * (kept.ndim - 1))
        mask = np.moveaxis(is_interior, axis, 0)[of_edges].copy()
        empty = ~np.moveaxis(kept, axis, 0)
        for corner in itertools.product((slice(-1), slice(1, None)), repeat=kept.ndim - 1):
            mask &= empty[(slice(None), *corner)]
        at_ends = np.moveaxis(usable, axis, 0)[(slice(None), *others)]
        mask &= at_ends[:-1] & at_ends[1:]
        vertices = np.moveaxis(vertex, axis, 0)[(slice(None), *others)]
        ends.append(np.stack([vertices[:-1][mask], vertices[1:][mask]], axis=1))
    return np.concatenate(ends)


def _join_paths(joiner: _Joiner, kept: BoolArray, ends: IntArray) -> list[Bridge]:
    """Accept paths without common inner vertices or edges, the shortest first."""
    component = joiner.component_at_vertex()
    is_taken = np.zeros(len(component), dtype=bool)
    is_used = np.zeros(len(ends), dtype=bool)
    cell_at_vertex = _kept_cell_at_vertices(kept)
    bridges: list[Bridge] = []
    while True:
        usable = ~is_used & ~is_taken[ends].any(axis=1)
        path = _shortest_path(component, ends[usable], joiner.may_join)
        if path is None:
            return bridges
        a, b = component[path[[0, -1]]]
        vertices = np.stack(np.unravel_index(path, np.add(kept.shape, 1)), axis=1)
        row = joiner.add_row("path", int(a), int(b), vertices, ACCEPTED)
        joiner.joined.merge(int(a), int(b))
        bridges.append(Bridge(vertices, cell_at_vertex[path[[0, -1]]], row))
        steps = np.sort(np.stack([path[:-1], path[1:]], axis=1), axis=1)
        is_used |= (ends[:, None] == steps[None]).all(axis=2).any(axis=1)
        is_taken[path[1:-1]] = True


def _shortest_path(
    component_at_vertex: IntArray, ends: IntArray, may_join: Callable[[int, int], bool]
) -> IntArray | None:
    """Return the flat vertices of a shortest wanted path along edges, or None."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra

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


def _report_unjoined(joiner: _Joiner, ends: IntArray) -> None:
    """Add a row for interior paths between components that stay separate."""
    component = joiner.component_at_vertex()

    def is_separate(a: int, b: int) -> bool:
        return not joiner.joined.connected(a, b)

    while (path := _shortest_path(component, ends, is_separate)) is not None:
        a, b = (int(c) for c in component[path[[0, -1]]])
        vertices = np.stack(np.unravel_index(path, np.add(joiner.grid.shape, 1)), axis=1)
        joiner.add_row("path", a, b, vertices, NO_ROOM)
        joiner.joined.merge(a, b)


def _kept_cell_at_vertices(kept: BoolArray) -> IntArray:
    """Return a flat kept cell at every flat vertex, -1 where there is none."""
    numbers = np.where(kept, np.arange(kept.size).reshape(kept.shape) + 1, 0)
    return np.asarray(np.maximum.reduce(around_vertices(numbers)).ravel() - 1, dtype=np.int64)
