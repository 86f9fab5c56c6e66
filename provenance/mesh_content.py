"""Read the content of a mesh file, independently of the numbering of points and elements."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from provenance.content import Content, content_of_arrays
from tusqh.grid import FloatArray, IntArray


def content_of_vtk(path: Path) -> Content:
    """Return the content of a VTU file with one kind of element, or of a VTP file.

    In a VTP file the numbering of points and cells matters.

    Parameters
    ----------
    path
        The file.
    """
    import pyvista

    mesh = pyvista.read(path)
    points = np.asarray(mesh.points, dtype=np.float64)
    if isinstance(mesh, pyvista.PolyData):
        arrays = {"points": points, "lines": mesh.lines, "faces": mesh.faces}
        names = {name: [str(v) for v in values] for name, values in mesh.field_data.items()}
        return content_of_arrays({**arrays, **mesh.point_data, **mesh.cell_data, **names})
    cells = np.asarray(mesh.cell_connectivity, dtype=np.int64)
    blocks = [cells.reshape(mesh.n_cells, -1)] if mesh.n_cells else []
    on_cells = {name: [values] for name, values in mesh.cell_data.items()}
    return _of_mesh(points, blocks, dict(mesh.point_data.items()), on_cells)


def content_of_meshio(path: Path) -> Content:
    """Return the content of a Gmsh or Exodus file.

    Parameters
    ----------
    path
        The file.
    """
    import meshio

    mesh = meshio.read(path)
    blocks = [np.asarray(block.data, dtype=np.int64) for block in mesh.cells]
    points = np.asarray(mesh.points, dtype=np.float64)
    return _of_mesh(points, blocks, mesh.point_data, mesh.cell_data)


def _of_mesh(
    points: FloatArray,
    blocks: list[IntArray],
    on_points: dict[str, Any],
    on_cells: dict[str, list[Any]],
) -> Content:
    """Return the content of a mesh, with points sorted by position and elements by corners."""
    # No grid spacing is a multiple of this step, so rounding never decides between neighbours.
    step = max(float(np.ptp(points)) if points.size else 0.0, 1e-300) / 987_654_321.123
    lower = points.min(axis=0, initial=np.inf)
    order = np.lexsort(np.rint((points - lower) / step).T[::-1])
    rank = np.empty(len(points), dtype=np.int64)
    rank[order] = np.arange(len(points))
    arrays: dict[str, Any] = {"points": points[order]}
    arrays |= {f"{name} at points": np.asarray(v)[order] for name, v in on_points.items()}
    for k, cells in enumerate(blocks):
        corners = np.sort(rank[cells], axis=1)
        by_corners = np.lexsort(corners.T[::-1])
        arrays[f"elements {k}"] = corners[by_corners]
        for name, values in on_cells.items():
            arrays[f"{name} in elements {k}"] = np.asarray(values[k])[by_corners]
    return content_of_arrays(arrays)
