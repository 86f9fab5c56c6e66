"""Draw the kept cells at three thresholds, with the Betti numbers of their meshes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from tusqh.antialias.cells import CellSets
from tusqh.figures import style
from tusqh.geometry.image import Image
from tusqh.geometry.outline import Outline


def draw_thresholds(
    cell_sets: CellSets,
    geometry: Outline | Image,
    thresholds: Sequence[float],
    *,
    name: str,
    unit: str,
) -> Figure:
    """Return the paper's figure of a model at several thresholds.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    geometry
        The outline or picture, drawn over the cells.
    thresholds
        The thresholds, each of which gets one panel.
    name
        The model, for the title.
    unit
        Unit of length of the geometry.
    """
    fractions = cell_sets.fractions
    grid = fractions.grid
    scale, unit = style.length_scale(max(grid.shape) * grid.cell_size, unit)
    lower, upper = np.divide(grid.origin, scale), np.divide(grid.upper, scale)
    ratio = (upper[1] - lower[1]) / (upper[0] - lower[0])
    n_panels = len(thresholds)
    if style.is_wide(lower, upper):
        height = n_panels * (6.5 * ratio + 1.0) + 0.6
        figure, axes = style.new_figure(n_panels, 1, width=7.2, height=height)
    else:
        figure, axes = style.new_figure(1, n_panels, width=3.6 * n_panels, height=3.3 * ratio + 0.9)
    for panel, threshold in zip(axes.ravel(), thresholds, strict=True):
        cells = cell_sets.at(threshold)
        is_kept_by_fraction = fractions.cells >= threshold
        for mask, colour in (
            (cells.kept & is_kept_by_fraction, style.MATERIAL),
            (is_kept_by_fraction & ~cells.kept, style.REMOVED),
            (cells.kept & ~is_kept_by_fraction, style.FILLED),
        ):
            corners = np.argwhere(mask)[:, None] + np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
            points = grid.to_points(corners.reshape(-1, 2)) / scale
            quads = np.arange(len(points)).reshape(-1, 4)
            style.draw_polygons(panel, points, quads, colour=colour, line_width=0.15)
        style.draw_outline(panel, geometry, scale)
        style.frame(panel, lower, upper, unit)
        predicted = cells.predicted
        panel.set_title(
            f"threshold {threshold:g}\n"
            rf"$\beta_0$ = {predicted.betti_0}, $\beta_1$ = {predicted.betti_1}"
        )
    handles = [
        Patch(color=style.MATERIAL, label="kept cells"),
        Patch(color=style.REMOVED, label="removed components"),
        Patch(color=style.FILLED, label="filled holes"),
        Patch(color=style.OUTLINE, label="geometry"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False)
    figure.suptitle(f"{name}, {grid.label} cells")
    return figure
