"""Write bulk data of Nastran."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from tusqh.atomic import write_text
from tusqh.errors import ConfigError
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.elements import order_of
from tusqh.meshes.formats.content import Content
from tusqh.meshes.formats.digits import near_zero, unit_comment

#: Middle nodes follow the edges of the bottom, those between bottom and top, and those of the top.
_EDGES = [
    *((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5)),
    *((2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4)),
]

#: Fields in a line.
_FIELDS = 8


def write_nastran(path: Path, content: Content) -> None:
    """Write nodes, elements with a property for each block, and sets.

    A set of facets is a `SET1` of its nodes and, on hexes, a load `PLOAD4` of pressure 1, both with
    the number of the table of sets.  Comments give the names.

    Parameters
    ----------
    path
        File to write.
    content
        Its content.

    Raises
    ------
    ConfigError
        Nastran does not have the elements.
    """
    element = content.element
    if element.n_nodes in (9, 27):
        raise ConfigError(
            f"Nastran has no element with {element.n_nodes} nodes",
            where=str(path),
            expected="linear elements, or those with 8 nodes in the plane and 20 in space",
            remedy="add --element hex20, or quad8 in the plane",
        )
    text = io.StringIO()
    text.write(f"$ {content.mesh.name}: bulk data, for an INCLUDE\n")
    points, offset = near_zero(content.points_in_space(), "$")
    text.write(unit_comment(content.mesh.unit, "$") + offset)
    _write_nodes(text, points)
    flat = {4: "CQUAD4", 8: "CQUAD8"}
    name = "CHEXA" if content.dim == 3 else flat[element.n_nodes]
    order = np.arange(element.n_nodes)
    if content.dim == 3:
        order = order_of(element.n_nodes, list(range(8)), _EDGES, [])
    for block in content.sets.blocks:
        card = "PSOLID" if content.dim == 3 else "PSHELL"
        text.write(f"$ {block.name}: {block.meaning}; add a MAT1 with the number {block.number}\n")
        text.write(f"{card},{block.number},{block.number}\n")
        own = np.full(len(block.elements), block.number)
        nodes = content.cells_of(block)[:, order] + 1
        _write_cards(text, name, np.column_stack([block.elements + 1, own, nodes]))
    for group in content.node_sets:
        text.write(f"$ {group.name}: {group.meaning}\n")
        _write_set(text, group.number, group.nodes + 1)
    for found in content.sets.facets if content.dim == 3 else ():
        text.write(f"$ {found.name}: pressure 1 on {found.meaning}\n")
        rows = np.column_stack([found.element + 1, found.corners[:, [0, 2]] + 1])
        load = f"PLOAD4  {found.number:8d}%8d     1.0" + 3 * 8 * " " + "%8d%8d"
        np.savetxt(text, rows, fmt=load)
    write_text(path, text.getvalue())


def _write_nodes(text: io.StringIO, points: FloatArray) -> None:
    """Write the nodes in fields of 16 characters."""
    for number, (x, y, z) in enumerate(points.tolist(), start=1):
        text.write(f"GRID*   {number:16d}{'':16}{_field(x)}{_field(y)}\n*       {_field(z)}\n")


def _field(value: float) -> str:
    """Return a real number in 16 characters, with a point.

    Examples
    --------
    >>> _field(60.0), _field(-1.2345678901234e-7), _field(0.1)
    ('            60.0', '-1.234567890E-07', '             0.1')
    """
    text = repr(value)
    if len(text) > 16 or "." not in text:
        text = f"{value:.9E}"
    return f"{text:>16}"


def _write_cards(text: io.StringIO, name: str, rows: IntArray) -> None:
    """Write cards with eight fields in a line."""
    fields = rows.shape[1] * ["%8d"]
    lines = ["".join(fields[k : k + _FIELDS]) for k in range(0, len(fields), _FIELDS)]
    np.savetxt(text, rows, fmt=f"{name:8}" + "\n+       ".join(lines))


def _write_set(text: io.StringIO, number: int, nodes: IntArray) -> None:
    """Write a set of nodes."""
    fields = [f"{number:8d}", *(f"{node:8d}" for node in nodes.tolist())]
    lines = ["".join(fields[k : k + _FIELDS]) for k in range(0, len(fields), _FIELDS)]
    text.write("SET1    " + "\n+       ".join(lines) + "\n")
