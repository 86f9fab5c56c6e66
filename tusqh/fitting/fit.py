"""Fit the boundary of a mesh to its target."""

from __future__ import annotations

import pandas as pd

from tusqh.fitting.distances import measure_distances
from tusqh.fitting.fitted import FELL_BACK_COLUMNS, Fitted
from tusqh.fitting.planar.quads import fit_quads
from tusqh.fitting.target import Target
from tusqh.grid import BoolArray
from tusqh.meshes.volume_mesh import VolumeMesh


def fit_mesh(
    mesh: VolumeMesh,
    target: Target,
    *,
    cell_size: float,
    fixed: BoolArray | None = None,
    threshold: float = 0.5,
) -> Fitted:
    """Return a mesh of quads or hexes whose boundary lies on the surface where that is possible.

    Parameters
    ----------
    mesh
        The mesh of a threshold.
    target
        Where its boundary should lie.
    cell_size
        Edge length of a cell of the background grid, in model units.
    fixed
        Points that do not move, shape (n,).
    threshold
        The threshold of the mesh: the boundary first follows the level sets from it to 1/2.
    """
    if mesh.dim == 2:
        return fit_quads(mesh, target, fixed=fixed)
    distances = measure_distances(mesh, target)
    return Fitted(mesh, distances, pd.DataFrame(columns=list(FELL_BACK_COLUMNS)))
