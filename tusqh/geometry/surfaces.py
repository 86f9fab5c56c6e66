"""Surfaces in memory as soups: scenes of trimesh, datasets of VTK, arrays.

Nothing is merged, closed, oriented or dropped; polygons are cut into triangles.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray, IntArray

#: Points and the triangles between them.
Surface = tuple[FloatArray, IntArray]


def soup_of(surfaces: Sequence[Surface], *, name: str) -> Soup:
    """Return the soup whose parts are the given surfaces.

    Raises
    ------
    GeometryError
        As `Soup`: no triangles, corners out of range, not finite, or no extent.

    Examples
    --------
    >>> corner = np.eye(3), np.array([[0, 1, 2]])
    >>> soup_of([corner, corner], name="two").triangles.tolist()
    [[0, 1, 2], [3, 4, 5]]
    """
    first = np.cumsum([0, *(len(points) for points, _ in surfaces)])
    triangles = [t + f for (_, t), f in zip(surfaces, first, strict=False)]
    return Soup(
        points=np.concatenate([np.empty((0, 3)), *(points for points, _ in surfaces)]),
        triangles=np.concatenate([np.empty((0, 3), dtype=np.int64), *triangles]),
        parts=np.repeat(np.arange(len(surfaces)), [len(t) for _, t in surfaces]).astype(np.int64),
        name=name,
    )


def surfaces_of_scene(scene: Any) -> list[Surface]:
    """Return the meshes of a `trimesh.Scene`, each where the scene places it.

    Raises
    ------
    ValueError
        A triangle has a corner that its part does not have.
    """
    surfaces = []
    for mesh in scene.dump(concatenate=False):
        faces = np.asarray(getattr(mesh, "faces", ()), dtype=np.int64).reshape(-1, 3)
        points = np.asarray(mesh.vertices, dtype=np.float64).reshape(-1, 3)
        if (
            len(scene.geometry) > 1
            and faces.size
            and not 0 <= faces.min() <= faces.max() < len(points)
        ):
            raise ValueError(f"a corner is out of the range 0 .. {len(points) - 1} of its part")
        surfaces.append((points, faces))
    return surfaces


def surfaces_of_dataset(dataset: Any) -> list[Surface]:
    """Return the surface of a `pyvista.DataSet`; of a volume mesh, its boundary."""
    import pyvista

    if not isinstance(dataset, pyvista.PolyData):
        dataset = dataset.extract_surface(pass_pointid=False, pass_cellid=False, algorithm=None)
    faces = dataset.triangulate().faces.reshape(-1, 4)[:, 1:]
    return [(np.asarray(dataset.points, dtype=np.float64), np.asarray(faces, dtype=np.int64))]
