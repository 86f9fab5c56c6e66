"""Extract the surfaces in scenes of trimesh and datasets of VTK.

Nothing is merged, closed, oriented or dropped; polygons are cut into triangles.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tusqh.errors import GeometryError
from tusqh.extras import require
from tusqh.geometry.boundary_chain import match_points
from tusqh.geometry.remark import Remark
from tusqh.geometry.soup import Part
from tusqh.grid import IntArray

#: Dimension of the VTK cell types with a fixed shape.
_DIMENSIONS = {
    **dict.fromkeys((1, 2), 0),
    **dict.fromkeys((3, 4, 21, 35, 60, 68), 1),
    **dict.fromkeys((5, 6, 7, 8, 9, 22, 23, 28, 30, 34, 36, 61, 62, 63, 69, 70, 76, 77), 2),
    **dict.fromkeys((10, 11, 12, 13, 14, 15, 16, 24, 25, 26, 27, 29, 31, 32, 33, 37, 42), 3),
    **dict.fromkeys((64, 65, 66, 67, 71, 72, 73, 74, 75, 78, 79, 80, 81), 3),
}
#: Number of corners of the cell types for which it is fixed.
_CORNERS = {1: 1, 3: 2, 5: 3, 8: 4, 9: 4, 10: 4, 11: 8, 12: 8, 13: 6, 14: 5, 15: 10, 16: 12}
_CORNERS |= {21: 3, 22: 6, 23: 8, 24: 10, 25: 20, 26: 15, 27: 13, 28: 9, 29: 27}


def surfaces_of_scene(scene: Any) -> tuple[list[Part], list[str]]:
    """Return the meshes of a scene, placed as in the scene, and the names of their nodes.

    Parameters
    ----------
    scene
        A `trimesh.Scene`.

    Returns
    -------
    surfaces, names
        Points and triangles of every mesh, and the name of its node.

    Raises
    ------
    ValueError
        A triangle has a corner that its part does not have.
    """
    surfaces, names = [], []
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
        names.append(str(mesh.metadata.get("node", "")))
    return surfaces, names


def surfaces_of_dataset(dataset: Any, *, name: str = "dataset") -> tuple[list[Part], list[Remark]]:
    """Return the surface of a dataset, or the boundary of a volume mesh.

    Parameters
    ----------
    dataset
        A `pyvista.DataSet`.
    name
        The file, for messages.

    Returns
    -------
    parts : list
        Points and triangles.
    remarks : list of Remark
        Remarks on boundary elements of volume cells, which would count twice, and on lines and
        points.

    Raises
    ------
    GeometryError
        The dataset is an image (whose surface would be a box), or has damaged cells.
    """
    pyvista = require("pyvista", extra="formats")
    if isinstance(dataset, (pyvista.ImageData, pyvista.RectilinearGrid)):
        shape = " x ".join(str(n) for n in dataset.dimensions)
        raise GeometryError(
            f"it holds an image of {shape} points, and an image is not a surface",
            where=name,
            expected="a surface or a volume mesh",
            remedy="write it as an image: VTI, NPY, NRRD or TIFF",
        )
    remarks: list[Remark] = []
    if isinstance(dataset, pyvista.UnstructuredGrid):
        dataset, remarks = _without_boundary_elements(dataset, name)
    if isinstance(dataset, pyvista.PolyData):
        for cells in (dataset.GetPolys(), dataset.GetStrips()):
            _require_corners(cells, dataset.n_points, name)
    else:
        dataset = dataset.extract_surface(pass_pointid=False, pass_cellid=False, algorithm=None)
    faces = dataset.triangulate().faces.reshape(-1, 4)[:, 1:]
    part = np.asarray(dataset.points, dtype=np.float64), np.asarray(faces, dtype=np.int64)
    return [part], remarks


def _without_boundary_elements(dataset: Any, name: str) -> tuple[Any, list[Remark]]:
    """Return an unstructured grid without faces that its volume cells already have."""
    cells = dataset.GetCells()
    corners = _array(cells.GetConnectivityArray())
    offsets = _array(cells.GetOffsetsArray())
    _require_corners(cells, dataset.n_points, name)
    kinds, counts = np.asarray(dataset.celltypes), np.diff(offsets)
    for kind in np.unique(kinds).tolist():
        wanted = _CORNERS.get(kind)
        if kind not in _DIMENSIONS or (wanted and (counts[kinds == kind] != wanted).any()):
            raise _damaged_cells(f"cells of type {kind} are unknown or have missing corners", name)
    dimension = np.array([_DIMENSIONS[kind] for kind in kinds.tolist()], dtype=np.int64)
    n_low = int((dimension < 2).sum())
    remarks = [Remark("left out", "lines and points", n_low)] if n_low else []
    is_solid = dimension == 3
    if is_solid.all() or not is_solid.any():
        return dataset, remarks
    number = match_points(np.asarray(dataset.points, dtype=np.float64))[1]
    cell = np.repeat(np.arange(len(kinds)), counts)
    is_of_solid = np.zeros(len(number), dtype=np.bool_)
    is_of_solid[number[corners[is_solid[cell]]]] = True
    n_apart = np.bincount(cell, weights=~is_of_solid[number[corners]], minlength=len(kinds))
    is_element = (dimension == 2) & (n_apart == 0)
    if is_element.any():
        what = "boundary elements of volume cells"
        remarks.append(Remark("left out", what, int(is_element.sum())))
        dataset = dataset.extract_cells(np.flatnonzero(~is_element))
    return dataset, remarks


def _array(array: Any) -> IntArray:
    """Return an array of VTK as one of NumPy."""
    return np.asarray(require("pyvista", extra="formats").convert_array(array), dtype=np.int64)


def _require_corners(cells: Any, n_points: int, name: str) -> None:
    """Raise an error if a corner or offset does not exist, because VTK would read out of bounds."""
    corners, offsets = _array(cells.GetConnectivityArray()), _array(cells.GetOffsetsArray())
    ends = offsets[[0, -1]].tolist() if len(offsets) else [0, len(corners)]
    if ends != [0, len(corners)] or (np.diff(offsets) < 0).any():
        raise _damaged_cells(f"offsets do not rise from 0 to {len(corners)}", name)
    if len(corners) and not 0 <= corners.min() <= corners.max() < n_points:
        raise _damaged_cells(f"a corner is out of the range 0 .. {n_points - 1}", name)


def _damaged_cells(found: str, name: str) -> GeometryError:
    """Return the error for cells that VTK cannot hold."""
    return GeometryError(
        found,
        where=name,
        expected="cells of the types of VTK, between points of the file",
        remedy="copy or export the file again; it is damaged",
    )
