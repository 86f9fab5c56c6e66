"""Stage 1: the geometry, from a file or from memory, as it is, and what is dirty about it."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tusqh.errors import GeometryError
from tusqh.geometry.defects import describe_defects
from tusqh.geometry.files import Geometry, locate, read_geometry
from tusqh.geometry.image import Image
from tusqh.geometry.image_voxels import describe_voxels
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.geometry.surface_defects import describe_surface_defects
from tusqh.geometry.surfaces import soup_of, surfaces_of_dataset, surfaces_of_scene
from tusqh.sampling.describe_winding import describe_winding


def ingest(
    source: Any, *, name: str = "geometry", image: Mapping[str, float] | None = None
) -> Geometry:
    """Return the geometry in a file or in memory, exactly as it is.

    Parameters
    ----------
    source
        A path, or ``"package:NAME/FILE"`` for a file of an installed package; a mesh or scene of
        trimesh; a dataset of pyvista; an array of voxels of shape (nx, ny, nz); a pair of
        arrays: points of shape (n, 3) with triangles of shape (m, 3), or points of shape (n, 2)
        with segments of shape (m, 2); or an `Outline`, `Soup` or `Image`.
    name
        What messages call a geometry that comes from memory.
    image
        For voxels: `voxel_size`, and the grey values of fraction 0 and 1, `empty` and `full`,
        see `tusqh.geometry.image.Image.from_voxels`.

    Raises
    ------
    GeometryError
        The source is nothing of that, or holds no valid geometry.

    Examples
    --------
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]]
    >>> ingest(square).bounding_box()
    ((0.0, 0.0), (1.0, 1.0))
    """
    if isinstance(source, (str, Path)):
        return read_geometry(locate(str(source)), image=image)
    if isinstance(source, np.ndarray):
        return Image.from_voxels(source, **(image or {}), name=name)
    if image:
        raise _damaged("`image` is given for something that is none", name)
    if isinstance(source, (Outline, Soup, Image)):
        return source
    if _is_of("trimesh", ("Trimesh", "Scene"), source):
        return _from_trimesh(source, name)
    if _is_of("pyvista", ("DataSet",), source):
        return soup_of(surfaces_of_dataset(source), name=name)
    if isinstance(source, (tuple, list)) and len(source) == 2:
        return _from_arrays(*source, name=name)
    raise GeometryError(
        f"an object of type {type(source).__name__} is no geometry",
        where=name,
        expected="a path, a mesh of trimesh or pyvista, or arrays",
        remedy="write it to a file, or convert it to arrays of points and triangles",
    )


def describe(geometry: Geometry) -> pd.DataFrame:
    """Return the defects of a geometry, one row each, the range of the winding number included."""
    if isinstance(geometry, Image):
        return describe_voxels(geometry)
    winding = describe_winding(geometry)
    if isinstance(geometry, Outline):
        winding = winding.rename(columns={"measure": "length_or_width"})
        return pd.concat([describe_defects(geometry), winding], ignore_index=True)
    return pd.concat([describe_surface_defects(geometry), winding], ignore_index=True)


def _is_of(library: str, kinds: tuple[str, ...], source: object) -> bool:
    """Return whether an object belongs to a library, without importing it."""
    module = sys.modules.get(library)
    return module is not None and isinstance(source, tuple(getattr(module, k) for k in kinds))


def _from_trimesh(source: Any, name: str) -> Soup:
    import trimesh

    scene = source if isinstance(source, trimesh.Scene) else trimesh.Scene([source])
    try:
        return soup_of(surfaces_of_scene(scene), name=name)
    except ValueError as error:
        raise _damaged(str(error), name) from error


def _from_arrays(points: Any, corners: Any, *, name: str) -> Geometry:
    """Return the outline or soup of points and of the segments or triangles between them."""
    try:
        if np.iscomplexobj(points):
            raise TypeError("points are complex")
        points = np.asarray(points, dtype=np.float64)
        numbers = np.asarray(corners)
        corners = numbers.astype(np.int64)
    except (TypeError, ValueError) as error:
        raise _damaged(f"the arrays are not numbers: {error}", name) from error
    shapes = points.shape[1:], corners.shape[1:]
    if points.ndim != 2 or corners.ndim != 2 or shapes not in (((2,), (2,)), ((3,), (3,))):
        raise _damaged(f"the arrays have shapes {points.shape} and {corners.shape}", name)
    if (numbers != corners).any():
        raise _damaged("the second array has entries that are no whole numbers", name)
    if points.shape[1] == 3:
        return soup_of([(points, corners)], name=name)
    if corners.size and not 0 <= corners.min() <= corners.max() < len(points):
        raise _damaged(f"a segment has ends out of the range 0 .. {len(points) - 1}", name)
    chains = np.zeros(len(corners), dtype=np.int64)
    return Outline(points=points, segments=corners, chains=chains, name=name)


def _damaged(found: str, name: str) -> GeometryError:
    return GeometryError(
        found,
        where=name,
        expected="points (n, 3) and triangles (m, 3), or points (n, 2) and segments (m, 2)",
        remedy="correct the arrays",
    )
