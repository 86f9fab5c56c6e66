"""Cover the whole boundary of a mesh of hexes with one layer of hexes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.meshes.element_mesh import ElementMesh


class Pillowed(NamedTuple):
    """A mesh with a layer of hexes on its boundary.

    Parameters
    ----------
    points
        Coordinates, those of the mesh first; new points lie where the boundary was, shape (n, 3).
    cells
        Corners of the hexes, those of the mesh first, shape (m, 8).
    covers
        The element that each hex of the layer covers, shape (boundary facets,).
    facets
        Corners of the new boundary, facing outwards, shape (boundary facets, 4).
    inside
        The points that were on the boundary and are inside now, shape (b,).
    outside
        The new point of each of them, shape (b,).
    """

    points: FloatArray
    cells: IntArray
    covers: IntArray
    facets: IntArray
    inside: IntArray
    outside: IntArray


def pillow(mesh: ElementMesh, is_covered: BoolArray | None = None) -> Pillowed:
    """Return a mesh with one more hex on every boundary facet.

    Components and their holes and voids stay as they are, because the layer is the boundary times
    an interval.  The new points are where the old ones are: the hexes of the layer have no volume
    until the points inside move.

    Parameters
    ----------
    mesh
        The mesh, whose boundary is a manifold.
    is_covered
        Boundary facets that get a hex, whole surfaces of the boundary, in the order of
        `mesh.facets.boundary`; None: all.

    Examples
    --------
    >>> import numpy as np
    >>> from tusqh.meshes.volume_mesh import VolumeMesh
    >>> points = np.array([[i, j, k] for k in (0.0, 1.0)
    ...                    for i, j in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))])
    >>> pillowed = pillow(VolumeMesh.from_arrays(points, np.arange(8)[None]))
    >>> len(pillowed.points), len(pillowed.cells)
    (16, 7)
    """
    facets = mesh.facets.boundary
    element = mesh.facets.cell[np.flatnonzero(mesh.facets.on_boundary)]
    chosen = np.ones(len(facets), dtype=np.bool_) if is_covered is None else is_covered
    inside = np.unique(facets[chosen])
    new = np.arange(len(mesh.points))
    new[inside] = len(mesh.points) + np.arange(len(inside))
    covered = facets[chosen]
    layer = np.concatenate([covered, new[covered]], axis=1)
    return Pillowed(
        points=np.concatenate([mesh.points, mesh.points[inside]]),
        cells=np.concatenate([mesh.cells, layer]),
        covers=element[chosen],
        facets=new[facets],
        inside=inside,
        outside=new[inside],
    )
