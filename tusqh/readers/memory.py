"""Read geometry from objects in memory: arrays, and meshes of trimesh and pyvista."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

import numpy as np

from tusqh.errors import GeometryError
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.readers.surfaces import surfaces_of_dataset, surfaces_of_scene
from tusqh.readers.voxels import image_of, require_stated_shape
from tusqh.settings.voxels import Voxels


def read_object(
    source: Any, *, name: str = "geometry", image: Mapping[str, Any] | None = None
) -> Geometry:
    """Return the geometry in an object in memory.

    Parameters
    ----------
    source
        A mesh or scene of trimesh; a dataset of pyvista; an array of voxels, shape (nx, ny, nz), or
        of pixels, shape (nx, ny); a pair of arrays: points, shape (n, 3), with triangles, shape
        (m, 3), or points, shape (n, 2), with segments, shape (m, 2); or an `Outline`, `Soup` or
        `Image`.
    name
        Name of the geometry in messages.
    image
        The meaning of voxels, see `tusqh.settings.voxels.Voxels`.

    Raises
    ------
    GeometryError
        The source is none of these, or holds no valid geometry.
    """
    if isinstance(source, np.ndarray):
        require_stated_shape(image or {}, where=name)
        return image_of(name, source, name=name, meaning=Voxels(**(image or {}))).geometry
    if image:
        raise _damaged("`image` is given for a source that is not an image", name)
    if isinstance(source, (Outline, Soup, Image)):
        return source
    if _is_of("trimesh", ("Trimesh", "Scene"), source):
        return _from_trimesh(source, name)
    if _is_of("pyvista", ("DataSet",), source):
        return Soup.from_parts(surfaces_of_dataset(source, name=name)[0], name=name)
    if isinstance(source, (tuple, list)) and len(source) == 2:
        points, corners = source
        return _from_arrays(points, corners, name=name)
    raise GeometryError(
        f"an object of type {type(source).__name__} is not a geometry",
        where=name,
        expected="a path, a mesh of trimesh or pyvista, or arrays",
        remedy="write it to a file, or convert it to arrays of points and triangles",
    )


def _is_of(library: str, kinds: tuple[str, ...], source: object) -> bool:
    """Return whether an object belongs to a library, without importing it."""
    module = sys.modules.get(library)
    return module is not None and isinstance(source, tuple(getattr(module, k) for k in kinds))


def _from_trimesh(source: Any, name: str) -> Soup:
    """Return the soup in a mesh or scene of trimesh."""
    import trimesh

    scene = source if isinstance(source, trimesh.Scene) else trimesh.Scene([source])
    try:
        parts, names = surfaces_of_scene(scene)
        return Soup.from_parts(parts, name=name, part_names=names)
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
        raise _damaged("the second array has entries that are not whole numbers", name)
    if points.shape[1] == 3:
        return Soup.from_parts([(points, corners)], name=name)
    if corners.size and not 0 <= corners.min() <= corners.max() < len(points):
        raise _damaged(f"a segment has ends out of the range 0 .. {len(points) - 1}", name)
    chains = np.zeros(len(corners), dtype=np.int64)
    return Outline(points=points, segments=corners, chains=chains, name=name)


def _damaged(found: str, name: str) -> GeometryError:
    """Return the error for arrays that are not a geometry."""
    return GeometryError(
        found,
        where=name,
        expected="points (n, 3) and triangles (m, 3), or points (n, 2) and segments (m, 2)",
        remedy="correct the arrays",
    )
