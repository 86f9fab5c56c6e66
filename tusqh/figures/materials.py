"""Draw a mesh of several materials, each in its own colour."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from tusqh.figures import style
from tusqh.figures.material_colours import colours_of, to_rgb
from tusqh.figures.rendering import EDGES, EDGES_BELOW, FRAMES, grid_of, render, show
from tusqh.figures.section import fill_elements, middle_of_a_layer
from tusqh.geometry.upright import Axis
from tusqh.grid import FloatArray
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh

#: Largest number of materials that the legend names, those with the most elements.
_NAMED = 24


def draw_materials(mesh: VolumeMesh, regions: Regions, *, unit: str, up: Axis = "z") -> Figure:
    """Return a figure of a mesh coloured by material; in 3D whole, halved, and in section.

    Parameters
    ----------
    mesh
        The mesh.
    regions
        The material of every element.
    unit
        Unit of length of the mesh.
    up
        Axis that points up in 3D.
    """
    colours = to_rgb(colours_of(regions.names))
    of_element = colours[regions.material]
    lower, upper = mesh.points.min(axis=0), mesh.points.max(axis=0)
    scale, unit = style.length_scale(float((upper - lower).max()), unit)
    if mesh.dim == 2:
        figure, ((axes,),) = style.new_figure(1, 1, width=7.0, height=6.4)
        fill = np.empty(mesh.n_cells, dtype=object)
        fill[:] = [tuple(colour) for colour in of_element]
        style.draw_polygons(axes, mesh.points / scale, mesh.cells, colour=fill, line_width=0.2)
        style.frame(axes, lower / scale, upper / scale, unit)
    else:
        figure, (row,) = style.new_figure(1, 3, width=13.5, height=5.4)
        axis = int(np.argmax(np.abs(FRAMES[up][1])))
        place = middle_of_a_layer(mesh, axis)
        at = f"{'xyz'[axis]} = {place / scale:.4g} {unit}"
        sides = " x ".join(f"{side / scale:.3g}" for side in upper - lower)
        show(row[0], _picture(mesh, of_element, up=up), f"whole, {sides} {unit}")
        show(row[1], _picture(mesh, of_element, up=up, cut=(axis, place)), f"cut open at {at}")
        _draw_section(row[2], mesh, of_element, (axis, place), scale=scale)
        row[2].set_title(f"section at {at}")
        along = [a for a in range(3) if a != axis]
        style.frame(row[2], lower[along] / scale, upper[along] / scale, unit)
        row[2].set_xlabel(f"{'xyz'[along[0]]} [{unit}]")
        row[2].set_ylabel(f"{'xyz'[along[1]]} [{unit}]")
    counts = np.bincount(regions.material).tolist()
    largest = sorted(regions.present, key=lambda r: -counts[r.number - 1])[:_NAMED]
    shown = sorted(largest, key=lambda r: r.number)
    handles = [
        Patch(
            facecolor=colours[r.number - 1],
            edgecolor="#404040",
            label=f"{regions.names[r.number - 1]} ({counts[r.number - 1]:,})",
        )
        for r in shown
    ]
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=min(len(handles), 4 if mesh.dim == 2 else 8),
        frameon=False,
        title="material (number of elements)",
    )
    more = len(regions.present) - len(shown)
    figure.suptitle(
        f"{mesh.name}: {len(regions.present)} materials"
        + (f", {more} of which the legend leaves out" if more else "")
    )
    return figure


def _draw_section(
    panel: Axes, mesh: VolumeMesh, colours: FloatArray, cut: tuple[int, float], *, scale: float
) -> None:
    """Draw the elements that a plane cuts, each in its colour."""
    axis, place = cut
    grid = grid_of(mesh)
    grid.cell_data["element"] = np.arange(mesh.n_cells)
    origin = np.where(np.arange(3) == axis, place, mesh.points.mean(axis=0))
    section = grid.slice(normal="xyz"[axis], origin=origin)
    along = [a for a in range(3) if a != axis]
    fill = list(colours[np.asarray(section.cell_data["element"], dtype=np.int64)])
    fill_elements(panel, section, along, fill, scale=scale)


def _picture(
    mesh: VolumeMesh, colours: FloatArray, *, up: Axis, cut: tuple[int, float] | None = None
) -> Any:
    """Return a picture of a hex mesh, or of its half behind a plane at a place on an axis."""
    grid = grid_of(mesh)
    grid.cell_data["rgb"] = (255 * colours).astype(np.uint8)
    lower, upper = mesh.points.min(axis=0), mesh.points.max(axis=0)
    if cut is not None:
        axis, place = cut
        middles = mesh.points[mesh.cells].mean(axis=1)[:, axis]
        towards = np.array(FRAMES[up][1])[axis]
        grid = grid.extract_cells(np.flatnonzero(towards * middles <= towards * place))
    surface = grid.extract_surface(pass_pointid=False, pass_cellid=False, algorithm=None)
    look: dict[str, Any] = EDGES if mesh.n_cells < EDGES_BELOW else {}
    return render(surface, (lower, upper), up=up, scalars="rgb", rgb=True, **look)
