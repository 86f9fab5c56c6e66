r"""The 1-7 and 2-6 templates: hexes split into an inner cell and frusta, some of which go.

The rule of `templates_2d` in space (paper: the 1-7 and 2-6 splits; algorithm 4.3).  The
*acting* side is the kept cells where a pinch separates and the empty cells where it connects; the
children that separating removes are those that connecting adds.  Acting cells at a decided
vertex or pinch edge are split: an inner cell, inset by a quarter, and one frustum per face.

* A frustum whose face touches a decided vertex or contains a decided pinch edge, with a cell of
  the other side behind that face, goes.
* Where two split cells of the acting side share a face that touches a decided vertex, their two
  frusta give way to the 2-6 template: two centres between the inner cells and a small quad in
  the face, and four rings around it, one per edge of the face; the rings at decided vertices go.

Section through a face between two split cells, ``f`` its edges, ``s`` the small quad::

    +-----------f-----------+
    | \  ring  / \  ring  / |      Outer faces of split cells stay whole, so that cells
    |  +------+   +------+  |      around them conform.
    |  |inner |ctr|inner |  |
    |  +------s---s------+  |
    | /        \ /        \ |
    +-----------f-----------+
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tusqh.antialias.clusters import CONNECT, SEPARATE
from tusqh.antialias.pinches import find_pinch_edges, neighbourhood_codes, template_tables
from tusqh.grid import HEX_CORNERS, BackgroundGrid, BoolArray, FloatArray, IntArray
from tusqh.meshes.facets import HEX_FACETS
from tusqh.meshes.volume_mesh import CONNECTING, GRID_CELL, INNER_CELL, SEPARATING, VolumeMesh

#: Distance of the inner cell from the faces, in cells, and of the small quad from the edges of
#: its face.  Scaled Jacobians on cubic cells: frusta 1/sqrt(3), rings >= 2/3, centres 0.9.
INSET = 0.25
QUAD_INSET = 0.35

#: Axis and side (0 lower, 1 upper) of every face in the order of `HEX_FACETS`.
_FACES = [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)]


@dataclass(frozen=True)
class _Action:
    """Where one of the two decisions acts.

    Parameters
    ----------
    at_vertex
        Decided vertices, shape ``n + 1``.
    at_edge
        Decided pinch edges along each axis.
    acting
        Cells of the acting side, shape n.
    """

    at_vertex: BoolArray
    at_edge: list[BoolArray]
    acting: BoolArray


def emit_hexes(
    kept: BoolArray,
    at_vertex: NDArray[np.int8],
    grid: BackgroundGrid,
    *,
    is_freed: BoolArray | None = None,
    name: str = "mesh",
) -> tuple[VolumeMesh, IntArray]:
    """Return the mesh of kept cells with templates where `at_vertex` asks for them.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    at_vertex
        `SEPARATE`, `NONE` or `CONNECT` for every grid vertex, shape ``n + 1``.
    grid
        The background grid, of shape n.
    is_freed
        Vertices at which the templates act whatever their neighbourhood (closing).
    name
        The model, for messages.

    Returns
    -------
    mesh
        Hexes in VTK order.
    grid_vertex
        For every point of the mesh its flat grid-vertex index, or -1 for a corner of an inner
        cell or small quad, shape (n_points,).

    Examples
    --------
    >>> kept = np.zeros((2, 2, 2), dtype=bool)
    >>> kept[0, 0, 0] = kept[1, 1, 1] = True
    >>> decision = np.zeros((3, 3, 3), dtype=np.int8)
    >>> decision[1, 1, 1] = SEPARATE
    >>> grid = BackgroundGrid(shape=(2, 2, 2), cell_size=1.0, origin=(0.0, 0.0, 0.0))
    >>> emit_hexes(kept, decision, grid)[0].n_cells     # 2 inner cells with 3 frusta each
    8
    """
    freed = np.zeros(at_vertex.shape, dtype=bool) if is_freed is None else is_freed
    emitter = _Emitter(kept, at_vertex, freed, grid)
    emitter.emit_cells()
    for action, kind in ((emitter.separate, SEPARATING), (emitter.connect, CONNECTING)):
        emitter.emit_frusta(action, kind)
        emitter.emit_rings(action, kind)
    return emitter.finish(name)


class _Emitter:
    """The points numbered so far and the hexes made of them.

    Grid vertices come first, then eight corners of every split cell, then four corners of the
    small quad of every face with the 2-6 template.
    """

    def __init__(
        self,
        kept: BoolArray,
        at_vertex: NDArray[np.int8],
        is_freed: BoolArray,
        grid: BackgroundGrid,
    ) -> None:
        self.kept = kept
        self.grid = grid
        self.shape = np.array(kept.shape)
        self.n_vertices = at_vertex.size
        stride = np.array([(kept.shape[1] + 1) * (kept.shape[2] + 1), kept.shape[2] + 1, 1])
        self.corner_step = HEX_CORNERS @ stride
        codes = neighbourhood_codes(kept)
        self.separate, self.connect = (
            _Action(
                at_vertex=(at_vertex == decision) & (table[codes] | is_freed),
                at_edge=[_decided_edges(kept, at_vertex == decision, axis) for axis in range(3)],
                acting=acting,
            )
            for decision, table, acting in zip(
                (SEPARATE, CONNECT), template_tables(), (kept, ~kept), strict=True
            )
        )
        self.is_split = np.logical_or(*(_split(action) for action in (self.separate, self.connect)))
        self.split_number = np.full(kept.size, -1, dtype=np.int64)
        split = np.flatnonzero(self.is_split)
        self.split_number[split] = np.arange(len(split))
        self.split = split
        self.n_quads = 0
        self.quad_points: list[FloatArray] = []
        self.hexes: list[IntArray] = []
        self.kinds: list[IntArray] = []
        self.owners: list[IntArray] = []

    def add(self, hexes: IntArray, owners: IntArray, kind: int) -> None:
        """Add hexes of one kind."""
        self.hexes.append(hexes)
        self.owners.append(owners)
        self.kinds.append(np.full(len(hexes), kind, dtype=np.int64))

    def outer(self, cells: IntArray) -> IntArray:
        """Return the grid vertices at the corners of flat cells, shape (m, 8)."""
        i, j, k = np.unravel_index(cells, tuple(self.shape))
        lowest = np.ravel_multi_index((i, j, k), tuple(self.shape + 1))
        return np.asarray(lowest[:, None] + self.corner_step, dtype=np.int64)

    def inner(self, cells: IntArray) -> IntArray:
        """Return the corners of the inner cells of flat split cells, shape (m, 8)."""
        first = self.n_vertices + 8 * self.split_number[cells]
        return np.asarray(first[:, None] + np.arange(8), dtype=np.int64)

    def emit_cells(self) -> None:
        """Emit the kept cells, whole, or their inner cells where they are split."""
        whole = np.flatnonzero(self.kept & ~self.is_split)
        self.add(self.outer(whole), whole, GRID_CELL)
        inner = np.flatnonzero(self.kept & self.is_split)
        self.add(self.inner(inner), inner, INNER_CELL)

    def emit_frusta(self, action: _Action, kind: int) -> None:
        """Emit the frusta that stay of kept cells, or that are added in empty cells."""
        is_kept_side = action is self.separate
        split = action.acting & self.is_split
        padded = np.pad(action.acting, 1)
        for face, (axis, side) in enumerate(_FACES):
            at_vertex, at_edge = _face_touches(action, axis, side, tuple(self.shape))
            step = tuple(
                slice(2 * side, n + 2 * side) if k == axis else slice(1, n + 1)
                for k, n in enumerate(self.shape)
            )
            is_same = padded[step]
            goes = ~is_same & (at_vertex | at_edge)
            emitted = ~goes & ~(is_same & at_vertex) if is_kept_side else goes
            if not is_kept_side:  # Outside the grid there is nothing to connect to.
                emitted = emitted & _has_neighbour(tuple(self.shape), axis, side)
            cells = np.flatnonzero(split & emitted)
            local = HEX_FACETS[face]
            hexes = np.concatenate([self.inner(cells)[:, local], self.outer(cells)[:, local]], 1)
            self.add(hexes, cells, kind)

    def emit_rings(self, action: _Action, kind: int) -> None:
        """Emit the 2-6 templates between split cells of the acting side."""
        is_kept_side = action is self.separate
        at_vertex = action.at_vertex.ravel()
        for axis in range(3):
            touches, _ = _face_touches(action, axis, 1, tuple(self.shape))
            low, high = _pair(axis)
            both = action.acting[low] & action.acting[high] & touches[low]
            lower = np.flatnonzero(_grown(both, axis, self.shape))
            upper = lower + int(np.prod(self.shape[axis + 1 :]))
            face = 2 * axis + 1
            local = HEX_FACETS[face]
            mirror = [_mirrored(int(corner), axis) for corner in local]
            p = self.outer(lower)[:, local]
            below, above = self.inner(lower)[:, local], self.inner(upper)[:, mirror]
            s = self._small_quads(lower, axis, local)
            if is_kept_side:
                self.add(np.concatenate([below, s], 1), lower, kind)
                self.add(np.concatenate([s, above], 1), upper, kind)
            for k in range(4):
                a, b = k, (k + 1) % 4
                touched = at_vertex[p[:, a]] | at_vertex[p[:, b]]
                chosen = ~touched if is_kept_side else touched
                ring = np.stack([q[:, c] for c in (a, b) for q in (p, below, s, above)], axis=1)
                self.add(ring[chosen], lower[chosen], kind)

    def _small_quads(self, lower: IntArray, axis: int, local: IntArray) -> IntArray:
        """Return new numbers for the small quads in the upper faces of cells, shape (m, 4)."""
        first = self.n_vertices + 8 * len(self.split) + 4 * self.n_quads
        self.n_quads += len(lower)
        inset = QUAD_INSET + (1 - 2 * QUAD_INSET) * HEX_CORNERS[local]
        inset[:, axis] = 1.0
        base = np.stack(np.unravel_index(lower, tuple(self.shape)), axis=1)
        self.quad_points.append((base[:, None] + inset).reshape(-1, 3))
        return first + np.arange(4 * len(lower), dtype=np.int64).reshape(-1, 4)

    def finish(self, name: str) -> tuple[VolumeMesh, IntArray]:
        """Return the mesh of all hexes, in the order of their grid cells."""
        owner = np.concatenate(self.owners)
        order = np.argsort(owner, kind="stable")
        hexes = np.concatenate(self.hexes)[order]
        n_split = 8 * len(self.split)
        is_used = np.zeros(self.n_vertices + n_split + 4 * self.n_quads, dtype=bool)
        is_used[hexes.ravel()] = True
        used = np.flatnonzero(is_used)
        number = np.cumsum(is_used, dtype=np.int64) - 1
        bounds = [self.n_vertices, self.n_vertices + n_split]
        outer, inner, small = np.split(used, np.searchsorted(used, bounds))
        cell = np.unravel_index(self.split[(inner - bounds[0]) // 8], tuple(self.shape))
        towards = INSET + (1 - 2 * INSET) * HEX_CORNERS[(inner - bounds[0]) % 8]
        quads = np.concatenate(self.quad_points)
        lattice = [
            np.stack(np.unravel_index(outer, tuple(self.shape + 1)), axis=1),
            np.stack(cell, axis=1) + towards,
            quads[small - bounds[1]],
        ]
        mesh = VolumeMesh(
            points=self.grid.to_points(np.concatenate(lattice)),
            cells=number[hexes],
            kind=np.concatenate(self.kinds)[order],
            grid_cell=owner[order],
            name=name,
        )
        return mesh, np.where(used < self.n_vertices, used, -1)


def _decided_edges(kept: BoolArray, decided: BoolArray, axis: int) -> BoolArray:
    """Return the pinch edges along an axis whose ends have a decision."""
    low, high = _pair(axis)
    return find_pinch_edges(kept, axis) & decided[low] & decided[high]


def _pair(axis: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """Return the indices of all but the last, and all but the first, along an axis."""
    before = (slice(None),) * axis
    return (*before, slice(None, -1)), (*before, slice(1, None))


def _grown(array: BoolArray, axis: int, shape: IntArray) -> BoolArray:
    """Return an array with a last layer of False along an axis, so that it has a shape again."""
    grown = np.zeros(tuple(shape), dtype=bool)
    grown[_pair(axis)[0]] = array
    return grown


def _has_neighbour(shape: tuple[int, ...], axis: int, side: int) -> BoolArray:
    """Return which cells have a neighbour in the grid across a side."""
    has = np.ones(shape, dtype=bool)
    has[(slice(None),) * axis + (-1 if side else 0,)] = False
    return has


def _mirrored(corner: int, axis: int) -> int:
    """Return the corner of the next cell along an axis at the same grid vertex."""
    offset = HEX_CORNERS[corner].copy()
    offset[axis] = 1 - offset[axis]
    return int((offset == HEX_CORNERS).all(axis=1).argmax())


def _split(action: _Action) -> BoolArray:
    """Return the acting cells at decided vertices and edges, shape n."""
    touches = np.zeros(action.acting.shape, dtype=bool)
    for corner in HEX_CORNERS:
        touches |= _window(action.at_vertex, corner, action.acting.shape)
    for axis, edges in enumerate(action.at_edge):
        for corner in HEX_CORNERS[HEX_CORNERS[:, axis] == 0]:
            touches |= _window(edges, corner, action.acting.shape)
    return touches & action.acting


def _face_touches(
    action: _Action, axis: int, side: int, shape: tuple[int, ...]
) -> tuple[BoolArray, BoolArray]:
    """Return which cells' faces touch decided vertices, and which contain decided edges."""
    at_vertex = np.zeros(shape, dtype=bool)
    at_edge = np.zeros(shape, dtype=bool)
    for corner in HEX_CORNERS[HEX_CORNERS[:, axis] == side]:
        at_vertex |= _window(action.at_vertex, corner, shape)
        for along in range(3):
            if along != axis and corner[along] == 0:
                at_edge |= _window(action.at_edge[along], corner, shape)
    return at_vertex, at_edge


def _window(array: BoolArray, offset: IntArray, shape: tuple[int, ...]) -> BoolArray:
    """Return the view of a shape that starts at an offset."""
    return array[tuple(slice(o, o + n) for o, n in zip(offset, shape, strict=True))]
