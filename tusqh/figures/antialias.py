"""Draw sub-cells and templates around most pinches, as in the paper's anti-aliasing figure."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from scipy import ndimage

from tusqh.antialias.pinches import find_pinches
from tusqh.figures import style
from tusqh.grid import QUAD_CORNERS, BoolArray, IntArray
from tusqh.grid.doubled import marked_edges
from tusqh.meshes.volume_mesh import (
    BRIDGE,
    CONNECTING,
    GRID_CELL,
    INNER_CELL,
    SEPARATING,
    VolumeMesh,
)
from tusqh.sampling.fractions import VolumeFractions

#: Side of the close-up, in cells.
_CLOSE_UP = 24


def draw_antialias(
    fractions: VolumeFractions,
    mesh: VolumeMesh,
    *,
    threshold: float,
    base: float | None = None,
    unit: str,
) -> Figure:
    """Return an overview, a close-up of the interior sub-cells, and one of the final mesh.

    Parameters
    ----------
    fractions
        Volume fractions.
    mesh
        The mesh made from them.
    threshold
        Threshold of the mesh, at which contacts vote, dimensionless.
    base
        With the local scope: the threshold of most cells; None: they are those of `threshold`.
    unit
        Unit of length of the geometry.
    """
    grid = fractions.grid
    scale, unit = style.length_scale(max(grid.shape) * grid.cell_size, unit)
    points = mesh.points / scale
    colours = np.full(mesh.n_cells, style.MATERIAL, dtype=object)
    colours[mesh.kind == SEPARATING] = style.SEPARATING
    colours[mesh.kind == CONNECTING] = style.CONNECTING
    colours[mesh.kind == BRIDGE] = style.BRIDGE
    # Some cells above the threshold may have been removed, and some below it filled.
    is_whole = (mesh.kind == GRID_CELL) | (mesh.kind == INNER_CELL)
    kept = np.zeros(grid.shape, dtype=bool)
    kept.flat[mesh.grid_cell[is_whole]] = True
    is_pinch = find_pinches(kept)
    marked = is_pinch.copy()
    bridge_cells = np.unravel_index(mesh.grid_cell[mesh.kind == BRIDGE], grid.shape)
    marked[bridge_cells] = True
    low, high = _busiest(marked)
    lower, upper = (grid.to_points(np.array([c]))[0] / scale for c in (low, high))

    figure, (row,) = style.new_figure(1, 3, width=13.5, height=5.6)
    style.draw_polygons(row[0], points, mesh.cells, colour=style.MATERIAL)
    pinches = grid.to_points(np.argwhere(is_pinch)) / scale
    row[0].plot(*pinches.T, ".", color=style.CONNECTING, markersize=4)
    row[0].add_patch(
        Rectangle(tuple(lower), *(upper - lower), fill=False, edgecolor="black", linewidth=1.0)
    )
    style.frame(row[0], np.divide(grid.origin, scale), np.divide(grid.upper, scale), unit)
    row[0].set_title(f"{mesh.name}: the mesh; dots: pinches of its cells ({len(pinches)})")

    in_base = fractions.cells >= (threshold if base is None else base)
    _draw_sub_cells(row[1], fractions, kept, in_base, threshold, scale)
    style.frame(row[1], lower, upper, unit)
    of_cells = "" if base is None else f"; cells of {base:.4g}"
    row[1].set_title(f"interior sub-cells at threshold {threshold:.4g}{of_cells}")
    style.draw_polygons(row[2], points, mesh.cells, colour=colours, line_width=0.4)
    style.frame(row[2], lower, upper, unit)
    row[2].set_title("the mesh, with its templates")
    handles = [
        Line2D([], [], marker="o", mfc="none", color=style.INTERIOR_VERTEX, ls="", label="vertex"),
        Line2D([], [], color=style.INTERIOR_EDGE, label="edge"),
        Patch(color=style.MATERIAL, label="kept cell"),
        Patch(color=style.REMOVED, label="removed cell"),
        Patch(color=style.ADDED, label="added cell"),
        Patch(color=style.CONNECTING, label="connecting template"),
        Patch(color=style.SEPARATING, label="separating template"),
        Patch(color=style.BRIDGE, label="bridge"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=8, frameon=False)
    return figure


def _busiest(
    marked: np.ndarray[tuple[int, ...], np.dtype[np.bool_]],
) -> tuple[IntArray, IntArray]:
    """Return the corners, in cells, of the square centred on the densest marked places."""
    size = np.minimum(_CLOSE_UP, np.subtract(marked.shape, 1))
    density = ndimage.uniform_filter(marked.astype(float), size=tuple(size), mode="constant")
    centre = np.array(np.unravel_index(int(density.argmax()), density.shape))
    places = np.argwhere(marked)
    inside = places[(np.abs(places - centre) <= size // 2).all(axis=1)]
    if len(inside):
        centre = np.rint((inside.min(axis=0) + inside.max(axis=0)) / 2).astype(np.int64)
    low = np.clip(centre - size // 2, 0, np.array(marked.shape) - 1 - size)
    return low, low + size


def _draw_sub_cells(
    axes: Axes,
    fractions: VolumeFractions,
    kept: BoolArray,
    in_base: BoolArray,
    threshold: float,
    scale: float,
) -> None:
    """Draw kept, removed and added cells, and the interior edges and vertices."""
    grid = fractions.grid
    for mask, colour in (
        (kept & in_base, style.MATERIAL),
        (in_base & ~kept, style.REMOVED),
        (kept & ~in_base, style.ADDED),
    ):
        corners = np.argwhere(mask)[:, None] + QUAD_CORNERS
        points = grid.to_points(corners.reshape(-1, 2)) / scale
        quads = np.arange(len(points)).reshape(-1, 4)
        style.draw_polygons(axes, points, quads, colour=colour, line_width=0.3)
    interior = fractions.values >= threshold
    lines = grid.to_points(marked_edges(interior)) / scale
    axes.add_collection(LineCollection(list(lines), colors=style.INTERIOR_EDGE, linewidths=1.3))
    vertices = grid.to_points(np.argwhere(fractions.vertices >= threshold)) / scale
    axes.plot(*vertices.T, "o", mfc="white", color=style.INTERIOR_VERTEX, markersize=3.2)
