"""Kept cells as a mesh, exactly as they are: pinches and all."""

from __future__ import annotations

import numpy as np

from tusqh.grid import HEX_CORNERS, QUAD_CORNERS, BackgroundGrid, BoolArray
from tusqh.meshes.volume_mesh import GRID_CELL, VolumeMesh


def mesh_cells(kept: BoolArray, grid: BackgroundGrid, *, name: str = "mesh") -> VolumeMesh:
    """Return one element per kept cell, sharing the grid vertices between them.

    What any code would make that keeps cells and resolves nothing: the boundary need not be a
    manifold, and parts may hang together by a vertex or an edge.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    grid
        The background grid, of shape n.
    name
        The model, for messages.

    Examples
    --------
    >>> grid = BackgroundGrid(shape=(2, 2), cell_size=1.0, origin=(0.0, 0.0))
    >>> mesh = mesh_cells(np.eye(2, dtype=bool), grid)
    >>> mesh.n_cells, len(mesh.points)
    (2, 7)
    """
    corners = np.argwhere(kept)[:, None] + (QUAD_CORNERS if grid.dim == 2 else HEX_CORNERS)
    shape = tuple(n + 1 for n in grid.shape)
    numbers = np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), shape)
    used, cells = np.unique(numbers, return_inverse=True)
    return VolumeMesh(
        points=grid.to_points(np.stack(np.unravel_index(used, shape), axis=1)),
        cells=cells.reshape(numbers.shape).astype(np.int64),
        kind=np.full(len(numbers), GRID_CELL, dtype=np.int64),
        grid_cell=np.flatnonzero(kept).astype(np.int64),
        name=name,
    )
