"""Draw a mesh with its named sets of facets, each in its own colour."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from tusqh.figures import style
from tusqh.figures.material_colours import material_colours, to_rgb
from tusqh.figures.rendering import EDGES, EDGES_BELOW, render, show
from tusqh.geometry.upright import Axis
from tusqh.meshes.sets import NamedSets
from tusqh.meshes.volume_mesh import VolumeMesh

#: Most sets that the legend names.
_NAMED = 24


def draw_sets(mesh: VolumeMesh, sets: NamedSets, *, up: Axis = "z") -> Figure:
    """Return a figure of a mesh with the planes of its box and its walls.

    Planes are in the colour of the material; walls of holes and others have colours of their own.

    Parameters
    ----------
    mesh
        The mesh.
    sets
        Its named sets.
    up
        Axis that points up in 3D.
    """
    once = sets.once
    coloured = [found for found in once if found.kind != "plane"]
    colours = material_colours(len(coloured))
    colour_of = {found.name: colour for found, colour in zip(coloured, colours, strict=True)}
    facets = np.concatenate([found.corners for found in once])
    chosen = [colour_of.get(found.name, style.MATERIAL) for found in once]
    rgb = np.repeat(to_rgb(chosen), [len(found.element) for found in once], axis=0)
    lower, upper = mesh.points.min(axis=0), mesh.points.max(axis=0)
    figure, ((axes,),) = style.new_figure(1, 1, width=7.0, height=6.4)
    sides = " x ".join(f"{side:.4g}" for side in upper - lower)
    title = f"{mesh.name}: {mesh.n_cells:,} elements, {sides}"
    if mesh.dim == 2:
        style.draw_polygons(axes, mesh.points, mesh.cells, colour=style.MATERIAL, line_width=0.2)
        axes.add_collection(LineCollection(list(mesh.points[facets]), colors=rgb, linewidths=2))
        style.frame(axes, lower, upper, "units of the file")
        axes.set_title(title, fontsize=9)
    else:
        look: dict[str, Any] = EDGES if mesh.n_cells < EDGES_BELOW else {}
        surface = _surface(mesh, facets, rgb)
        picture = render(surface, (lower, upper), up=up, scalars="rgb", rgb=True, **look)
        show(axes, picture, title)
    handles = [
        Patch(facecolor=colour_of[found.name], edgecolor="#404040", label=found.name)
        for found in coloured[:_NAMED]
    ]
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=6, frameon=False)
    return figure


def _surface(mesh: VolumeMesh, facets: Any, rgb: Any) -> Any:
    import pyvista

    faces = np.column_stack([np.full(len(facets), 4), facets]).ravel()
    surface = pyvista.PolyData(mesh.points, faces=faces)
    surface.cell_data["rgb"] = (255 * rgb).astype(np.uint8)
    return surface
