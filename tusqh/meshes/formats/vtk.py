"""Write VTU files of quadratic elements, and of the boundary with the names of its sets."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tusqh.atomic import replacing
from tusqh.meshes.export import add_numbers
from tusqh.meshes.formats.content import Content


def write_quadratic(path: Path, content: Content) -> None:
    """Write a mesh that does not have the elements of the grid, as binary VTU.

    Every element has the number of its block as `block`; field data name the blocks.

    Parameters
    ----------
    path
        File to write.
    content
        Its content.
    """
    import meshio

    block = np.empty(content.mesh.n_cells, dtype=np.int64)
    for found in content.sets.blocks:
        block[found.elements] = found.number
    data = {"block": [block], "kind": [content.mesh.kind.astype(np.int8)]}
    cells = [(content.element.names[0], content.nodes.cells)]
    out = meshio.Mesh(content.points_in_space(), cells, cell_data=data)
    with replacing(path) as temporary:
        meshio.vtu.write(temporary, out, binary=True)
        add_numbers(temporary, {f"block {b.name}": b.number for b in content.sets.blocks})


def write_boundary(path: Path, content: Content) -> None:
    """Write the facets that are in sets as binary VTU.

    Every facet has the number of its set as `set`, and that of its element in the mesh as
    `element`; field data ``set NAME`` have the number of each.  Sets in which facets are again are
    further cell data with their names, 1 inside.

    Parameters
    ----------
    path
        File to write.
    content
        Its content.
    """
    import meshio

    sets = content.sets.once
    facets, number = content.facets_once()
    sides = len(content.mesh.facets.local)
    row = np.concatenate([found.element * sides + found.local for found in sets])
    order = np.argsort(row, kind="stable")
    used, at = np.unique(facets, return_inverse=True)
    data: dict[str, list[object]] = {"set": [number], "element": [row // sides]}
    for found in content.sets.facets:
        if found.is_repeated and "|" not in found.name:
            own = found.element * sides + found.local
            inside = np.zeros(len(row), dtype=np.int8)
            inside[order[np.searchsorted(row[order], own)]] = 1
            data[found.name] = [inside]
    cells = [(content.element.names[1], at.reshape(facets.shape))]
    out = meshio.Mesh(content.points_in_space()[used], cells, cell_data=data)
    with replacing(path) as temporary:
        meshio.vtu.write(temporary, out, binary=True)
        add_numbers(temporary, {f"set {found.name}": found.number for found in sets})
