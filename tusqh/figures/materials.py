"""Draw a mesh of several materials, each in its own colour."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from tusqh.figures import style
from tusqh.figures.rendering import EDGES, EDGES_BELOW, render, show
from tusqh.grid import FloatArray
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh

#: Largest number of materials that the legend names.
_NAMED = 24


def draw_materials(mesh: VolumeMesh, regions: Regions, *, unit: str) -> Figure:
    """Return a figure of a mesh coloured by material; in 3D whole, and the half behind a plane.

    Parameters
    ----------
    mesh
        The mesh.
    regions
        The material of every element.
    unit
        Unit of length of the mesh.
    """
    colours = _colours(len(regions.names))
    if mesh.dim == 2:
        figure, ((axes,),) = style.new_figure(1, 1, width=7.0, height=6.4)
        lower, upper = mesh.points.min(axis=0), mesh.points.max(axis=0)
        scale, unit = style.length_scale(float((upper - lower).max()), unit)
        fill = np.empty(mesh.n_cells, dtype=object)
        fill[:] = [tuple(colour) for colour in colours[regions.material]]
        style.draw_polygons(axes, mesh.points / scale, mesh.cells, colour=fill, line_width=0.2)
        style.frame(axes, lower / scale, upper / scale, unit)
    else:
        figure, row = style.new_figure(1, 2, width=10.0, height=5.0)
        for axes, is_cut in zip(row.ravel(), (False, True), strict=True):
            show(axes, _picture(mesh, colours[regions.material], is_cut=is_cut), "")
    shown = regions.present[:_NAMED]
    handles = [Patch(color=colours[r.number - 1], label=regions.names[r.number - 1]) for r in shown]
    figure.legend(handles=handles, loc="outside lower center", ncols=8, frameon=False, fontsize=8)
    more = len(regions.present) - len(shown)
    figure.suptitle(
        f"{mesh.name}: {len(regions.present)} materials"
        + (f", {more} unnamed here" if more else "")
    )
    return figure


def _colours(n: int) -> FloatArray:
    """Return a colour for each of n materials, shape (n, 3)."""
    table = np.array(colormaps["tab20"].colors)  # type: ignore[attr-defined]
    # The table has pairs of a dark and a light colour; take all dark ones first.
    order = np.concatenate([np.arange(0, 20, 2), np.arange(1, 20, 2)])
    return np.asarray(table[order][np.arange(n) % 20])


def _picture(mesh: VolumeMesh, colours: FloatArray, *, is_cut: bool) -> Any:
    """Return a picture of a hex mesh, or of its half behind a plane normal to y."""
    import pyvista

    grid = pyvista.UnstructuredGrid({12: mesh.cells}, mesh.points)
    grid.cell_data["rgb"] = (255 * colours).astype(np.uint8)
    lower, upper = mesh.points.min(axis=0), mesh.points.max(axis=0)
    if is_cut:
        grid = grid.clip(normal=(0, -1, 0), origin=(lower + upper) / 2, crinkle=True)
    surface = grid.extract_surface(pass_pointid=False, pass_cellid=False, algorithm=None)
    look: dict[str, Any] = EDGES | {"edge_color": "#606060"} if mesh.n_cells < EDGES_BELOW else {}
    return render(surface, (lower, upper), scalars="rgb", rgb=True, **look)
