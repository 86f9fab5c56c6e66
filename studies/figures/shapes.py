"""Draw panels of cells, elements, sub-cells and geometry from a table of shapes."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from studies.examples import GEOMETRY, INTERIOR_EDGE, INTERIOR_VERTEX, KEPT
from tusqh.figures import style
from tusqh.grid import FloatArray
from tusqh.meshes.volume_mesh import BRIDGE, CONNECTING, GRID_CELL, INNER_CELL, KINDS, SEPARATING

#: Colours of elements by their kind, in the order of the legend.
FILLS = {
    KEPT: style.MATERIAL,
    KINDS[GRID_CELL]: style.MATERIAL,
    KINDS[INNER_CELL]: style.MATERIAL,
    KINDS[SEPARATING]: style.SEPARATING,
    KINDS[CONNECTING]: style.CONNECTING,
    KINDS[BRIDGE]: style.BRIDGE,
}


def draw_shapes(axes: Axes, shapes: pd.DataFrame, title: str) -> None:
    """Draw the shapes of one panel on equal axes, in cells of the grid.

    Parameters
    ----------
    axes
        The axes to draw in.
    shapes
        The shapes of the panel.
    title
        Title of the axes.
    """
    corners = shapes.filter(regex=r"^[xy]\d$").to_numpy().reshape(len(shapes), 4, 2)
    kind = shapes["shape"].to_numpy()
    for shape, fill in FILLS.items():
        axes.add_collection(
            PolyCollection(
                _whole(corners[kind == shape]),
                facecolors=fill,
                edgecolors="#406070",
                linewidths=0.4,
            )
        )
    axes.add_collection(
        PolyCollection(
            _whole(corners[kind == GEOMETRY]),
            facecolors=(0, 0, 0, 0.08),
            edgecolors=style.REMOVED,
            linewidths=0.9,
            zorder=3,
        )
    )
    axes.add_collection(
        LineCollection(
            _whole(corners[kind == INTERIOR_EDGE]), colors=style.INTERIOR_EDGE, linewidths=1.1
        )
    )
    vertices = corners[kind == INTERIOR_VERTEX, 0]
    axes.plot(*vertices.T, "o", mfc="white", color=style.INTERIOR_VERTEX, markersize=2.6, zorder=4)
    everything = corners.reshape(-1, 2)
    low, high = np.nanmin(everything, axis=0), np.nanmax(everything, axis=0)
    margin = 0.03 * float((high - low).max())
    style.frame(axes, low - margin, high + margin, "cells")
    axes.set_title(title, fontsize=9)


def legend_of(shapes: pd.DataFrame) -> list[Patch | Line2D]:
    """Return the legend handles for the kinds of shapes in a table.

    Parameters
    ----------
    shapes
        The shapes, with the column `kind`.
    """
    present = set(shapes["shape"])
    names = {fill: shape for shape, fill in reversed(FILLS.items()) if shape in present}
    handles: list[Patch | Line2D] = [
        Patch(color=fill, label=KEPT if fill == style.MATERIAL else names[fill])
        for fill in dict.fromkeys(FILLS.values())
        if fill in names
    ]
    if INTERIOR_EDGE in present:
        handles.append(Line2D([], [], color=style.INTERIOR_EDGE, label=INTERIOR_EDGE))
    if INTERIOR_VERTEX in present:
        handles.append(
            Line2D(
                [],
                [],
                ls="",
                marker="o",
                mfc="white",
                color=style.INTERIOR_VERTEX,
                label=INTERIOR_VERTEX,
            )
        )
    if GEOMETRY in present:
        handles.append(Line2D([], [], color=style.REMOVED, label=GEOMETRY))
    return handles


def _whole(corners: FloatArray) -> list[FloatArray]:
    """Return the shapes without missing corners."""
    return [shape[~np.isnan(shape).any(axis=1)] for shape in corners]
