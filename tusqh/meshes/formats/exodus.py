"""Write Exodus II files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tusqh import __version__
from tusqh.atomic import replacing
from tusqh.extras import require
from tusqh.grid import IntArray
from tusqh.meshes.elements import order_of
from tusqh.meshes.formats.content import Content

#: Number of each local facet of a hex, in the order of `HEX_FACETS`; those of quads are 1 to 4.
_FACES = np.array([4, 2, 1, 3, 5, 6])

#: Middle nodes follow the edges of the bottom, those between bottom and top, and those of the top;
#: then the centre of the hex, of the bottom, the top, and the sides where x and y are smallest and
#: largest.
_EDGES = [
    *((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5)),
    *((2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4)),
]
_CENTRES: list[tuple[int, ...]] = [
    *((), (0, 1, 2, 3), (4, 5, 6, 7), (0, 3, 4, 7)),
    *((1, 2, 5, 6), (0, 1, 4, 5), (2, 3, 6, 7)),
]

#: Largest number of characters in a name, and in a text.
_NAME, _TEXT = 32, 33


def write_exodus(path: Path, content: Content) -> None:
    """Write blocks of elements, side sets, node sets of the same names, and element sets.

    Parameters
    ----------
    path
        File to write.
    content
        Its content.

    Raises
    ------
    MissingExtraError
        netCDF4 is not installed; it comes with the extra `formats`.
    """
    netCDF4 = require("netCDF4", extra="formats")
    with (
        replacing(path) as temporary,
        netCDF4.Dataset(temporary, "w", format="NETCDF3_64BIT_OFFSET") as file,
    ):
        file.title = content.mesh.name
        if content.mesh.unit:
            file.setncattr("unit_of_length", content.mesh.unit)
        file.version = file.api_version = np.float32(5.1)
        file.floating_point_word_size = np.int32(8)
        for name, size in (("len_string", _TEXT), ("len_line", 81), ("four", 4)):
            file.createDimension(name, size)
        file.createDimension("time_step", None)
        file.createVariable("time_whole", "f8", ("time_step",))
        _write_quality(file)
        points = content.nodes.points
        file.createDimension("num_dim", content.dim)
        file.createDimension("num_nodes", len(points))
        file.createVariable("coord", "f8", ("num_dim", "num_nodes"))[:] = points.T
        _write_names(file, "coor_names", "num_dim", list("XYZ"[: content.dim]))
        number = _write_blocks(file, content)
        _write_side_sets(file, content, number)
        sets = content.node_sets
        _write_ids(file, "num_node_sets", "ns", [s.number for s in sets], [s.name for s in sets])
        for k, found in enumerate(sets, start=1):
            file.createDimension(f"num_nod_ns{k}", len(found.nodes))
            rows = file.createVariable(f"node_ns{k}", "i4", (f"num_nod_ns{k}",))
            rows[:] = found.nodes + 1
        groups = content.sets.groups
        names = [group.name for group in groups]
        _write_ids(file, "num_elem_sets", "els", [g.number for g in groups], names)
        for k, group in enumerate(groups, start=1):
            file.createDimension(f"num_ele_els{k}", len(group.elements))
            rows = file.createVariable(f"elem_els{k}", "i4", (f"num_ele_els{k}",))
            rows[:] = np.sort(number[group.elements]) + 1


def _write_blocks(file: Any, content: Content) -> IntArray:
    """Write the blocks of elements; return the number of every element, block by block."""
    blocks, n_nodes = content.sets.blocks, content.element.n_nodes
    number = np.empty(content.mesh.n_cells, dtype=np.int64)
    number[np.concatenate([block.elements for block in blocks])] = np.arange(len(number))
    file.createDimension("num_elem", len(number))
    file.createDimension("num_el_blk", len(blocks))
    names = [_fitting(block.name, f"block_{block.number}") for block in blocks]
    _write_names(file, "eb_names", "num_el_blk", names)
    file.createVariable("eb_status", "i4", ("num_el_blk",))[:] = 1
    ids = file.createVariable("eb_prop1", "i4", ("num_el_blk",))
    ids.setncattr("name", "ID")
    ids[:] = [block.number for block in blocks]
    order = np.arange(n_nodes)
    if content.dim == 3:
        order = order_of(n_nodes, list(range(8)), _EDGES, _CENTRES)
    for k, block in enumerate(blocks, start=1):
        sizes = (f"num_el_in_blk{k}", f"num_nod_per_el{k}")
        file.createDimension(sizes[0], len(block.elements))
        file.createDimension(sizes[1], n_nodes)
        rows = file.createVariable(f"connect{k}", "i4", sizes)
        rows.setncattr("elem_type", f"{'QUAD' if content.dim == 2 else 'HEX'}{n_nodes}")
        rows[:] = content.cells_of(block)[:, order] + 1
    return number


def _write_side_sets(file: Any, content: Content, number: IntArray) -> None:
    sets = content.sets.facets
    _write_ids(file, "num_side_sets", "ss", [s.number for s in sets], [s.name for s in sets])
    for k, found in enumerate(sets, start=1):
        size = (f"num_side_ss{k}",)
        file.createDimension(size[0], len(found.element))
        file.createVariable(f"elem_ss{k}", "i4", size)[:] = number[found.element] + 1
        local = found.local + 1 if content.dim == 2 else _FACES[found.local]
        file.createVariable(f"side_ss{k}", "i4", size)[:] = local


def _write_ids(
    file: Any, dimension: str, prefix: str, numbers: Sequence[int], names: Sequence[str]
) -> None:
    """Write the numbers and names of sets."""
    if not numbers:
        return
    file.createDimension(dimension, len(numbers))
    file.createVariable(f"{prefix}_status", "i4", (dimension,))[:] = 1
    ids = file.createVariable(f"{prefix}_prop1", "i4", (dimension,))
    ids.setncattr("name", "ID")
    ids[:] = numbers
    fitting = [_fitting(n, f"{prefix}_{k}") for n, k in zip(names, numbers, strict=True)]
    _write_names(file, f"{prefix}_names", dimension, fitting)


def _write_quality(file: Any) -> None:
    """Write the record of the program that made the file, without a time."""
    file.createDimension("num_qa_rec", 1)
    record = file.createVariable("qa_records", "S1", ("num_qa_rec", "four", "len_string"))
    for k, text in enumerate(("tusqh", __version__, "", "")):
        record[0, k] = _to_characters(text)


def _write_names(file: Any, variable: str, dimension: str, names: Sequence[str]) -> None:
    named = file.createVariable(variable, "S1", (dimension, "len_string"))
    for k, name in enumerate(names):
        named[k] = _to_characters(name)


def _fitting(name: str, otherwise: str) -> str:
    """Return a name if Exodus has room for it."""
    return name if len(name.encode()) <= _NAME else otherwise


def _to_characters(label: str) -> Any:
    """Return a text as Exodus stores it: single characters, padded with zeros."""
    return np.frombuffer(label.encode().ljust(_TEXT, b"\0"), dtype="S1")
