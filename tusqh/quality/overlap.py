"""Measure the overlap of the elements of a 2D mesh."""

from __future__ import annotations

from tusqh.meshes.volume_mesh import VolumeMesh


def measure_overlap(mesh: VolumeMesh) -> float:
    """Return the share of the total element area that is covered more than once in a 2D mesh.

    Parameters
    ----------
    mesh
        Quads in the plane.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [3, 0], [3, 2], [1, 2]])
    >>> measure_overlap(VolumeMesh.from_arrays(points, [[0, 1, 2, 3], [4, 5, 6, 7]]))
    0.25
    """
    import shapely

    quads = shapely.polygons(mesh.points[mesh.cells] - mesh.points[0])
    total = float(shapely.area(quads).sum())
    return (total - float(shapely.union_all(quads).area)) / total
