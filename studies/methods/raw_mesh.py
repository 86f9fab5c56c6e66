"""Make the mesh of kept cells whose pinches are not resolved."""

from __future__ import annotations

import numpy as np

from tusqh.grid import HEX_CORNERS, QUAD_CORNERS, BackgroundGrid, BoolArray
from tusqh.meshes.volume_mesh import GRID_CELL, VolumeMesh


def raw_mesh(
    kept: BoolArray, grid: BackgroundGrid | None = None, *, name: str = "mesh"
) -> VolumeMesh:
    """Return one element per kept cell, sharing the grid vertices between them.

    The boundary is not always a manifold, and parts may be joined only by a vertex or an edge.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    grid
        The background grid, of shape n; by default a grid of unit cells at the origin.
    name
        The model, for messages.

    Examples
    --------
    >>> mesh = raw_mesh(np.eye(2, dtype=bool))
    >>> mesh.n_cells, len(mesh.points)
    (2, 7)
    """
    if grid is None:
        grid = BackgroundGrid(shape=kept.shape, cell_size=1.0, origin=(0.0,) * kept.ndim)
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
