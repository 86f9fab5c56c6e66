"""Stage 1: read the geometry from a file or from memory, and describe its defects."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from tusqh.geometry.defects import describe_defects
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry
from tusqh.geometry.packaged import locate
from tusqh.readers.files import read_file
from tusqh.readers.lengths import with_lengths
from tusqh.readers.memory import read_object
from tusqh.readers.reading import Reading
from tusqh.sampling.describe_winding import describe_winding
from tusqh.settings.lengths import Lengths


def ingest(
    source: Any,
    *,
    name: str = "geometry",
    image: Mapping[str, Any] | None = None,
    lengths: Lengths | None = None,
) -> Geometry:
    """Return the geometry from a file or from memory, without any repair.

    Parameters
    ----------
    source
        A path, or ``"package:NAME/FILE"`` for a file of an installed package; a mesh or scene of
        trimesh; a dataset of pyvista; an array of voxels of shape (nx, ny, nz), or of pixels of
        shape (nx, ny); a pair of arrays: points of shape (n, 3) with triangles of shape (m, 3), or
        points of shape (n, 2) with segments of shape (m, 2); or an `Outline`, `Soup` or `Image`.
    name
        Name, in messages, of a geometry from memory.
    image
        For voxels: their size and the meaning of their values, see `tusqh.settings.voxels.Voxels`.
    lengths
        Unit, scale and conversion, see `tusqh.settings.lengths.Lengths`; None: as the file states.

    Raises
    ------
    GeometryError
        The source is none of these, or holds no valid geometry.

    Examples
    --------
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]]
    >>> ingest(square).bounding_box()
    ((0.0, 0.0), (1.0, 1.0))
    """
    return read_source(source, name=name, image=image, lengths=lengths).geometry


def read_source(
    source: Any,
    *,
    name: str = "geometry",
    image: Mapping[str, Any] | None = None,
    lengths: Lengths | None = None,
) -> Reading:
    """Return the geometry from a file or from memory, and remarks on omissions and changes.

    Parameters
    ----------
    source, name, image, lengths
        See `ingest`.

    Returns
    -------
    Reading
        The geometry, and the reader's remarks; a geometry from memory has none.

    Raises
    ------
    GeometryError
        The source is not of a kind that `ingest` accepts, or holds no valid geometry.
    """
    if isinstance(source, (str, Path)):
        return read_file(locate(str(source)), image=image, lengths=lengths)
    reading = Reading(read_object(source, name=name, image=image))
    return with_lengths(reading, lengths or Lengths(), where=name)


def describe_geometry(geometry: Geometry) -> pd.DataFrame:
    """Return the defects of a geometry and the range of its winding number, one row each.

    Parameters
    ----------
    geometry
        The geometry.

    Returns
    -------
    pandas.DataFrame
        With the columns `tusqh.geometry.defect.DEFECT_COLUMNS`.
    """
    defects = describe_defects(geometry)
    if isinstance(geometry, Image):
        return defects
    return pd.concat([defects, describe_winding(geometry)], ignore_index=True)
