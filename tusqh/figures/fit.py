"""Draw a model, its mesh as a staircase of cells, and the mesh whose boundary lies on it."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from tusqh.figures import style
from tusqh.figures.rendering import (
    EDGES,
    EDGES_BELOW,
    grid_of,
    polydata_of,
    render,
    show,
    without_margins,
)
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.geometry.upright import Axis
from tusqh.grid import FloatArray
from tusqh.meshes.volume_mesh import VolumeMesh

#: Colours of scaled Jacobians from 0 to 1, bright at both ends.
_QUALITY = mpl.colormaps["YlGnBu_r"].with_extremes(under="#b3262e")
_LIMITS = Normalize(0.0, 1.0)

#: Colour of the model.
_MODEL = "#d9c9a3"


def draw_fit(
    geometry: Geometry,
    staircase: VolumeMesh,
    fitted: VolumeMesh,
    *,
    name: str,
    unit: str,
    up: Axis = "z",
) -> Figure:
    """Return a figure of four panels: model, staircase, fitted mesh, and quality of its elements.

    Parameters
    ----------
    geometry
        The geometry.
    staircase, fitted
        The mesh before and after its boundary was moved.
    name
        The model, for the title.
    unit
        Unit of length of the geometry.
    up
        Axis that points up, for solids.
    """
    if isinstance(geometry, Outline) or (isinstance(geometry, Image) and geometry.dim == 2):
        figure = _draw_plane(geometry, staircase, fitted, unit)
    else:
        figure = _draw_solid(geometry, staircase, fitted, up)
    least = fitted.measurement.smallest_scaled_jacobian
    figure.suptitle(f"{name}: fitted to the model, smallest scaled Jacobian {least:.2f}")
    return figure


def _titles(staircase: VolumeMesh, fitted: VolumeMesh) -> list[str]:
    kind = "quads" if fitted.dim == 2 else "hexes"
    return [
        f"staircase: {staircase.n_cells:,} {kind}",
        f"fitted: {fitted.n_cells:,} {kind}",
        "scaled Jacobian of its elements",
    ]


def _draw_plane(
    geometry: Outline | Image, staircase: VolumeMesh, fitted: VolumeMesh, unit: str
) -> Figure:
    low, high = staircase.points.min(axis=0), staircase.points.max(axis=0)
    scale, unit = style.length_scale(float((high - low).max()), unit)
    margin = 0.02 * (high - low).max()
    low, high = (low - margin) / scale, (high + margin) / scale
    ratio = float((high - low)[1] / (high - low)[0])
    if style.is_wide(low, high):
        figure, axes = style.new_figure(4, 1, width=9.0, height=4 * (8.0 * ratio + 0.9) + 0.8)
    else:
        rows = 1 if ratio > 2 else 2
        one = 3.9 if rows == 1 else 5.8
        height = rows * (0.8 * one * ratio + 0.9) + 0.5
        figure, axes = style.new_figure(rows, 4 // rows, width=4 * one / rows, height=height)
    panels = axes.ravel()
    quality = _QUALITY(_LIMITS(fitted.jacobians.scaled))
    for panel, mesh, colour, title in zip(
        panels[1:],
        (staircase, fitted, fitted),
        (style.MATERIAL, style.MATERIAL, quality),
        _titles(staircase, fitted),
        strict=True,
    ):
        style.draw_polygons(panel, mesh.points / scale, mesh.cells, colour=colour, line_width=0.25)
        panel.set_title(title)
    for panel in panels:
        lines = style.lines_of(geometry) / scale
        panel.add_collection(
            mpl.collections.LineCollection(list(lines), colors=style.SECTION, linewidths=0.8)
        )
        style.frame(panel, low, high, unit)
    if isinstance(geometry, Outline):
        panels[0].set_title(f"the model: {geometry.n_segments:,} segments")
    else:
        panels[0].set_title(f"the model: {geometry.voxels.size:,} pixels")
    _add_scale(figure, panels[-1])
    return figure


def _draw_solid(
    geometry: Soup | Image, staircase: VolumeMesh, fitted: VolumeMesh, up: Axis
) -> Figure:
    box = geometry.bounding_box()
    edges = EDGES if fitted.n_cells < EDGES_BELOW else {}
    plain: dict[str, Any] = {"color": style.MATERIAL, **edges}
    # Little shade, so that a colour means the same on every side.
    by_quality: dict[str, Any] = {"scalars": "quality", "cmap": _QUALITY, "clim": (0.0, 1.0)}
    by_quality |= {"ambient": 0.85, "diffuse": 0.2, **edges}
    drawn: list[tuple[Any, dict[str, Any]]] = [
        (polydata_of(geometry), {"color": _MODEL}),
        (_surface(staircase, None), plain),
        (_surface(fitted, None), plain),
        (_surface(fitted, fitted.jacobians.scaled), by_quality),
    ]
    pictures = [render(solid, box, up=up, size=(1350, 1180), **look) for solid, look in drawn]
    figure, axes = style.new_figure(2, 2, width=12.0, height=11.0)
    panels, titles = axes.ravel(), ["the model", *_titles(staircase, fitted)]
    for panel, picture, title in zip(panels, without_margins(pictures), titles, strict=True):
        show(panel, picture, title)
    _add_scale(figure, panels[3])
    return figure


def _surface(mesh: VolumeMesh, quality: FloatArray | None) -> Any:
    """Return the boundary of a hex mesh as a pyvista surface, with the quality of its hexes."""
    grid = grid_of(mesh)
    if quality is not None:
        grid.cell_data["quality"] = np.asarray(quality)
    return grid.extract_surface(pass_pointid=False, pass_cellid=False, algorithm=None)


def _add_scale(figure: Figure, panel: Any) -> None:
    """Add the scale of the colours."""
    figure.colorbar(
        ScalarMappable(_LIMITS, _QUALITY), ax=panel, shrink=0.7, label="scaled Jacobian [-]"
    )
