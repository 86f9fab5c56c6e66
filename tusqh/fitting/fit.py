"""Fit the boundary of a mesh to its target."""

from __future__ import annotations

from tusqh.fitting.fitted import Fitted
from tusqh.fitting.hexes import fit_hexes
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

    The boundary is covered with a layer of elements; then vertices move.  Components, holes and
    voids stay as they are.  Where fitting fails, the boundary stays at the smoothed staircase or at
    the staircase itself, and `Fitted.fell_back` says so.

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
    return fit_hexes(mesh, target, fixed=fixed, threshold=threshold)
