"""Distances between the boundary of a mesh and the trusted surface, both ways."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.fitting.fitted import DISTANCE_COLUMNS, RESOLVED
from tusqh.fitting.pieces import in_space
from tusqh.fitting.resolved import find_beyond, find_resolved
from tusqh.fitting.skin import unit
from tusqh.fitting.target import Target, to_cells
from tusqh.grid import BoolArray, FloatArray
from tusqh.meshes.element_mesh import ElementMesh
from tusqh.sampling.nearest_triangle import NearestPoints, find_nearest, make_tree

#: Facets this near a plane lie in it, in cells.
_LEVEL = 1e-6


def measure_distances(
    mesh: ElementMesh, target: Target, is_owned: BoolArray | None = None
) -> pd.DataFrame:
    """Return the distances from the boundary to the surface and back.

    Places beyond the end of the surface, as in its holes, do not count.

    Parameters
    ----------
    mesh
        The mesh.
    target
        The surface.
    is_owned
        Boundary facets, in the order of `mesh.facets.boundary`, that should lie on the surface;
        None: all that are not on the sides of the target's box.

    Returns
    -------
    distances
        See `tusqh.fitting.fitted.Fitted`.
    """
    points = to_cells(mesh.points, target.grid)
    facets = mesh.facets.boundary
    is_side = on_sides(points[facets], target).any(axis=1)
    owned = facets[~is_side if is_owned is None else is_owned]
    is_resolved = find_resolved(target)
    everywhere, resolved = [], []
    for at, places in (
        ("vertices", points[np.unique(owned)]),
        ("faces", points[owned].mean(axis=1)),
    ):
        nearest = nearest_on_surface(target, places)
        counts = ~find_beyond(target, places, nearest) & (nearest.triangle >= 0)
        sample = target.sample[nearest.triangle[counts]]
        away = nearest.distance[counts]
        everywhere.append(("boundary", at, away))
        resolved.append((RESOLVED + "boundary", at, away[is_resolved[sample]]))
    back = distances_back(mesh, target)
    everywhere.append(("surface", "samples", back))
    resolved.append((RESOLVED + "surface", "samples", back[is_resolved]))
    rows = []
    for direction, at, values in (*everywhere, *resolved):
        values = values[np.isfinite(values)]
        for name, scale in (("cells", 1.0), ("model", target.grid.cell_size)):
            numbers = [np.nan] * 3
            if len(values):
                numbers = [values.mean(), np.quantile(values, 0.99), values.max()]
            rows.append((direction, at, len(values), name, *(scale * n for n in numbers)))
    return pd.DataFrame(rows, columns=list(DISTANCE_COLUMNS))


def nearest_on_surface(target: Target, places: FloatArray) -> NearestPoints:
    """Return the nearest point on the trusted surface to every place.

    Parameters
    ----------
    target
        The target.
    places
        Places in cells, shape (n, dim).
    """
    return find_nearest(make_tree(_as_triangles(target.pieces)), in_space(places))


def distances_back(mesh: ElementMesh, target: Target) -> FloatArray:
    """Return the distance of every trusted sample from the boundary of a mesh, in cells.

    Parameters
    ----------
    mesh
        The mesh.
    target
        The surface.
    """
    return distances_to_boundary(mesh, target, target.points)


def distances_to_boundary(mesh: ElementMesh, target: Target, places: FloatArray) -> FloatArray:
    """Return the distance of places from the boundary of a mesh, in cells, shape (n,).

    Parameters
    ----------
    mesh
        The mesh.
    target
        The target, for its grid.
    places
        The places, in cells, shape (n, dim).
    """
    points = to_cells(mesh.points, target.grid)
    boundary = make_tree(_as_triangles(_triangles(points[mesh.facets.boundary])))
    return find_nearest(boundary, in_space(places)).distance


def on_sides(corners: FloatArray, target: Target) -> BoolArray:
    """Return to which sides of the target's box facets belong, shape (facets, 2 * dim).

    They lie in the side, or in the plane of the grid that is the nearest to it.

    Parameters
    ----------
    corners
        Corners of the facets, in cells, shape (facets, corners, dim).
    target
        The target.
    """
    dim = corners.shape[2]
    if target.sides is None:
        return np.zeros((len(corners), 2 * dim), dtype=np.bool_)
    found = []
    for axis in range(dim):
        heights = corners[:, :, axis]
        low, high = target.sides[:, axis]
        planes = (low, np.ceil(low - 0.5 - _LEVEL)), (high, np.floor(high + 0.5 + _LEVEL))
        for side, plane in planes:
            away = np.minimum(
                np.abs(heights - side).max(axis=1), np.abs(heights - plane).max(axis=1)
            )
            found.append(away < _LEVEL)
    return np.stack(found, axis=1)


def is_beside_change(corners: FloatArray, target: Target) -> BoolArray:
    """Return which facets of hexes lie beside a cell that was changed on purpose, shape (f,).

    Parameters
    ----------
    corners
        Corners of the facets, in cells, shape (f, 4, 3).
    target
        The target.
    """
    if target.changed is None:
        return np.zeros(len(corners), dtype=np.bool_)
    centre = corners.mean(axis=1)
    normal = unit(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]))
    found = np.zeros(len(corners), dtype=np.bool_)
    upper = np.array(target.grid.shape) - 1
    for way in (-0.25, 0.25):
        place = np.clip(np.floor(centre + way * normal).astype(np.int64), 0, upper)
        found |= target.changed[tuple(place.T)]
    return found


def _triangles(corners: FloatArray) -> FloatArray:
    """Return the two triangles of every quad, or the segments as they are."""
    if corners.shape[1] == 2:
        return corners
    return np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])


def _as_triangles(corners: FloatArray) -> FloatArray:
    """Return triangles in space; segments in the plane become degenerate triangles."""
    if corners.shape[-1] == 3:
        return corners
    return in_space(corners[:, [0, 1, 1]])
