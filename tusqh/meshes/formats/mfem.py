"""Write MFEM's own mesh format."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from tusqh.atomic import write_text
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.facets import HEX_EDGES, HEX_FACETS, QUAD_FACETS
from tusqh.meshes.formats.content import Content
from tusqh.meshes.formats.digits import unit_comment
from tusqh.meshes.quadratic import serendipity_centres


def write_mfem(path: Path, content: Content) -> None:
    """Write attributes of elements and of the boundary, explained in comments.

    The nodes of quadratic elements are written for each element, as MFEM stores discontinuous
    fields; those that elements share are equal.

    Parameters
    ----------
    path
        File to write.
    content
        Its content.
    """
    text, mesh, dim = io.StringIO(), content.mesh, content.dim
    geometry, facet = (3, 1) if dim == 2 else (5, 3)
    text.write(f"MFEM mesh v1.0\n\n{unit_comment(mesh.unit, '#')}# Boundary attributes:\n")
    for found in content.sets.once:
        text.write(f"# {found.number} {found.name}: {found.meaning}\n")
    attribute = np.empty(mesh.n_cells, dtype=np.int64)
    text.write("\n# Attributes of elements:\n")
    for block in content.sets.blocks:
        text.write(f"# {block.number} {block.name}\n")
        attribute[block.elements] = block.number
    text.write(f"\ndimension\n{dim}\n\nelements\n{mesh.n_cells}\n")
    head = np.stack([attribute, np.full(mesh.n_cells, geometry)], axis=1)
    np.savetxt(text, np.hstack([head, mesh.cells]), fmt="%d")
    corners, number = content.facets_once()
    text.write(f"\nboundary\n{len(corners)}\n")
    head = np.stack([number, np.full(len(corners), facet)], axis=1)
    np.savetxt(text, np.hstack([head, corners[:, : 2 ** (dim - 1)]]), fmt="%d")
    text.write(f"\nvertices\n{len(mesh.points)}\n")
    if content.element.is_quadratic:
        text.write(
            "\nnodes\nFiniteElementSpace\n"
            f"FiniteElementCollection: L2_T1_{dim}D_P2\nVDim: {dim}\nOrdering: 1\n\n"
        )
        np.savetxt(text, _nodes_in_rows(content).reshape(-1, dim), fmt="%.17g")
    else:
        text.write(f"{dim}\n")
        np.savetxt(text, mesh.points, fmt="%.17g")
    write_text(path, text.getvalue())


def _nodes_in_rows(content: Content) -> FloatArray:
    """Return all nodes of every element, x first, then y, then z, shape (m, 3**dim, dim)."""
    places = content.nodes.points[content.nodes.cells]
    full = 3**content.dim
    if places.shape[1] < full:
        places = serendipity_centres(places)
    return np.asarray(places[:, _order_in_rows(content.dim)])


def _order_in_rows(dim: int) -> IntArray:
    """Return the nodes of VTK's element with 3**dim nodes in the order of x, then y, then z."""
    corner = np.array([[0, 0], [2, 0], [2, 2], [0, 2]])
    parts = [QUAD_FACETS]
    if dim == 3:
        corner = np.array([[*row, z] for z in (0, 2) for row in corner.tolist()])
        parts = [HEX_EDGES, HEX_FACETS]
    at = [corner, *(corner[part].mean(axis=1) for part in parts), np.ones((1, dim))]
    places = np.concatenate(at).astype(np.int64)
    return np.argsort(places @ 3 ** np.arange(dim))
