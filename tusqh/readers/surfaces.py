"""The surfaces in scenes of trimesh and datasets of VTK.

Nothing is merged, closed, oriented or dropped; polygons are cut into triangles.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tusqh.errors import GeometryError
from tusqh.extras import require
from tusqh.geometry.soup import Part


def surfaces_of_scene(scene: Any) -> list[Part]:
    """Return the meshes of a scene, each where the scene places it.

    Parameters
    ----------
    scene
        A `trimesh.Scene`.

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


def surfaces_of_dataset(dataset: Any, *, name: str = "dataset") -> list[Part]:
    """Return the surface of a dataset; of a volume mesh, its boundary.

    Parameters
    ----------
    dataset
        A `pyvista.DataSet`.
    name
        The file, for messages.

    Raises
    ------
    GeometryError
        The dataset is an image, which is a solid box without its values.
    """
    pyvista = require("pyvista", extra="formats")
    if isinstance(dataset, (pyvista.ImageData, pyvista.RectilinearGrid)):
        shape = " x ".join(str(n) for n in dataset.dimensions)
        raise GeometryError(
            f"it holds an image of {shape} points, and an image is not a surface",
            where=name,
            expected="a surface or a volume mesh",
            remedy="write its values as an image: NPY, NRRD or TIFF",
        )
    if not isinstance(dataset, pyvista.PolyData):
        dataset = dataset.extract_surface(pass_pointid=False, pass_cellid=False, algorithm=None)
    faces = dataset.triangulate().faces.reshape(-1, 4)[:, 1:]
    return [(np.asarray(dataset.points, dtype=np.float64), np.asarray(faces, dtype=np.int64))]
