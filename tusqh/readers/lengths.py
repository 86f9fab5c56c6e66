"""Determine the unit of length of a reading, and convert it."""

from __future__ import annotations

from dataclasses import replace

from tusqh.errors import GeometryError
from tusqh.geometry.remark import Remark
from tusqh.geometry.units import METRES, metres_in, scaled, unit_name
from tusqh.readers.formats import FORMATS
from tusqh.readers.reading import Reading, UnitSource
from tusqh.settings.lengths import Lengths


def with_lengths(reading: Reading, lengths: Lengths, *, where: str) -> Reading:
    """Return a reading whose geometry has the unit, the scale and the conversion of the settings.

    Parameters
    ----------
    reading
        What a reader returned: coordinates as in the file, and the unit that the file or its
        format states.
    lengths
        The settings.
    where
        The file, for messages.

    Raises
    ------
    GeometryError
        The file states another unit than the settings, or the size of a unit is not known.
    """
    if lengths.crs not in (None, "none") and not any(
        found.is_map for found in FORMATS if found.name == reading.format
    ):
        maps = ", ".join(found.name for found in FORMATS if found.is_map)
        raise GeometryError(
            f"`crs` is given for a file of the format {reading.format}",
            where=where,
            expected=f"a map: {maps}",
            remedy="remove `crs`, or save the map in one of these formats",
        )
    stated, given = unit_name(reading.unit), unit_name(lengths.unit or "")
    if stated and given and stated != given:
        raise _contradiction(reading, stated, given, where)
    unit = stated or given
    source: UnitSource = "settings" if given and not stated else reading.unit_source
    target = unit_name(lengths.convert_to or "") or unit
    factor, remarks = lengths.scale, list(reading.remarks)
    if lengths.scale != 1.0:
        remarks.append(Remark("changed", f"scale: lengths multiplied by {lengths.scale:g}", 1))
    if target != unit:
        factor *= _size_of(unit, where, "unit") / _size_of(target, where, "convert_to")
        remarks.append(Remark("changed", f"unit: {unit} converted to {target}", 1))
    geometry = scaled(reading.geometry, factor, unit=target)
    return replace(
        reading, geometry=geometry, remarks=tuple(remarks), unit=target, unit_source=source
    )


def _size_of(unit: str, where: str, key: str) -> float:
    """Return the size of a unit in metres, or raise an error."""
    size = metres_in(unit)
    if size is not None:
        return size
    if not unit:
        raise GeometryError(
            "`convert_to` is given, and the file does not state its unit of length",
            where=where,
            expected="a unit from which to convert",
            remedy="give the unit of the file with `unit`, or `scale` alone",
        )
    raise GeometryError(
        f"the size of the unit {unit!r} is not known",
        where=where,
        expected=f"one of {', '.join(METRES)}",
        remedy=f"correct `{key}`, or multiply the lengths with `scale`",
    )


def _contradiction(reading: Reading, stated: str, given: str, where: str) -> GeometryError:
    """Return the error for two different units of one file."""
    is_format = reading.unit_source == "format"
    says = f"files of the format {reading.format} are in" if is_format else "the file states"
    sizes = metres_in(stated), metres_in(given)
    remedy = "remove `unit`"
    if sizes[0] is not None and sizes[1] is not None:
        factor = f"{sizes[1] / sizes[0]:.9g}"
        remedy += f"; if the file is wrong and its numbers are {given}, give `scale: {factor}` "
        remedy += f"instead, and `convert_to: {given}` for a mesh in {given}"
    return GeometryError(
        f"{says} {stated}, and `unit` is {given}",
        where=where,
        expected="one unit of length",
        remedy=remedy,
    )
