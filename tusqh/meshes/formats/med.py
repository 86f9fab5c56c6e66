"""Write MED files of Salome and code_aster, with their own order of hexes and their groups."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tusqh.atomic import replacing
from tusqh.extras import require
from tusqh.grid import IntArray
from tusqh.meshes.elements import order_of
from tusqh.meshes.formats.content import Content

#: Names of the format for elements, by those of meshio.
_TYPES = {
    **{"line": "SE2", "line3": "SE3", "quad": "QU4", "quad8": "QU8", "quad9": "QU9"},
    **{"hexahedron": "HE8", "hexahedron20": "H20", "hexahedron27": "H27"},
}

#: The hexes of MED are mirror images of those of VTK.
_CORNERS = [0, 3, 2, 1, 4, 7, 6, 5]
_EDGES = [
    *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6)),
    *((6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
]
_FACES: list[tuple[int, ...]] = [
    *((0, 1, 2, 3), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0), (4, 5, 6, 7)),
    (),
]

#: Version of the format.
_VERSION = (3, 0, 0)
_NAME, _STEP = "mesh", "-0000000000000000001-0000000000000000001"
#: Characters in the name of a group.
_WIDTH = 80


def write_med(path: Path, content: Content) -> None:
    """Write elements, the facets of all sets, and groups of elements, facets and nodes.

    Parameters
    ----------
    path
        File to write.
    content
        Its content.

    Raises
    ------
    MissingExtraError
        h5py is not installed; it comes with the extra `formats`.
    """
    h5py = require("h5py", extra="formats")
    points = content.nodes.points
    with replacing(path) as temporary, h5py.File(temporary, "w", libver=("earliest", "v108")) as f:
        info = f.create_group("INFOS_GENERALES")
        for key, value in zip(("MAJ", "MIN", "REL"), _VERSION, strict=True):
            info.attrs[key] = np.int32(value)
        step = _write_head(f, content.dim)
        nodes = step.create_group("NOE")
        _describe(nodes)
        _write_array(nodes, "COO", points, len(points))
        families = f.create_group("FAS").create_group(_NAME)
        families.create_group("FAMILLE_ZERO").attrs["NUM"] = np.int32(0)
        sets = {found.name: found.nodes for found in content.node_sets}
        family = _write_families(families, "NOEUD", sets, len(points), sign=1)
        _write_array(nodes, "FAM", family, len(points))
        _write_elements(step, families, content)


def _write_head(file: Any, dim: int) -> Any:
    """Write the description of the mesh, and return the group of its one step."""
    mesh = file.create_group("ENS_MAA").create_group(_NAME)
    for key in ("DIM", "ESP"):
        mesh.attrs[key] = np.int32(dim)
    for key, value in (("REP", 0), ("SRT", 1), ("TYP", 0)):
        mesh.attrs[key] = np.int32(value)
    for key in ("UNT", "UNI"):
        mesh.attrs[key] = np.bytes_("")
    mesh.attrs["NOM"] = np.bytes_("".join(f"{axis:<16}" for axis in "XYZ"[:dim]))
    mesh.attrs["DES"] = np.bytes_("tusqh")
    step = mesh.create_group(_STEP)
    for key, value in (("CGT", 1), ("NDT", -1), ("NOR", -1)):
        step.attrs[key] = np.int32(value)
    step.attrs["PDT"] = -1.0
    return step


def _describe(group: Any) -> None:
    group.attrs["CGT"] = group.attrs["CGS"] = np.int32(1)
    group.attrs["PFL"] = np.bytes_("MED_NO_PROFILE_INTERNAL")


def _write_array(group: Any, name: str, values: Any, n: int) -> None:
    """Write an array, column by column."""
    data = group.create_dataset(name, data=np.asarray(values).ravel(order="F"))
    data.attrs["CGT"] = np.int32(1)
    data.attrs["NBR"] = np.int32(n)


def _write_elements(step: Any, families: Any, content: Content) -> None:
    """Write elements and facets with the families to which they belong."""
    sides = len(content.mesh.facets.local)
    rows = [found.element * sides + found.local for found in content.sets.facets]
    chosen, at, number = np.unique(np.concatenate(rows), return_index=True, return_inverse=True)
    facets = np.concatenate([content.facets_of(found) for found in content.sets.facets])[at]
    cells = content.nodes.cells
    if content.dim == 3:
        cells = cells[:, order_of(cells.shape[1], _CORNERS, _EDGES, _FACES)]
    breaks = np.cumsum([len(row) for row in rows])[:-1]
    sets = dict(zip([f.name for f in content.sets.facets], np.split(number, breaks), strict=True))
    n = len(chosen)
    blocks = [*content.sets.blocks, *content.sets.groups]
    sets |= {block.name: n + block.elements for block in blocks}
    family = _write_families(families, "ELEME", sets, n + len(cells), sign=-1)
    solid, facet = (_TYPES[name] for name in content.element.names)
    group = step.create_group("MAI")
    group.attrs["CGT"] = np.int32(1)
    for kind, nodes, own in ((solid, cells, family[n:]), (facet, facets, family[:n])):
        part = group.create_group(kind)
        _describe(part)
        _write_array(part, "NOD", nodes.astype(np.int32) + 1, len(nodes))
        _write_array(part, "FAM", own, len(nodes))


def _write_families(
    families: Any, kind: str, sets: dict[str, IntArray], n: int, *, sign: int
) -> IntArray:
    """Write one family for each combination of sets that occurs; return that of each member."""
    names = list(sets)
    combination = np.zeros(n, dtype=np.int64)
    known: dict[tuple[int, int], int] = {}
    members: list[tuple[int, ...]] = [()]
    # Add one set after the other: a member's combination and the set give its new combination.
    for k in range(len(names)):
        own = np.asarray(sets[names[k]])
        old, back = np.unique(combination[own], return_inverse=True)
        new = np.empty(len(old), dtype=np.int64)
        for j, before in enumerate(old.tolist()):
            if (before, k) not in known:
                known[before, k] = len(members)
                members.append((*members[before], k))
            new[j] = known[before, k]
        combination[own] = new[back]
    used, number = np.unique(combination, return_inverse=True)
    group = families.create_group(kind)
    value = np.zeros(len(used), dtype=np.int32)
    for k, which_combination in enumerate(used.tolist()):
        if which_combination == 0:
            continue
        value[k] = sign * (k + 1)
        own_names = [names[j] for j in members[which_combination]]
        family = group.create_group(f"FAM_{value[k]}_{own_names[0][:30]}")
        family.attrs["NUM"] = np.int32(value[k])
        in_family = family.create_group("GRO")
        in_family.attrs["NBR"] = np.int32(len(own_names))
        letters = in_family.create_dataset("NOM", (len(own_names),), dtype=f"{_WIDTH}int8")
        for j, name in enumerate(own_names):
            coded = name.encode()[: _WIDTH - 1].ljust(_WIDTH, b"\0")
            letters[j] = np.frombuffer(coded, dtype=np.int8)
    return np.asarray(value[number], dtype=np.int32)
