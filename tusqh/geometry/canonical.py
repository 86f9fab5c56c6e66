"""The canonical geometry file: a binary VTP that ParaView opens, exact to the last bit.

Equal geometries give equal bytes.  The data in a file show which kind of geometry it holds:

* an outline: line cells with cell data ``chain``;
* a soup: triangles with cell data ``part``;
* an image: the edges of its box, with the voxels as field data ``voxels``.

All files hold the name of the geometry as field data, and its unit of length if it is known.
This module imports no reader of other formats.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.atomic import replacing
from tusqh.errors import GeometryError
from tusqh.extras import require
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup

_SUFFIX = ".vtp"
_VOXELS = "voxels"


def write_geometry(path: Path, geometry: Geometry) -> None:
    """Write a geometry as binary VTP; the file appears complete or not at all.

    Parameters
    ----------
    path
        The file, with the suffix ``.vtp``.
    geometry
        The outline, soup or image.

    Raises
    ------
    GeometryError
        The name does not end in ``.vtp``.
    MissingExtraError
        pyvista is not installed.
    """
    _check_suffix(path)
    if isinstance(geometry, Outline):
        data = _from_outline(geometry)
    elif isinstance(geometry, Image):
        data = _from_image(geometry)
    else:
        data = _from_soup(geometry)
    if geometry.unit:
        data.field_data["unit"] = [json.dumps(geometry.unit)]
    with replacing(path) as temporary:
        data.save(temporary, binary=True)


def load_geometry(path: Path) -> Geometry:
    """Return the geometry that `write_geometry` wrote, equal in every bit.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    GeometryError
        The file is missing, or `write_geometry` did not write it.
    MissingExtraError
        pyvista is not installed.
    """
    _check_suffix(path)
    if not path.is_file():
        raise GeometryError(
            "there is no such file",
            where=str(path),
            expected="a canonical geometry file",
            remedy="run the step that makes it, `ingest`",
        )
    with _explaining(path):
        data = require("pyvista", extra="formats").read(path)
        unit = str(json.loads(str(data.field_data["unit"][0]))) if "unit" in data.field_data else ""
        if _VOXELS in data.field_data:
            return replace(_to_image(data), unit=unit)
        if "part" in data.cell_data:
            return replace(_to_soup(data), unit=unit)
        return replace(_to_outline(data), unit=unit)


def _from_outline(outline: Outline) -> Any:
    """Return an outline as line cells."""
    n_points, n_segments = len(outline.points), outline.n_segments
    data = require("pyvista", extra="formats").PolyData(
        np.column_stack([outline.points, np.zeros(n_points)]),
        lines=np.column_stack([np.full(n_segments, 2), outline.segments]).ravel(),
    )
    data.cell_data["chain"] = outline.chains
    if outline.parts is not None:
        data.cell_data["feature"] = outline.parts
    data.field_data["name"] = [json.dumps(outline.name)]  # VTK strings are ASCII.
    data.field_data["part names"] = [json.dumps(outline.part_names)]
    return data


def _to_outline(data: Any) -> Outline:
    """Return the outline in line cells."""
    segments = np.array(data.lines, dtype=np.int64).reshape(-1, 3)[:, 1:]
    has_parts = "feature" in data.cell_data
    return Outline(
        points=np.array(data.points[:, :2], dtype=np.float64),
        segments=segments.copy(),
        chains=np.array(data.cell_data["chain"], dtype=np.int64),
        name=str(json.loads(str(data.field_data["name"][0]))),
        parts=np.array(data.cell_data["feature"], dtype=np.int64) if has_parts else None,
        part_names=tuple(json.loads(str(data.field_data["part names"][0]))),
    )


def _from_soup(soup: Soup) -> Any:
    """Return a soup as triangles."""
    n_triangles = len(soup.triangles)
    faces = np.column_stack([np.full(n_triangles, 3), soup.triangles]).ravel()
    data = require("pyvista", extra="formats").PolyData(soup.points, faces=faces)
    data.cell_data["part"] = soup.parts
    data.field_data["name"] = [json.dumps(soup.name)]
    data.field_data["part names"] = [json.dumps(soup.part_names)]
    return data


def _to_soup(data: Any) -> Soup:
    """Return the soup in triangles."""
    return Soup(
        points=np.array(data.points, dtype=np.float64),
        triangles=data.faces.reshape(-1, 4)[:, 1:].astype(np.int64),
        parts=np.array(data.cell_data["part"], dtype=np.int64),
        name=str(json.loads(str(data.field_data["name"][0]))),
        part_names=tuple(json.loads(str(data.field_data["part names"][0]))),
    )


def _from_image(image: Image) -> Any:
    """Return the box of an image, with its voxels in C order."""
    low, high = image.bounding_box()
    bounds = [x for pair in zip(low, high, strict=True) for x in pair]
    bounds += [0.0, 0.0] * (3 - image.dim)
    data = require("pyvista", extra="formats").Box(bounds).extract_all_edges()
    data.clear_data()
    # VTK has no Boolean type.
    is_boolean = image.voxels.dtype.kind == "b"
    data.field_data[_VOXELS] = (image.voxels.view(np.uint8) if is_boolean else image.voxels).ravel()
    numbers = [image.voxel_size, image.empty, image.full, *image.origin]
    data.field_data["numbers"] = np.array(numbers)
    about = {"name": image.name, "shape": image.shape, "dtype": image.voxels.dtype.str}
    data.field_data["about"] = [json.dumps(about)]
    return data


def _to_image(data: Any) -> Image:
    """Return the image in field data."""
    about = json.loads(str(data.field_data["about"][0]))
    voxel_size, empty, full, *origin = (float(number) for number in data.field_data["numbers"])
    voxels = np.array(data.field_data[_VOXELS]).astype(np.dtype(about["dtype"]))
    return Image(
        voxels=voxels.reshape(about["shape"]),
        voxel_size=voxel_size,
        empty=empty,
        full=full,
        origin=tuple(origin),
        name=about["name"],
    )


@contextmanager
def _explaining(path: Path) -> Iterator[None]:
    """Turn the errors that VTK and NumPy raise for other files into a `GeometryError`."""
    try:
        yield
    except (KeyError, ValueError, AttributeError, IndexError, OSError, RuntimeError) as error:
        raise GeometryError(
            f"the file is not a canonical geometry file: {error}",
            where=str(path),
            expected="a file that `write_geometry` wrote",
            remedy="remove the file and run the step that makes it again",
        ) from error


def _check_suffix(path: Path) -> None:
    """Raise unless a name ends in ``.vtp``."""
    if path.suffix != _SUFFIX:
        raise GeometryError(
            f"the name ends in {path.suffix or 'nothing'!r}",
            where=str(path),
            expected=f"a name that ends in {_SUFFIX}",
            remedy=f"call the file {path.stem}{_SUFFIX}",
        )
