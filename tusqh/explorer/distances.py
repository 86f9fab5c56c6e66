"""How far the boundary of a fitted mesh lies from the geometry, for the page to colour it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry
from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid, FloatArray
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.sampling.nearest_triangle import find_nearest, make_tree

#: Distance of the last colour, in cells.
FARTHEST = 0.2
#: Value of facets without a distance; others have 0 to one less.
NONE = 255
#: Facets this near a side of the grid lie on it, in cells.
_ON_SIDE = 1e-6


def boundary_distances(mesh: VolumeMesh, geometry: Geometry, grid: BackgroundGrid) -> FloatArray:
    """Return the distance of every boundary facet from the geometry, in cells, shape (b,).

    It is the largest of that of the corners and of the middle.  All of the geometry counts, trusted
    or not.  Facets on a side of the grid, where a window cuts the material, have NaN, as have all
    facets of an image.

    Parameters
    ----------
    mesh
        The mesh.
    geometry
        The geometry, without repair.
    grid
        The background grid.
    """
    facets = mesh.boundary.corners
    if isinstance(geometry, Image):
        return np.full(len(facets), np.nan)
    points = _in_space(grid.to_lattice(mesh.points))
    pieces = geometry.segments if isinstance(geometry, Outline) else geometry.triangles
    corners = _in_space(grid.to_lattice(geometry.points))[pieces]
    tree = make_tree(corners if corners.shape[1] == 3 else corners[:, [0, 1, 1]])
    used, at = np.unique(facets, return_inverse=True)
    of_corners = find_nearest(tree, points[used]).distance[at.reshape(facets.shape)]
    of_middles = find_nearest(tree, points[facets].mean(axis=1)).distance
    found = np.maximum(of_corners.max(axis=1), of_middles)
    is_on_side = np.zeros(len(facets), dtype=np.bool_)
    for axis, n in enumerate(grid.shape):
        for side in (0, n):
            is_on_side |= (np.abs(points[facets][..., axis] - side) < _ON_SIDE).all(axis=1)
    found[is_on_side & (found > _ON_SIDE)] = np.nan
    return np.asarray(found)


def as_colours(distances: FloatArray) -> NDArray[np.uint8]:
    """Return distances as steps from 0 to `FARTHEST` or more, and `NONE` where there are none.

    Parameters
    ----------
    distances
        Distances in cells, NaN for none.

    Examples
    --------
    >>> as_colours(np.array([0.0, 0.1, 7.0, np.nan])).tolist()
    [0, 127, 254, 255]
    """
    steps = np.clip(np.nan_to_num(distances) / FARTHEST, 0, 1) * (NONE - 1)
    return np.where(np.isnan(distances), NONE, np.rint(steps)).astype(np.uint8)


def _in_space(points: FloatArray) -> FloatArray:
    """Return points with three coordinates."""
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
