r"""The 1-5 template: quads split into an inner cell and four trapezoids, some of which go.

::

    3-----------2      A split cell has an inner cell, inset by a quarter, and one
    | \   2   / |      trapezoid per side.  To *separate*, kept cells at the pinch are
    |  3-----2  |      split and the trapezoids between them and the void go, so that the
    |3 |inner|1 |      cell draws back from the pinch.  To *connect*, empty cells at the
    |  0-----1  |      pinch are split and the trapezoids between them and the kept cells
    | /   0   \ |      are added, so that the kept cells meet side to side.
    0-----------1

Outer sides of split cells stay whole, so that cells around them conform.
Source: the paper's 1-5 split, with the rule of algorithm 4.3.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from tusqh.antialias.clusters import CONNECT, SEPARATE
from tusqh.grid import QUAD_CORNERS, QUAD_SIDES, BackgroundGrid, BoolArray, FloatArray, IntArray
from tusqh.meshes.volume_mesh import (
    BRIDGE,
    CONNECTING,
    GRID_CELL,
    INNER_CELL,
    SEPARATING,
    VolumeMesh,
)

#: Distance of the inner cell from the sides, in cells.  A quarter makes every trapezoid have
#: angles of 45 and 135 degrees, so its scaled Jacobian is sqrt(2)/2 on square cells.
INSET = 0.25

#: Directions of the points beside a path that goes straight on, in units of `INSET`.
STUBS: IntArray = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]], dtype=np.int64)


def emit_quads(
    kept: BoolArray,
    at_vertex: NDArray[np.int8],
    grid: BackgroundGrid,
    *,
    bridges: Sequence[IntArray] = (),
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
    bridges
        Paths of grid vertices, shape (m, 2) each, along which a strip joins two components.
    name
        The model, for messages.

    Returns
    -------
    mesh
        Quads in VTK order, counter-clockwise.
    grid_vertex
        For every point of the mesh its flat grid-vertex index, or -1 for a corner of an inner
        cell or strip, shape (n_points,).

    Examples
    --------
    >>> import numpy as np
    >>> grid = BackgroundGrid(shape=(2, 2), cell_size=1.0, origin=(0.0, 0.0))
    >>> kept = np.eye(2, dtype=bool)
    >>> decision = np.zeros((3, 3), dtype=np.int8)
    >>> decision[1, 1] = CONNECT
    >>> emit_quads(kept, decision, grid)[0].n_cells     # 2 cells and 4 trapezoids
    6
    >>> emit_quads(kept, -decision, grid)[0].n_cells    # 2 inner cells with 2 trapezoids each
    6
    """
    n_vertices = at_vertex.size
    padded = np.pad(kept, 1)
    at_corner = np.stack([_shifted(at_vertex, c, kept.shape) for c in QUAD_CORNERS])
    is_neighbour_kept = np.stack([_shifted(padded, 1 + s, kept.shape) for s in QUAD_SIDES])

    separates = kept & (at_corner == SEPARATE).any(axis=0)
    connects = ~kept & (at_corner == CONNECT).any(axis=0)
    side_separates = (at_corner == SEPARATE) | (np.roll(at_corner, -1, axis=0) == SEPARATE)
    side_connects = (at_corner == CONNECT) | (np.roll(at_corner, -1, axis=0) == CONNECT)
    stays = separates & ~(~is_neighbour_kept & side_separates)
    is_added = connects & is_neighbour_kept & side_connects
    attaches = np.zeros_like(is_added)
    for path in bridges:
        for cell, side in _ends_of(path):
            attaches[(side, *cell)] = True
    attaches &= is_neighbour_kept & ~side_separates

    cell_index = np.arange(kept.size, dtype=np.int64).reshape(kept.shape)
    vertex_index = np.arange(n_vertices, dtype=np.int64).reshape(at_vertex.shape)
    outer = np.stack([_shifted(vertex_index, c, kept.shape) for c in QUAD_CORNERS], axis=-1)
    inner = n_vertices + 4 * cell_index[..., None] + np.arange(4)

    quads, kinds, owners = [], [], []

    def emit(corners: IntArray, mask: BoolArray, kind: int) -> None:
        quads.append(corners[mask])
        owners.append(cell_index[mask])
        kinds.append(np.full(len(owners[-1]), kind, dtype=np.int64))

    emit(outer, kept & ~separates, GRID_CELL)
    emit(inner, separates, INNER_CELL)
    for side in range(4):
        end = (side + 1) % 4
        trapezoid = np.stack(
            [outer[..., side], outer[..., end], inner[..., end], inner[..., side]], axis=-1
        )
        emit(trapezoid, stays[side], SEPARATING)
        emit(trapezoid, is_added[side], CONNECTING)
        emit(trapezoid, attaches[side] & ~is_added[side], BRIDGE)
    for path in bridges:
        corners, beside = _strip(path, at_vertex.shape)
        quads.append(corners)
        owners.append(beside)
        kinds.append(np.full(len(beside), BRIDGE, dtype=np.int64))

    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    used, cells = np.unique(np.concatenate(quads)[order], return_inverse=True)
    is_grid_vertex = used < n_vertices
    mesh = VolumeMesh(
        points=_coordinates(used, n_vertices, grid),
        cells=cells.reshape(-1, 4).astype(np.int64),
        kind=np.concatenate(kinds)[order],
        grid_cell=owner[order],
        name=name,
    )
    return mesh, np.where(is_grid_vertex, used, -1)


def _shifted(array: np.ndarray, by: IntArray, shape: tuple[int, ...]) -> np.ndarray:
    """Return the view of `shape` that starts at `by`."""
    return array[tuple(slice(b, b + n) for b, n in zip(by, shape, strict=True))]


def _ends_of(path: IntArray) -> Iterator[tuple[tuple[int, int], int]]:
    """Yield the cells beside the first and last edge of a path and their sides at its ends."""
    for end, towards in ((path[0], path[1] - path[0]), (path[-1], path[-2] - path[-1])):
        left = np.array([-towards[1], towards[0]])
        side = int((-towards == QUAD_SIDES).all(axis=1).argmax())
        for across in (left, -left):
            x, y = end + (towards + across - 1) // 2
            yield (int(x), int(y)), side


def _strip(path: IntArray, shape: tuple[int, ...]) -> tuple[IntArray, IntArray]:
    r"""Return two quads per edge of a path, to its left and right, and the cells they lie in.

    The strip is half a cell wide; at turns it has a mitre, at its ends it widens to the inner
    cells' corners, where the trapezoids that attach it begin::

        kept |  \___________/  | kept      v: ends of the path
        -----v-----path------v-----
        kept |  /           \  | kept
    """
    steps = np.diff(path, axis=0)
    left = np.stack([-steps[:, 1], steps[:, 0]], axis=1)
    at_left = np.empty_like(path)
    turns = (steps[:-1] != steps[1:]).any(axis=1)[:, None]
    at_left[1:-1] = np.where(turns, left[:-1] + left[1:], left[1:])
    at_left[0], at_left[-1] = left[0] + steps[0], left[-1] - steps[-1]
    at_right = -at_left
    at_right[0], at_right[-1] = steps[0] - left[0], -left[-1] - steps[-1]
    vertex = np.ravel_multi_index(tuple(path.T), shape)
    to_left, to_right = (_offset_points(path, offset, shape) for offset in (at_left, at_right))
    quads = [
        np.stack([vertex[:-1], vertex[1:], to_left[1:], to_left[:-1]], axis=1),
        np.stack([vertex[1:], vertex[:-1], to_right[:-1], to_right[1:]], axis=1),
    ]
    n_cells = tuple(n - 1 for n in shape)
    beside = [
        np.ravel_multi_index(tuple((path[:-1] + (steps + across - 1) // 2).T), n_cells)
        for across in (left, -left)
    ]
    return np.concatenate(quads), np.concatenate(beside).astype(np.int64)


def _offset_points(path: IntArray, offset: IntArray, shape: tuple[int, ...]) -> IntArray:
    """Return the points a quarter of a cell from grid vertices, along one axis or along both."""
    n_vertices, n_cells = math.prod(shape), math.prod(n - 1 for n in shape)
    vertex = np.ravel_multi_index(tuple(path.T), shape)
    along = (STUBS[None] == offset[:, None]).all(axis=2).argmax(axis=1)
    cell = np.ravel_multi_index(tuple((path + (offset - 1) // 2).T), tuple(n - 1 for n in shape))
    corner = (QUAD_CORNERS[None] == (offset[:, None] < 0)).all(axis=2).argmax(axis=1)
    is_corner = (offset != 0).all(axis=1)
    stub = n_vertices + 4 * n_cells + 4 * vertex + along
    return np.asarray(np.where(is_corner, n_vertices + 4 * cell + corner, stub), dtype=np.int64)


def _coordinates(used: IntArray, n_vertices: int, grid: BackgroundGrid) -> FloatArray:
    """Return where the points numbered by `emit_quads` are.

    First come the grid vertices, then four corners of every inner cell, then four stubs of every
    vertex, a quarter of a cell from it along `STUBS`.
    """
    n_inner = n_vertices + 4 * grid.n_cells
    outer, inner, stub = np.split(used, np.searchsorted(used, [n_vertices, n_inner]))
    vertices = np.add(grid.shape, 1)
    towards = INSET + (1 - 2 * INSET) * QUAD_CORNERS[(inner - n_vertices) % 4]
    lattice = [
        np.stack(np.unravel_index(outer, vertices), axis=1),
        np.stack(np.unravel_index((inner - n_vertices) // 4, grid.shape), axis=1) + towards,
        np.stack(np.unravel_index((stub - n_inner) // 4, vertices), axis=1)
        + INSET * STUBS[(stub - n_inner) % 4],
    ]
    return grid.to_points(np.concatenate(lattice))
