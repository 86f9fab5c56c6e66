"""Draw a mesh with its named sets of facets, each in its own colour."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from tusqh.figures import style
from tusqh.figures.material_colours import material_colours, to_rgb
from tusqh.figures.rendering import EDGES, EDGES_BELOW, render, show
from tusqh.geometry.upright import Axis as UpAxis
from tusqh.meshes.sets import FacetSet, NamedSets
from tusqh.meshes.volume_mesh import VolumeMesh

#: Most sets that the legend names.
_NAMED = 24


def draw_sets(mesh: VolumeMesh, sets: NamedSets, *, up: UpAxis = "z") -> Figure:
    """Return a figure of a mesh with the planes of its box and its walls, and with its patches.

    Planes are in the colour of the material; walls of holes and others, and the smooth patches of a
    fitted mesh, have colours of their own.  Holes have their numbers.

    Parameters
    ----------
    mesh
        The mesh.
    sets
        Its named sets.
    up
        Axis that points up in 3D.
    """
    patches = [found for found in sets.facets if found.kind == "patch"]
    shown = [sets.once, *([patches] if patches else [])]
    lower, upper = mesh.points.min(axis=0), mesh.points.max(axis=0)
    figure, (panels,) = style.new_figure(1, len(shown), width=7.0 * len(shown), height=7.2)
    sides = " x ".join(f"{side:.4g}" for side in upper - lower)
    titles = [f"{mesh.name}: {mesh.n_cells:,} elements, {sides}", "smooth patches"]
    for axes, some, title in zip(panels, shown, titles, strict=False):
        _draw(axes, mesh, some, title, up)
    return figure


def _draw(axes: Axes, mesh: VolumeMesh, sets: Sequence[FacetSet], title: str, up: UpAxis) -> None:
    """Draw a mesh with some sets, of which planes have the colour of the material."""
    coloured = [found for found in sets if found.kind != "plane"]
    colours = material_colours(len(coloured))
    colour_of = {found.name: colour for found, colour in zip(coloured, colours, strict=True)}
    facets = np.concatenate([found.corners for found in sets])
    chosen = [colour_of.get(found.name, style.MATERIAL) for found in sets]
    rgb = np.repeat(to_rgb(chosen), [len(found.element) for found in sets], axis=0)
    lower, upper = mesh.points.min(axis=0), mesh.points.max(axis=0)
    holes = [found for found in sets if found.kind == "hole"][:_NAMED]
    at = [mesh.points[found.corners].mean(axis=(0, 1)) for found in holes]
    numbers = [found.name.removeprefix("hole_") for found in holes]
    if mesh.dim == 2:
        style.draw_polygons(axes, mesh.points, mesh.cells, colour=style.MATERIAL, line_width=0.2)
        axes.add_collection(LineCollection(list(mesh.points[facets]), colors=rgb, linewidths=2))
        style.frame(axes, lower, upper, "units of the file")
        axes.xaxis.set_major_locator(MaxNLocator(4))
        axes.set_title(title, fontsize=9)
        for place, number in zip(at, numbers, strict=True):
            axes.text(
                float(place[0]),
                float(place[1]),
                number,
                ha="center",
                va="center",
                fontweight="bold",
            )
    else:
        look: dict[str, Any] = EDGES if mesh.n_cells < EDGES_BELOW else {}
        surface = _surface(mesh, facets, rgb)
        labels = dict(zip(numbers, at, strict=True))
        picture = render(
            surface, (lower, upper), up=up, labels=labels, scalars="rgb", rgb=True, **look
        )
        show(axes, picture, title)
    handles = [
        Patch(facecolor=colour_of[found.name], edgecolor="#404040", label=found.name)
        for found in coloured[:_NAMED]
    ]
    if handles:
        below = (0.5, -0.02 if mesh.dim == 3 else -0.12)
        axes.legend(
            handles=handles, loc="upper center", bbox_to_anchor=below, ncols=5, frameon=False
        )


def _surface(mesh: VolumeMesh, facets: Any, rgb: Any) -> Any:
    import pyvista

    faces = np.column_stack([np.full(len(facets), 4), facets]).ravel()
    surface = pyvista.PolyData(mesh.points, faces=faces)
    surface.cell_data["rgb"] = (255 * rgb).astype(np.uint8)
    return surface
