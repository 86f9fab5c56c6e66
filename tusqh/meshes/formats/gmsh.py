"""Write Gmsh's format 2.2 in ASCII, which OpenFOAM, getfem, NGSolve and deal.II read too."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tusqh.atomic import replacing
from tusqh.meshes.formats.content import Content


def write_gmsh(path: Path, content: Content) -> None:
    """Write physical groups for every set in which facets are once, and for every block.

    Parameters
    ----------
    path
        File to write.
    content
        Its content.
    """
    import meshio

    sets, blocks, dim = content.sets.once, content.sets.blocks, content.dim
    solid, facet = content.element.names
    corners, number = content.facets_once()
    # Numbers of blocks, which start at 1 in other formats, must differ from those of sets here.
    first = int(number.max(initial=0))
    of_cell = np.empty(content.mesh.n_cells, dtype=np.int64)
    for block in blocks:
        of_cell[block.elements] = first + block.number
    names = {found.name: np.array([found.number, dim - 1]) for found in sets}
    names |= {block.name: np.array([first + block.number, dim]) for block in blocks}
    groups = [number, of_cell]
    out = meshio.Mesh(
        content.points_in_space(),
        [(facet, corners), (solid, content.nodes.cells)],
        cell_data={"gmsh:physical": groups, "gmsh:geometrical": groups},
        field_data=names,
    )
    with replacing(path) as temporary:
        # OpenFOAM, getfem, NGSolve and deal.II do not read the binary form.
        meshio.gmsh.write(temporary, out, fmt_version="2.2", binary=False)
