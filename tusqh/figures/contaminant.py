"""Draw the spreading contaminant in six panels, as in the paper."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from tusqh.figures import style
from tusqh.grid import FloatArray, IntArray

#: Number of powers of ten, below the largest concentration, on the colour scale.
_DECADES = 4


def draw_contaminant(
    points: FloatArray,
    cells: IntArray,
    fields: Sequence[FloatArray],
    table: pd.DataFrame,
    *,
    name: str,
    unit: str,
) -> Figure:
    """Return a figure with one panel per snapshot and a common logarithmic colour scale.

    Parameters
    ----------
    points
        Coordinates, shape (n, 2).
    cells
        Quads, shape (m, 4).
    fields
        Concentration at the points for each snapshot, shape (n,).
    table
        One row per snapshot with the columns time_s and concentration_unit.
    name
        The model, for the title.
    unit
        Unit of length of the geometry.
    """
    lower, upper = points.min(axis=0), points.max(axis=0)
    scale, unit = style.length_scale(float((upper - lower).max()), unit)
    lower, upper, points = lower / scale, upper / scale, points / scale
    triangles = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    ratio = (upper[1] - lower[1]) / (upper[0] - lower[0])
    if style.is_wide(lower, upper):
        figure, axes = style.new_figure(3, 2, width=10.5, height=3 * (3.9 * ratio + 0.8) + 0.3)
    else:
        figure, axes = style.new_figure(2, 3, width=10.5, height=2 * (2.45 * ratio + 0.5))
    largest = max(float(field.max()) for field in fields)
    smallest = largest * 10.0**-_DECADES
    norm = LogNorm(smallest, largest)
    images = []
    times = table["time_s"].tolist()
    for panel, field, seconds in zip(axes.ravel(), fields, times, strict=True):
        shown = np.maximum(field, smallest)
        image = panel.tripcolor(
            *points.T, triangles, shown, norm=norm, shading="gouraud", cmap="viridis"
        )
        images.append(image)
        style.frame(panel, lower, upper, unit)
        panel.xaxis.set_major_locator(MaxNLocator(4))
        panel.set_title(style.duration(seconds))
    bar = figure.colorbar(images[0], ax=axes, shrink=0.6, extend="min")
    bar.set_label(f"concentration [{style.unit_text(table['concentration_unit'].iloc[0])}]")
    figure.suptitle(f"{name}: diffusion of a contaminant, no flux through the boundary")
    return figure
