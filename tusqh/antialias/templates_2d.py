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
Source: the paper's 1-5 split, with the rule of the algorithm notes 4.3.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tusqh.antialias.clusters import CONNECT, SEPARATE
from tusqh.grid import QUAD_CORNERS, QUAD_SIDES, BackgroundGrid, BoolArray, FloatArray, IntArray
from tusqh.mesh.volume_mesh import CONNECTING, GRID_CELL, INNER_CELL, SEPARATING, VolumeMesh

#: Distance of the inner cell from the sides, in cells.  A quarter makes every trapezoid have
#: angles of 45 and 135 degrees, so its scaled Jacobian is sqrt(2)/2 on square cells.
INSET = 0.25


def emit_quads(
    kept: BoolArray, at_vertex: NDArray[np.int8], grid: BackgroundGrid, *, name: str = "mesh"
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
    name
        The model, for messages.

    Returns
    -------
    mesh
        Quads in VTK order, counter-clockwise.
    grid_vertex
        For every point of the mesh its flat grid-vertex index, or -1 for a corner of an inner
        cell, shape (n_points,).

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


def _coordinates(used: IntArray, n_vertices: int, grid: BackgroundGrid) -> FloatArray:
    """Return where the points numbered by `emit_quads` are."""
    lattice = np.empty((len(used), 2))
    outer = used[used < n_vertices]
    lattice[: len(outer)] = np.column_stack(np.unravel_index(outer, np.add(grid.shape, 1)))
    inner = used[len(outer) :] - n_vertices
    towards = INSET + (1 - 2 * INSET) * QUAD_CORNERS[inner % 4]
    lattice[len(outer) :] = np.column_stack(np.unravel_index(inner // 4, grid.shape)) + towards
    return grid.to_points(lattice)
