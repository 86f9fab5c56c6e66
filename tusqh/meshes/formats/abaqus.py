"""Write input files of Abaqus and CalculiX."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from tusqh.atomic import write_text
from tusqh.errors import ConfigError
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.formats.content import Content
from tusqh.meshes.formats.digits import near_zero, unit_comment

#: Number of each local facet of a hex, in the order of `HEX_FACETS`; those of quads are 1 to 4.
_FACES = np.array([6, 4, 3, 5, 1, 2])

#: CalculiX reads the first 20 characters of a number and cuts off the rest, even the exponent.
#: A sign, 14 digits, a point and an exponent of three digits need up to 21; "%.13g" needs 20.
_NUMBER = "%.13g"

#: Coordinates smaller than this fraction of the largest extent are written as zeros.
_DUST = 1e-12

#: Most entries in a line.
_IN_A_LINE = 16


def write_abaqus(path: Path, content: Content) -> None:
    """Write elements, node sets, element sets and surfaces; the sets have the names of the table.

    Parameters
    ----------
    path
        File to write.
    content
        Its content.

    Raises
    ------
    ConfigError
        Abaqus does not have the elements.
    """
    if not content.element.abaqus:
        raise ConfigError(
            f"Abaqus has no element with {content.element.n_nodes} nodes",
            where=str(path),
            expected="linear elements, or those with 8 nodes in the plane and 20 in space",
            remedy="add --element C3D20, or CPS8 in the plane",
        )
    text = io.StringIO()
    points, offset = near_zero(content.points_in_space(), "**")
    comments = unit_comment(content.mesh.unit, "**") + offset
    text.write(f"*HEADING\n{content.mesh.name}\n{comments}*NODE\n")
    points = _without_dust(points)
    number = np.arange(1, len(points) + 1)
    form = ["%d"] + 3 * [_NUMBER]
    np.savetxt(text, np.column_stack([number, points]), fmt=form, delimiter=", ")
    for block in content.sets.blocks:
        text.write(f"*ELEMENT, TYPE={content.element.abaqus}, ELSET={_plain(block.name)}\n")
        _write_rows(text, np.column_stack([block.elements + 1, content.cells_of(block) + 1]))
    for group in content.sets.groups:
        text.write(f"*ELSET, ELSET={_plain(group.name)}\n")
        _write_list(text, group.elements + 1)
    for nodes in content.node_sets:
        text.write(f"*NSET, NSET={_plain(nodes.name)}\n")
        _write_list(text, nodes.nodes + 1)
    for found in content.sets.facets:
        name = _plain(found.name)
        local = found.local + 1 if content.dim == 2 else _FACES[found.local]
        text.write(f"** {name}: {found.meaning}\n*SURFACE, TYPE=ELEMENT, NAME={name}\n")
        np.savetxt(text, np.column_stack([found.element + 1, local]), fmt="%d, S%d")
    write_text(path, text.getvalue())


def _plain(name: str) -> str:
    """Return the name of a set of facets or points of several regions in Abaqus."""
    parts = name.split("|")
    return ("_to_" if len(parts) == 2 else "_and_").join(parts)


def _write_rows(text: io.StringIO, rows: IntArray) -> None:
    """Write rows of numbers, in several lines where they are long."""
    if rows.shape[1] <= _IN_A_LINE:
        np.savetxt(text, rows, fmt="%d", delimiter=", ")
        return
    first = ", ".join(_IN_A_LINE * ["%d"])
    rest = ", ".join((rows.shape[1] - _IN_A_LINE) * ["%d"])
    np.savetxt(text, rows, fmt=f"{first},\n{rest}")


def _write_list(text: io.StringIO, numbers: IntArray) -> None:
    """Write numbers, several in a line."""
    for start in range(0, len(numbers), 12):
        text.write(", ".join(map(str, numbers[start : start + 12].tolist())) + "\n")


def _without_dust(points: FloatArray) -> FloatArray:
    """Return coordinates with exact zeros in place of rounding errors."""
    extent = float(np.ptp(points, axis=0).max(initial=0.0))
    return np.where(np.abs(points) < _DUST * extent, 0.0, points)
