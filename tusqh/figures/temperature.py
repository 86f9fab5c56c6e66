"""Draw heat spreading from a hot spot in a volume, in six panels cut open at the spot."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from tusqh.figures import style
from tusqh.figures.rendering import field_on, render, show
from tusqh.geometry.upright import Axis
from tusqh.grid import FloatArray, IntArray

#: Number of powers of ten, below the largest value, on the colour scale.
_DECADES = 4


def draw_temperature(
    points: FloatArray,
    cells: IntArray,
    fields: Sequence[FloatArray],
    table: pd.DataFrame,
    *,
    name: str,
    up: Axis = "z",
) -> Figure:
    """Return a figure with one panel per snapshot and a common logarithmic colour scale.

    Parameters
    ----------
    points
        Coordinates, shape (n, 3).
    cells
        Hexes, shape (m, 8).
    fields
        Density of heat at the points for each snapshot, shape (n,).
    table
        One row per snapshot with the columns time_s and concentration_unit.
    name
        The model, for the title.
    up
        Axis that points up.
    """
    figure, axes = style.new_figure(2, 3, width=10.5, height=6.4)
    largest = float(fields[0].max())
    smallest = largest * 10.0**-_DECADES
    norm = LogNorm(smallest, largest)
    origin = points[int(fields[0].argmax())]
    box = (points.min(axis=0), points.max(axis=0))
    times = table["time_s"].tolist()
    for panel, field, seconds in zip(axes.ravel(), fields, times, strict=True):
        surface = field_on(points, cells, np.log10(np.clip(field, smallest, largest)), origin)
        limits = [np.log10(smallest), np.log10(largest)]
        picture = render(
            surface, box, up=up, scalars="field", clim=limits, cmap="inferno", lighting=False
        )
        show(panel, picture, style.duration(seconds))
    mappable = ScalarMappable(norm=norm, cmap="inferno")
    bar = figure.colorbar(mappable, ax=axes, shrink=0.6, extend="min")
    unit = style.unit_text(table["concentration_unit"].iloc[0])
    bar.set_label(f"density of heat [{unit}]: temperature times volumetric heat capacity")
    figure.suptitle(f"{name}: heat from a hot spot, no flux through the boundary (cut open)")
    return figure
