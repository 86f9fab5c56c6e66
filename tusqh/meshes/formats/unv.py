"""Write universal files (UNV) of I-deas, which Salome, gmsh and code_aster read."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from tusqh.atomic import write_text
from tusqh.errors import ConfigError
from tusqh.grid import IntArray
from tusqh.meshes.elements import order_of
from tusqh.meshes.formats.content import Content

#: Type of the element and of its facets by dimension and number of nodes.
_TYPES = {(2, 4): (44, 11), (2, 8): (45, 24), (3, 8): (115, 94), (3, 20): (116, 95)}

#: Types that have a further line, which describes a beam.
_BEAMS = (11, 24)

_EDGES = [
    *((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5)),
    *((2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4)),
]

#: Nodes of quadratic elements in the order of the file, where those of `_EDGES` follow the corners.
_AROUND = {
    3: [0, 2, 1],
    8: [0, 4, 1, 5, 2, 6, 3, 7],
    20: [0, 8, 1, 9, 2, 10, 3, 11, 12, 13, 14, 15, 4, 16, 5, 17, 6, 18, 7, 19],
}

#: Codes of nodes and elements in groups.
_NODE, _ELEMENT = 7, 8


def write_unv(path: Path, content: Content) -> None:
    """Write nodes, elements, the facets of all sets as elements, and groups of both.

    Parameters
    ----------
    path
        File to write.
    content
        Its content.

    Raises
    ------
    ConfigError
        The format does not have the elements.
    """
    kinds = _TYPES.get((content.dim, content.element.n_nodes))
    if kinds is None:
        raise ConfigError(
            f"universal files have no element with {content.element.n_nodes} nodes",
            where=str(path),
            expected="linear elements, or those with 8 nodes in the plane and 20 in space",
            remedy="add --element hex20, or quad8 in the plane",
        )
    solid, facet = kinds
    text = io.StringIO()
    text.write("    -1\n  2411\n")
    points = content.points_in_space()
    form = "%10d         1         1        11\n%25.16E%25.16E%25.16E"
    rows = np.column_stack([np.arange(1, len(points) + 1), points])
    nodes = io.StringIO()
    np.savetxt(nodes, rows, fmt=form)
    text.write(nodes.getvalue().replace("E", "D"))
    text.write("    -1\n    -1\n  2412\n")
    cells = content.nodes.cells
    if content.element.n_nodes == 20:
        cells = cells[:, order_of(20, list(range(8)), _EDGES, [])]
    own = np.empty(len(cells), dtype=np.int64)
    for block in content.sets.blocks:
        own[block.elements] = block.number
    _write_elements(text, solid, 1, own, cells)
    facets, _ = content.facets_once()
    number = _numbers_of_facets(content, len(cells) + 1)
    first, at = np.unique(number, return_index=True)
    everything = np.concatenate([content.facets_of(f) for f in content.sets.facets])
    assert len(first) >= len(facets)
    _write_elements(text, facet, len(cells) + 1, np.ones(len(first), np.int64), everything[at])
    text.write("    -1\n    -1\n  2467\n")
    groups = [(b.name, _ELEMENT, b.elements + 1) for b in content.sets.blocks]
    groups += [(b.name, _ELEMENT, b.elements + 1) for b in content.sets.groups]
    sizes = np.cumsum([len(found.element) for found in content.sets.facets])[:-1]
    for found, numbers in zip(content.sets.facets, np.split(number, sizes), strict=True):
        groups.append((found.name, _ELEMENT, numbers))
    groups += [(f"{n.name}_nodes", _NODE, n.nodes + 1) for n in content.node_sets]
    for k, (name, code, members) in enumerate(groups, start=1):
        _write_group(text, k, name, code, members)
    text.write("    -1\n")
    write_text(path, text.getvalue())


def _numbers_of_facets(content: Content, first: int) -> IntArray:
    """Return the number of the element of every facet of all sets; equal facets are one."""
    sides = len(content.mesh.facets.local)
    row = np.concatenate([f.element * sides + f.local for f in content.sets.facets])
    _, number = np.unique(row, return_inverse=True)
    return np.asarray(first + number, dtype=np.int64)


def _write_elements(
    text: io.StringIO, kind: int, first: int, own: IntArray, nodes: IntArray
) -> None:
    """Write elements of one type."""
    n = nodes.shape[1]
    nodes = nodes[:, _AROUND[n]] if n in _AROUND and kind not in (115, 94, 44) else nodes
    head = np.column_stack([first + np.arange(len(nodes)), own, own])
    form = f"%10d{kind:10d}%10d%10d         7{n:10d}\n"
    form += f"{0:10d}{1:10d}{1:10d}\n" if kind in _BEAMS else ""
    fields = n * ["%10d"]
    form += "\n".join("".join(fields[k : k + 8]) for k in range(0, n, 8))
    np.savetxt(text, np.column_stack([head, nodes + 1]), fmt=form)


def _write_group(text: io.StringIO, number: int, name: str, code: int, members: IntArray) -> None:
    """Write a group, with two members in a line."""
    zeros = 6 * f"{0:10d}"
    text.write(f"{number:10d}{zeros}{len(members):10d}\n{name[:40]}\n")
    entries = [f"{code:10d}{member:10d}         0         0" for member in members.tolist()]
    text.writelines("".join(entries[k : k + 2]) + "\n" for k in range(0, len(entries), 2))
