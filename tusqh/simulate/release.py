"""Make the initial field, an amount released around a point of the mesh."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tusqh.errors import SimulationError
from tusqh.grid import FloatArray
from tusqh.meshes.facets import HEX_FACETS
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.simulate.operators import Operators


def release(
    mesh: VolumeMesh,
    operators: Operators,
    *,
    source: Sequence[float] | None = None,
    radius: float | None = None,
) -> FloatArray:
    """Return a Gaussian on the component of the mesh that contains its centre.

    Parameters
    ----------
    mesh
        The mesh.
    operators
        Its operators in the mesh's unit of length, with (n_dofs, dim) nodes.
    source
        Centre, shape (dim,), in the mesh's unit; None: the centre of the element farthest from the
        boundary.
    radius
        Standard deviation, in the mesh's unit; None: twice the longest element side.

    Returns
    -------
    numpy.ndarray
        Values at the nodes, shape (n_dofs,), dimensionless, with 1 at the centre and 0 on all
        other components.

    Raises
    ------
    SimulationError
        The source lies outside the mesh.
    """
    place = _deepest_point(mesh) if source is None else np.asarray(source, dtype=np.float64)
    if radius is None:
        sides = mesh.points[mesh.cells] - mesh.points[np.roll(mesh.cells, 1, axis=1)]
        radius = 2 * float(np.linalg.norm(sides, axis=-1).max())
    _require_inside(mesh, place)
    squared = ((operators.nodes - place) ** 2).sum(axis=1)
    gaussian = np.exp(-squared / (2 * radius**2))
    return np.asarray(gaussian * _component_of(operators, place))


def _component_of(operators: Operators, place: FloatArray) -> FloatArray:
    """Return 1 at the nodes of the component that contains a place, 0 elsewhere."""
    _, labels = connected_components(operators.stiffness, directed=False)
    nearest = int(((operators.nodes - place) ** 2).sum(axis=1).argmin())
    return np.asarray(labels == labels[nearest], dtype=np.float64)


def _require_inside(mesh: VolumeMesh, place: FloatArray) -> None:
    """Raise an error unless a place lies on the inner side of all facets of an element."""
    corners = mesh.points[mesh.cells]
    if mesh.dim == 2:
        sides = np.roll(corners, -1, axis=1) - corners
        to_place = place - corners
        outside = sides[..., 1] * to_place[..., 0] - sides[..., 0] * to_place[..., 1]
    else:
        a, b, c, d = np.moveaxis(corners[:, HEX_FACETS], 2, 0)
        normals = np.cross(c - a, d - b)  # Of the mean plane; facets of balls are not flat.
        outside = np.einsum("mfi,mfi->mf", normals, place - (a + b + c + d) / 4)
    slack = 1e-9 * np.abs(outside).max(initial=0.0)
    if not (outside <= slack).all(axis=1).any():
        nearest = mesh.points[((mesh.points - place) ** 2).sum(axis=1).argmin()]
        raise SimulationError(
            f"the source {place.tolist()} of model {mesh.name!r} lies outside its mesh",
            where=mesh.name,
            expected=f"a point in the mesh; its nearest point is {nearest.tolist()}",
            remedy="move `simulation.source` into the mesh, or leave it out",
        )


def _deepest_point(mesh: VolumeMesh) -> FloatArray:
    """Return the centre of the element that is farthest from the boundary."""
    boundary = np.unique(mesh.facets.boundary)
    centres = mesh.points[mesh.cells].mean(axis=1)
    distance, _ = cKDTree(mesh.points[boundary]).query(centres)
    return np.asarray(centres[int(distance.argmax())])
