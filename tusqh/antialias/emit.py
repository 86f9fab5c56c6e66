"""Turn kept cells and decisions into elements, in both dimensions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tusqh.antialias.actions import Action, find_actions
from tusqh.antialias.rings import emit_rings
from tusqh.antialias.strips import (
    Strip,
    emit_strips,
    find_attached_sides,
    find_cells_with_corners,
)
from tusqh.contacts.emitter import Emitter
from tusqh.grid.arrays import BoolArray, IntArray
from tusqh.grid.background import BackgroundGrid
from tusqh.grid.neighbourhoods import across_faces
from tusqh.meshes.volume_mesh import (
    BRIDGE,
    CONNECTING,
    GRID_CELL,
    INNER_CELL,
    SEPARATING,
    VolumeMesh,
)


def emit_mesh(
    kept: BoolArray,
    at_vertex: NDArray[np.int8],
    grid: BackgroundGrid,
    *,
    bridges: Sequence[IntArray] = (),
    is_freed: BoolArray | None = None,
    name: str = "mesh",
) -> tuple[VolumeMesh, IntArray]:
    """Return the mesh of kept cells with templates where the decisions need them.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    at_vertex
        `SEPARATE`, `NONE` or `CONNECT` for every grid vertex, shape ``n + 1``.
    grid
        The background grid, of shape n.
    bridges
        In 2D, paths of grid vertices, shape (m, 2) each, along which strips join components.
    is_freed
        In 3D, vertices at which the templates act regardless of the neighbourhood, shape ``n + 1``.
    name
        The model, for messages.

    Returns
    -------
    mesh
        Quads, counter-clockwise, or hexes, in VTK order.
    grid_vertex
        Flat grid vertex of every point of the mesh, -1 for the other points of templates, shape
        (n_points,).

    References
    ----------
    The paper's section on anti-aliasing; algorithm 4.3.

    Examples
    --------
    >>> from tusqh.antialias.clusters import CONNECT
    >>> grid = BackgroundGrid(shape=(2, 2), cell_size=1.0, origin=(0.0, 0.0))
    >>> kept = np.eye(2, dtype=bool)
    >>> decision = np.zeros((3, 3), dtype=np.int8)
    >>> decision[1, 1] = CONNECT
    >>> emit_mesh(kept, decision, grid)[0].n_cells     # 2 cells and 4 trapezoids
    6
    >>> emit_mesh(kept, -decision, grid)[0].n_cells    # 2 inner cells with 2 trapezoids each
    6
    """
    freed = np.zeros(at_vertex.shape, dtype=bool) if is_freed is None else is_freed
    separate, connect = find_actions(kept, at_vertex, freed)
    strips = [Strip.along(path) for path in bridges]
    attaches = _find_attached(kept, separate, strips)
    has_inner = separate.split | connect.split | np.logical_or.reduce(attaches)
    if strips:
        has_inner |= find_cells_with_corners(strips, grid.shape)
    emitter = Emitter(grid, has_inner)
    emitter.add_cells(kept & ~separate.split, GRID_CELL)
    emitter.add_inner_cells(separate.split, INNER_CELL)
    for face, (removed, added) in enumerate(zip(separate.frusta, connect.frusta, strict=True)):
        emitter.add_frusta(face, removed, SEPARATING)
        emitter.add_frusta(face, added, CONNECTING)
        emitter.add_frusta(face, attaches[face] & ~added, BRIDGE)
    if grid.dim == 3:
        emit_rings(emitter, separate, SEPARATING)
        emit_rings(emitter, connect, CONNECTING)
    emit_strips(emitter, strips)
    emitted = emitter.finish(name)
    return emitted.mesh, emitted.grid_vertex


def _find_attached(kept: BoolArray, separate: Action, strips: Sequence[Strip]) -> list[BoolArray]:
    """Return, for every face number, the cells whose frustum attaches a strip to a kept cell."""
    if not strips:
        return [np.zeros(kept.shape, dtype=bool) for _ in across_faces(kept)]
    wanted = find_attached_sides(strips, kept.shape)
    return [
        attached & is_kept & ~touched
        for attached, is_kept, touched in zip(
            wanted, across_faces(kept), separate.touched, strict=True
        )
    ]
