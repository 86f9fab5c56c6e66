"""Draw the volume fractions of a dirty outline, its averaged winding number, on all sub-cells."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from tusqh.figures import style
from tusqh.geometry.image import Image
from tusqh.geometry.outline import Outline
from tusqh.sampling.fractions import VolumeFractions


def draw_field(
    fractions: VolumeFractions, geometry: Outline | Image, *, name: str, unit: str
) -> Figure:
    """Return a figure of the fractions on the doubled grid, and of the cell farthest from [0, 1].

    Parameters
    ----------
    fractions
        Volume fractions, which are below 0 or above 1 where borders overlap.
    geometry
        The outline or picture, drawn over them.
    name
        The model, for the title.
    unit
        Unit of length of the geometry.
    """
    grid = fractions.grid
    scale, unit = style.length_scale(max(grid.shape) * grid.cell_size, unit)
    lower, upper = np.divide(grid.origin, scale), np.divide(grid.upper, scale)
    ratio = (upper[1] - lower[1]) / (upper[0] - lower[0])
    reach = np.full(2, 6 * grid.cell_size / scale)
    if style.is_wide(lower, upper):
        # The label of the colour bar needs the least height.
        height = max(2 * (7.6 * ratio + 0.8), 3.6)
        figure, axes = style.new_figure(2, 1, width=9.5, height=height)
        reach *= ratio**-0.5, ratio**0.5
    else:
        figure, axes = style.new_figure(1, 2, width=9.5, height=3.4 * ratio + 0.7)
    whole, close_up = axes.ravel()
    # A node of the doubled grid represents the half cell around it.
    half = grid.cell_size / scale / 4
    extent = (lower[0] - half, upper[0] + half, lower[1] - half, upper[1] + half)
    cells = fractions.cells
    is_clean = (cells == 0) | (cells == 1)
    off = np.where((cells < 0) | (cells > 1), np.abs(cells - np.clip(cells, 0, 1)), 0.0)
    worst = off if off.any() else np.where(is_clean, 0.0, 0.5 - np.abs(cells - 0.5))
    i, j = np.unravel_index(int(worst.argmax()), worst.shape)
    middle = grid.to_points(np.array([[i + 0.5, j + 0.5]]))[0] / scale
    colours = mpl.colormaps["viridis"].with_extremes(
        under=style.BELOW_RANGE, over=style.ABOVE_RANGE
    )
    image: Any = None
    for panel, low, high in (
        (whole, lower, upper),
        (close_up, middle - reach, middle + reach),
    ):
        image = panel.imshow(
            fractions.values.T,
            origin="lower",
            extent=extent,
            vmin=0.0,
            vmax=1.0,
            cmap=colours,
            interpolation="nearest",
        )
        style.draw_outline(panel, geometry, scale)
        style.frame(panel, low, high, unit)
    side = grid.cell_size / scale
    mark = Rectangle(tuple(middle - side / 2), side, side, fill=False, edgecolor="white")
    close_up.add_patch(mark)
    whole.set_title(f"{name}: {grid.label} cells")
    close_up.set_title(
        f"farthest outside [0, 1]: the cell of fraction {cells[i, j]:.3g}"
        if off.any()
        else "a close-up"
    )
    bar = figure.colorbar(image, ax=axes, shrink=0.8, extend="both")
    bar.set_label("volume fraction of cells, edges and vertices [-]")
    return figure
