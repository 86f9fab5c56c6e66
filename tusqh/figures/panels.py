"""Draw a model and its meshes at eight thresholds, as in the paper's 3 x 3 figures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from tusqh.figures import style
from tusqh.figures.rendering import (
    EDGES,
    EDGES_BELOW,
    polydata_of,
    render,
    show,
    surface_of,
    without_margins,
)
from tusqh.geometry.image import Image
from tusqh.geometry.soup import Soup
from tusqh.geometry.upright import Axis
from tusqh.meshes.volume_mesh import VolumeMesh


def draw_panels(
    geometry: Soup | Image,
    meshes: Sequence[VolumeMesh | None],
    thresholds: Sequence[float],
    *,
    name: str,
    unit: str,
    up: Axis = "z",
) -> Figure:
    """Return a figure of the model and its mesh at every threshold, with measured Betti numbers.

    Parameters
    ----------
    geometry
        The geometry; for an image, the voxels that are at least half full are drawn.
    meshes
        One hex mesh per threshold; None if no cell is kept.
    thresholds
        Volume-fraction thresholds, dimensionless.
    name
        The model, for the title.
    unit
        Unit of length of the geometry.
    up
        Axis that points up.
    """
    n_rows = -(-(len(meshes) + 1) // 3)
    figure, axes = style.new_figure(n_rows, 3, width=10.5, height=3.1 * n_rows + 0.6)
    box = geometry.bounding_box()
    if isinstance(geometry, Soup):
        size = f"{len(geometry.triangles):,} triangles"
    else:
        size = f"{geometry.voxels.size:,} voxels"
    scale, unit = style.length_scale(max(np.subtract(*box[::-1])), unit)
    sides = " x ".join(f"{side / scale:.3g}" for side in np.subtract(*box[::-1]))
    pictures = [render(polydata_of(geometry), box, up=up, color="#d9c9a3")]
    titles = [f"the model: {size}, {sides} {unit}"]
    for mesh, threshold in zip(meshes, thresholds, strict=True):
        titles.append(f"threshold {threshold:g}: {_numbers(mesh)}")
        edges = EDGES if mesh is not None and mesh.n_cells < EDGES_BELOW else {}
        look: dict[str, Any] = {"scalars": "rgb", "rgb": True, **edges}
        solid = surface_of(mesh) if mesh is not None else None
        pictures.append(render(solid, box, up=up, **look))
    for panel in axes.ravel():
        panel.set_axis_off()
    for panel, picture, title in zip(axes.ravel(), without_margins(pictures), titles, strict=False):
        show(panel, picture, title)
    handles = [
        Patch(color=style.MATERIAL, label="grid cells"),
        Patch(color=style.CONNECTING, label="connecting templates"),
        Patch(color=style.SEPARATING, label="separating templates"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    figure.suptitle(f"{name} at rising thresholds")
    return figure


def _numbers(mesh: VolumeMesh | None) -> str:
    """Return the measured Betti numbers of a mesh as text."""
    if mesh is None:
        return "no cell"
    return ", ".join(rf"$\beta_{k}$ = {n}" for k, n in enumerate(mesh.measurement.by_euler))
