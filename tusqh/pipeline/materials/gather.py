"""Read the materials of a mesh: a file for each, the parts of one file, or an image of labels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.material_fractions import ALL, VOID
from tusqh.errors import ConfigError, GeometryError
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Surface
from tusqh.geometry.remark import Remark
from tusqh.geometry.split_parts import split_parts
from tusqh.pipeline.ingest import read_source
from tusqh.pipeline.materials.part_names import name_parts
from tusqh.readers.formats import suffix_of, suffixes_of
from tusqh.readers.labels import as_whole_numbers
from tusqh.settings.lengths import Lengths
from tusqh.settings.materials import Material
from tusqh.settings.voxels import Voxels


@dataclass(frozen=True)
class Gathered:
    """The materials as they were read.

    Parameters
    ----------
    wishes
        The materials for which something was given, in the user's order.
    surfaces
        Surface or outline of every material, in order of priority; empty for an image.
    image
        The image, whose voxels are labels; None for surfaces.
    remarks
        What the readers left out, changed or noted.
    optional
        Parts of a file that nobody named; they may lie outside the window.
    """

    wishes: tuple[Material, ...]
    surfaces: dict[str, Surface] = field(default_factory=dict)
    image: Image | None = None
    remarks: tuple[Remark, ...] = ()
    optional: tuple[str, ...] = ()


def gather(
    source: Any,
    wishes: Sequence[Material],
    image: Voxels | None = None,
    lengths: Lengths | None = None,
) -> Gathered:
    """Return the materials of a mesh, read from their files.

    Parameters
    ----------
    source
        A list of files or geometries, or a mapping from names to them; one file or geometry, whose
        parts or labels are the materials; an array of labels, shape (nx, ny) or (nx, ny, nz); or
        None if every material names its file.
    wishes
        The materials for which a name, part, label, threshold or target is given.
    image
        For images: size of voxels and channel.
    lengths
        Unit, scale and conversion of all files; None: as they state.

    Raises
    ------
    ConfigError
        A material does not exist, or it is unclear where it comes from.
    GeometryError
        A file cannot be read, or an image has voxels that are not labels.
    """
    if isinstance(source, (list, tuple, Mapping)) and not is_pair(source):
        named = source if isinstance(source, Mapping) else _name_by_file(source)
        surfaces, remarks = {}, list[Remark]()
        for name, given in named.items():
            surfaces[str(name)] = _read_surface(given, str(name), remarks, lengths)
        _require_one_unit(surfaces)
        require_known(wishes, list(surfaces))
        return Gathered(tuple(wishes), surfaces, remarks=tuple(remarks))
    if source is not None:
        meaning = (image or Voxels()).to_dict()
        if _holds_voxels(source):
            # By default, voxels between 0 and 1 are grey values; these keep labels unchanged.
            meaning |= {"empty": 0.0, "full": 1.0}
        reading = read_source(source, image=meaning, lengths=lengths)
        if isinstance(reading.geometry, Image):
            labels = replace(reading.geometry, voxels=_require_labels(reading.geometry))
            _require_no(wishes, ("part", "source"), "an image of labels", "`label` instead")
            return Gathered(tuple(wishes), image=labels, remarks=reading.remarks)
        return _gather_parts(reading.geometry, wishes, reading.remarks, lengths)
    return _gather_parts(None, wishes, (), lengths)


def is_pair(source: Any) -> bool:
    """Return whether a source is a pair of arrays, points and elements of one geometry.

    Parameters
    ----------
    source
        The source.

    Examples
    --------
    >>> is_pair(([[0, 0], [1, 0]], [[0, 1]])), is_pair(["ring.stl", "ball.stl"])
    (True, False)
    """
    is_two = isinstance(source, (list, tuple)) and len(source) == 2
    return is_two and all(isinstance(entry, (list, tuple, np.ndarray)) for entry in source)


def _holds_voxels(source: Any) -> bool:
    """Return whether a source is an array, or a file with the suffix of an image."""
    if isinstance(source, (str, Path)):
        return suffix_of(source) in suffixes_of("image", "picture")
    return isinstance(source, np.ndarray)


def _gather_parts(
    geometry: Surface | None,
    wishes: Sequence[Material],
    read: tuple[Remark, ...],
    lengths: Lengths | None,
) -> Gathered:
    """Return materials that are parts of one geometry, or of files that they name."""
    _require_no(wishes, ("label",), "not an image of labels", "`part` or `source` instead")
    remarks, cache = list(read), dict[str, list[Surface]]()
    parts = [] if geometry is None else split_parts(geometry)
    placed = [m for m in wishes if m.part is not None or m.source is not None]
    surfaces: dict[str, Surface] = {}
    for material in placed:
        if material.source is not None:
            if material.source not in cache:
                read_geometry = _read_surface(material.source, material.name, remarks, lengths)
                whole = material.part is None
                cache[material.source] = [read_geometry] if whole else split_parts(read_geometry)
            surfaces[material.name] = _part_of(cache[material.source], material)
        else:
            surfaces[material.name] = _part_of(parts, material)
    if not placed:
        surfaces, renamed = name_parts(parts)
        remarks += renamed
    _require_one_unit(surfaces)
    require_known(wishes, list(surfaces))
    wanted = [m.name for m in wishes]
    optional = () if placed else tuple(name for name in surfaces if name not in wanted)
    return Gathered(tuple(wishes), surfaces, remarks=tuple(remarks), optional=optional)


def _require_no(wishes: Sequence[Material], keys: Sequence[str], kind: str, other: str) -> None:
    """Raise a `ConfigError` if a material has a key that does not apply to the geometry."""
    for material in wishes:
        for key in keys:
            if getattr(material, key) is not None:
                raise ConfigError(
                    f"`{key}` of the material {material.name!r}, and the geometry is {kind}",
                    where="materials",
                    expected=f"a material without `{key}`",
                    remedy=f"give {other}, or remove it",
                )


def _part_of(parts: Sequence[Surface], material: Material) -> Surface:
    """Return the part of a geometry that a material names."""
    number = material.part or 1
    if number > len(parts):
        raise ConfigError(
            f"part {number} of {material.source or 'the geometry'}",
            where=f"material {material.name!r}",
            expected=f"a number from 1 to {len(parts)}" if parts else "a geometry",
            remedy="correct `part`; `tusqh mesh FILE --materials` lists all parts"
            if parts
            else "name the file of the material with `source`",
        )
    return parts[number - 1]


def _name_by_file(sources: Sequence[Any]) -> dict[str, Any]:
    """Return files by the names of their stems, and other geometries by their own names."""
    named: dict[str, Any] = {}
    for k, source in enumerate(sources):
        name = Path(source).stem if isinstance(source, (str, Path)) else f"material_{k + 1}"
        if name in named:
            raise ConfigError(
                f"two materials called {name!r}",
                where=str(source),
                expected="a name for each material",
                remedy="rename one of the files, or give a mapping from names to files",
            )
        named[name] = source
    return named


def _require_one_unit(surfaces: Mapping[str, Surface]) -> None:
    """Raise a `GeometryError` if the geometries of a mesh are in different units of length."""
    units = {name: surface.unit for name, surface in surfaces.items()}
    if len(set(units.values())) < 2:
        return
    shown = ", ".join(f"{name}: {unit or 'not stated'}" for name, unit in units.items())
    raise GeometryError(
        f"materials in different units of length ({shown})",
        where="materials",
        expected="one unit for all files of a mesh",
        remedy="convert them all with `convert_to` (--convert-to); a file that states no unit "
        "must first be saved in a format that states it",
    )


def _read_surface(
    source: Any, name: str, remarks: list[Remark], lengths: Lengths | None
) -> Surface:
    """Return the surface or outline of a material."""
    reading = read_source(source, name=name, lengths=lengths)
    remarks += [replace(remark, what=f"{name}: {remark.what}") for remark in reading.remarks]
    if isinstance(reading.geometry, Image):
        raise GeometryError(
            "an image as one of several materials",
            where=name,
            expected="surfaces or outlines, or a single image of labels",
            remedy="give the image alone",
        )
    return reading.geometry


def require_known(wishes: Sequence[Material], names: Sequence[str]) -> None:
    """Raise an error if a material that is wished for does not exist, or has a name of the tables.

    Parameters
    ----------
    wishes
        The materials for which something is given.
    names
        The materials that exist; the void need not be among them.

    Raises
    ------
    ConfigError
        A material does not exist, there is none, or one is called as the tables call all together.
    """
    if ALL in names:
        raise ConfigError(
            f"a material called {ALL!r}",
            where="materials",
            expected=f"another name, since tables call all materials together {ALL!r}",
            remedy="rename the material",
        )
    unknown = [m.name for m in wishes if m.name not in (*names, VOID)]
    if unknown or not names:
        shown = ", ".join(names[:20]) + (", ..." if len(names) > 20 else "")
        raise ConfigError(
            f"no material {', '.join(map(repr, unknown))}" if unknown else "no material",
            where="materials",
            expected=f"one of {shown}" if names else "a geometry, or a `source` for each material",
            remedy="correct the name" if names else "name the files of the materials",
        )


def _require_labels(image: Image) -> NDArray[np.integer]:
    """Return the labels of an image, or raise a `GeometryError`."""
    labels = as_whole_numbers(image.voxels)
    if labels is None:
        is_between = image.voxels != np.rint(image.voxels)
        raise GeometryError(
            f"{int(is_between.sum()):,} of {image.voxels.size:,} voxels are not whole numbers"
            if is_between.any()
            else "voxels that are fractions between 0 and 1, or far too large for labels",
            where=image.name,
            expected="an image of labels, in which every voxel is the number of its material",
            remedy="resample labels with the nearest voxel, because interpolated labels mean "
            "nothing, and store them as integers",
        )
    return labels
