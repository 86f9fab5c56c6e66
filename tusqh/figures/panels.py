"""Draw a model and its meshes at eight thresholds, as in the paper's 3 x 3 figures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from tusqh.figures import style
from tusqh.figures.rendering import EDGES, EDGES_BELOW, polydata_of, render, show, surface_of
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
    panels = axes.ravel()
    picture = render(polydata_of(geometry), box, up=up, color="#d9c9a3")
    show(panels[0], picture, f"the model: {size}, {sides} {unit}")
    for panel, mesh, threshold in zip(panels[1:], meshes, thresholds, strict=False):
        title = f"threshold {threshold:g}: "
        if mesh is None:
            panel.set_axis_off()
            panel.set_title(title + "no cell", fontsize=9)
            continue
        betti = mesh.measurement.by_euler
        numbers = ", ".join(rf"$\beta_{k}$ = {number}" for k, number in enumerate(betti))
        picture = render(
            surface_of(mesh),
            box,
            up=up,
            scalars="rgb",
            rgb=True,
            **(EDGES if mesh.n_cells < EDGES_BELOW else {}),
        )
        show(panel, picture, title + numbers)
    for panel in panels[len(meshes) + 1 :]:
        panel.set_axis_off()
    handles = [
        Patch(color=style.MATERIAL, label="grid cells"),
        Patch(color=style.CONNECTING, label="connecting templates"),
        Patch(color=style.SEPARATING, label="separating templates"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    figure.suptitle(f"{name} at rising thresholds")
    return figure
