"""Read the size of a voxel in a TIFF file, as stated by ImageJ or OME."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import Any

from tusqh.errors import GeometryError
from tusqh.geometry.remark import Remark

#: Units of length in metres, with the names that OME uses.
_METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "µm": 1e-6, "um": 1e-6, "nm": 1e-9, "pm": 1e-12}
#: Units of the tag ResolutionUnit.
_TAG_UNITS = {2: "inch", 3: "cm"}

#: Side lengths, unit of length (empty if there is none) and remarks.
Sizes = tuple[list[float], str, list[Remark]]


def voxel_sides(where: str, file: Any) -> Sizes:
    """Return the side lengths of a voxel along x, y and z, their unit, and remarks on them.

    Parameters
    ----------
    where
        The file, for messages.
    file
        A `tifffile.TiffFile`.

    Raises
    ------
    GeometryError
        The file states the size along some axes only, or pixels are not square.
    """
    if file.is_ome:
        return _of_ome(where, file.ome_metadata)
    described = file.imagej_metadata or {}
    if not described and file.shaped_metadata:
        described = file.shaped_metadata[0] or {}
    across = [_pixel_side(file.pages[0], f"{axis}Resolution") for axis in "XY"]
    unit = str(described.get("unit", "")).strip()
    spacing = described.get("spacing")
    if spacing is not None or (file.is_imagej and unit not in ("", "pixel", "pixels")):
        is_default = spacing is None and max(abs(side - 1.0) for side in across) > 1e-6
        deep = 0.0 if is_default else abs(float(1.0 if spacing is None else spacing))
        if not deep > 0:
            raise _incomplete(where, [*across, deep])
        return [*across, deep], _named(unit), []
    if abs(across[0] - across[1]) > 1e-6 * max(across):
        raise GeometryError(
            f"a pixel measures {across[0]:g} x {across[1]:g}",
            where=where,
            expected="square pixels",
            remedy="resample the image to cubes, or give `voxel_size` if the tags are wrong",
        )
    return [1.0, 1.0, 1.0], "", _remark_on_resolution(file.pages[0], across[0])


def _of_ome(where: str, text: str) -> Sizes:
    """Return the sizes in the description of OME."""
    root = ET.fromstring(text)
    pixels = next((node for node in root.iter() if node.tag.endswith("}Pixels")), None)
    given = {} if pixels is None else pixels.attrib
    texts = [given.get(f"PhysicalSize{axis}") for axis in "XYZ"]
    if not any(texts):
        return [1.0, 1.0, 1.0], "", []
    units = [given.get(f"PhysicalSize{axis}Unit", "µm") for axis in "XYZ"]
    sides = [float(text or 0) for text in texts]
    if not all(side > 0 for side in sides):
        raise _incomplete(where, sides)
    if len(set(units)) > 1:
        unknown = [unit for unit in units if unit not in _METRES]
        if unknown:
            raise GeometryError(
                f"a voxel is measured in {', '.join(units)}",
                where=where,
                expected="one unit of length",
                remedy="give `voxel_size`",
            )
        lengths = zip(sides, units, strict=True)
        sides = [side * _METRES[unit] / _METRES[units[0]] for side, unit in lengths]
    return sides, _named(units[0]), []


def _pixel_side(page: Any, name: str) -> float:
    """Return the side length of a pixel from a tag, 1 if it states none."""
    tag = page.tags.get(name)
    if tag is None:
        return 1.0
    numerator, denominator = tag.value
    return denominator / numerator if numerator and denominator else 1.0


def _named(unit: str) -> str:
    """Return the name of a unit of length; empty if sizes are in pixels."""
    return "" if unit in ("pixel", "pixels") else unit.replace("\\u00B5", "µ")


def _remark_on_resolution(page: Any, side: float) -> list[Remark]:
    """Return a remark on a resolution that does not state the distance of the pages."""
    tag = page.tags.get("ResolutionUnit")
    unit = _TAG_UNITS.get(int(tag.value) if tag is not None else 1, "unit")
    if side == 1.0:
        return []
    what = f"resolution of {1 / side:g} pixels per {unit}, without a distance of the pages"
    return [Remark("left out", what, 1, "give `voxel_size`")]


def _incomplete(where: str, sides: list[float]) -> GeometryError:
    """Return the error for sizes along some axes only."""
    shown = " x ".join(f"{side:g}" if side > 0 else "(not given)" for side in sides)
    return GeometryError(
        f"a voxel measures {shown}",
        where=where,
        expected="its size along all three axes, or along none",
        remedy="give `voxel_size`",
    )
