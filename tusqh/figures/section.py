"""Draw plane sections of a hex mesh with its geometry over them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from tusqh.figures import style
from tusqh.figures.rendering import grid_of, polydata_of
from tusqh.geometry.image import Image
from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.volume_mesh import GRID_CELL, VolumeMesh

_AXES = "xyz"


def draw_sections(geometry: Soup | Image, mesh: VolumeMesh, *, name: str, unit: str) -> Figure:
    """Return a figure of three sections normal to x, y and z, through the middle of the mesh.

    Where the line of the geometry leaves the elements, the mesh lacks something; where elements
    lie outside the line, it has too much.

    Parameters
    ----------
    geometry
        The geometry; for an image, the faces between full and empty voxels are drawn.
    mesh
        The hex mesh.
    name
        The model, for the title.
    unit
        Unit of length of the geometry.
    """
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    scale, unit = style.length_scale(float((high - low).max()), unit)
    grid, surface = grid_of(mesh), polydata_of(geometry)
    figure, (row,) = style.new_figure(1, 3, width=13.5, height=5.2)
    for normal, panel in enumerate(row):
        place = middle_of_a_layer(mesh, normal)
        origin = np.where(np.arange(3) == normal, place, (low + high) / 2)
        cut = {"normal": _AXES[normal], "origin": origin}
        along = [axis for axis in range(3) if axis != normal]
        section = grid.slice(**cut)
        kinds: IntArray = np.asarray(section.cell_data["kind"] if section.n_cells else [], int)
        colours = [style.MATERIAL if k == GRID_CELL else style.SEPARATING for k in kinds]
        fill_elements(panel, section, along, colours, scale=scale)
        _draw_lines(panel, surface.slice(**cut), along, scale)
        box = np.stack([low, high])[:, along] / scale
        margin = 0.03 * (box[1] - box[0]).max()
        style.frame(panel, box[0] - margin, box[1] + margin, unit)
        panel.set_xlabel(f"{_AXES[along[0]]} [{unit}]")
        panel.set_ylabel(f"{_AXES[along[1]]} [{unit}]")
        # Rounding keeps a plane through the origin from being named by its rounding error.
        digits = 6 - int(np.ceil(np.log10(float((high - low).max()) / scale)))
        shown = round(place / scale, digits) + 0.0
        panel.set_title(f"{_AXES[normal]} = {shown:.4g} {unit}")
    handles = [
        Patch(color=style.MATERIAL, label="elements of the mesh"),
        Patch(color=style.SEPARATING, label="elements of templates"),
        Line2D([], [], color=style.SECTION, label="geometry, as it is"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    figure.suptitle(f"{name}: sections of the mesh and of its geometry")
    return figure


def middle_of_a_layer(mesh: VolumeMesh, axis: int) -> float:
    """Return a coordinate in the middle of the mesh that does not lie on a plane of its grid.

    Parameters
    ----------
    mesh
        The mesh.
    axis
        Axis of the coordinate.
    """
    heights = mesh.points[mesh.cells[:, 0], axis]
    middle = (heights.min() + mesh.points[:, axis].max()) / 2
    ends = mesh.points[mesh.cells][:, :, axis]
    nearest = int(np.abs(ends.mean(axis=1) - middle).argmin())
    return float(ends[nearest].mean())


def fill_elements(
    panel: Axes, section: Any, along: Sequence[int], colours: Sequence[Any], *, scale: float
) -> None:
    """Draw the elements that a plane cuts.

    Parameters
    ----------
    panel
        Where to draw.
    section
        Polygons in a plane, a pyvista surface.
    along
        The two axes of the panel.
    colours
        Colour of every polygon.
    scale
        Number by which lengths are divided.
    """
    points, faces = np.asarray(section.points)[:, along] / scale, np.asarray(section.faces)
    polygons, at = [], 0
    for _ in colours:
        polygons.append(points[faces[at + 1 : at + 1 + faces[at]]])
        at += faces[at] + 1
    panel.add_collection(
        PolyCollection(polygons, facecolors=colours, edgecolors=style.ELEMENT_EDGE, linewidths=0.25)
    )


def _draw_lines(panel: Axes, section: Any, along: list[int], scale: float) -> None:
    """Draw the cut surface of the geometry."""
    if not section.n_cells:
        return
    points: FloatArray = np.asarray(section.points)[:, along] / scale
    pairs = np.asarray(section.lines).reshape(-1, 3)[:, 1:]
    panel.add_collection(
        LineCollection(list(points[pairs]), colors=style.SECTION, linewidths=1.0, zorder=3)
    )
