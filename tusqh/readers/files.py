"""Read a geometry file of any format."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

from tusqh.errors import GeometryError, TusqhError, one_line
from tusqh.extras import require
from tusqh.readers.formats import find_format, suffixes_of
from tusqh.readers.gate import check_file
from tusqh.readers.lengths import with_lengths
from tusqh.readers.reading import Reading, UnitSource
from tusqh.readers.voxels import require_stated_shape
from tusqh.settings.field import entries_of
from tusqh.settings.lengths import Lengths
from tusqh.settings.voxels import Voxels

#: Kinds of geometry that consist of grey values or labels.
_WITH_VALUES = ("image", "picture")
_IMAGE_OPTIONS = tuple(entry.name for entry in entries_of(Voxels))


def read_file(
    path: Path, *, image: Mapping[str, Any] | None = None, lengths: Lengths | None = None
) -> Reading:
    """Read a geometry file.

    Nothing is repaired, snapped, closed or merged.

    Parameters
    ----------
    path
        The file; its suffix names the format, see `tusqh.readers.formats.FORMATS`.
    image
        The meaning of an image's voxels, see `tusqh.settings.voxels.Voxels`.
    lengths
        Unit, scale and conversion of its lengths; None: as the file states.

    Returns
    -------
    Reading
        The outline, soup or image in the file.

    Raises
    ------
    GeometryError
        The file is missing, is not a regular file, has a format that contradicts its suffix, does
        not fit in memory, or is damaged; the geometry is empty, without extent or not finite; or
        `image` is given for a file that is not an image; or units contradict each other.
    MissingExtraError
        The library that reads the format is not installed.
    """
    found, lengths = find_format(str(path)), lengths or Lengths()
    _check_options(path, image or {}, is_image=found.kind in _WITH_VALUES)
    if found.module != "spn":
        require_stated_shape(image or {}, where=str(path))
    check_file(path, found)
    if found.library and found.extra:
        require(found.library, extra=found.extra)
    reader = import_module(f"tusqh.readers.{found.module}")
    try:
        is_image = found.kind in _WITH_VALUES
        options: dict[str, Any] = {"meaning": Voxels(**(image or {}))} if is_image else {}
        if found.is_map:
            options["crs"] = lengths.crs
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Remarks, not warnings of libraries, inform the user.
            reading: Reading = reader.read(path, **options)
    except TusqhError:
        raise
    except Exception as error:  # Parsers raise many types of error for a damaged file.
        raise GeometryError(
            f"the file cannot be read: {one_line(str(error)) or type(error).__name__}",
            where=str(path),
            expected=f"a well-formed {path.suffix.lower()} file",
            remedy="open it in the program that wrote it and export it again",
        ) from error
    unit = reading.unit or found.unit
    source: UnitSource = "file" if reading.unit else "format"
    reading = replace(reading, format=found.name, unit=unit, unit_source=source if unit else "none")
    return with_lengths(reading, lengths, where=str(path))


def _check_options(path: Path, image: Mapping[str, Any], *, is_image: bool) -> None:
    """Raise an error for options that the format of a file does not have."""
    if image and not is_image:
        raise GeometryError(
            f"`image` is given for a file of type {path.suffix.lower()!r}",
            where=str(path),
            expected=f"an image: {', '.join(suffixes_of(*_WITH_VALUES))}",
            remedy="remove `image`",
        )
    unknown = sorted(set(image) - set(_IMAGE_OPTIONS))
    if unknown:
        raise GeometryError(
            f"`image` has the unknown option {unknown[0]!r}",
            where=str(path),
            expected=f"one of {', '.join(_IMAGE_OPTIONS)}",
            remedy="correct or remove it",
        )
