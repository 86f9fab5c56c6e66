"""Draw the samples of sub-cells and the filtered complex of fractions for small examples."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from tusqh.figures import style
from tusqh.grid import FloatArray, IntArray
from tusqh.topology.filtration import Filtration, build_filtration

#: Fractions of 3 x 3 cells, of which those of at least 0.4 meet in pinches.
_CELLS = np.array([[0.9, 0.2, 0.7], [0.3, 0.6, 0.1], [0.8, 0.4, 0.5]])
_THRESHOLD = 0.4


def draw_method() -> Figure:
    """Return a figure of sample arrays (first row) and of complexes at a threshold (second row)."""
    figure, axes = style.new_figure(2, 3, width=10.5, height=7.6)
    _draw_samples(axes[0, 0], 4, (2, 2), "s = 4: the samples of a vertex")
    _draw_samples(axes[0, 1], 4, (3, 2), "s = 4: the samples of an edge")
    _draw_samples(axes[0, 2], 3, (2, 2), "s = 3 (not used): samples on cell boundaries")
    for panel, vertex, word in ((axes[1, 0], 0.9, "interior"), (axes[1, 1], 0.0, "exterior")):
        values = np.zeros((7, 7))
        values[1::2, 1::2] = _CELLS
        values[2:-1:2, 2:-1:2] = vertex
        _draw_complex(panel, build_filtration(values), f"{word} vertices")
    values = np.zeros((5, 5, 3))
    values[1::2, 1::2, 1] = 1.0
    values[2, 2, 1] = 0.5
    _draw_in_space(axes[1, 2], build_filtration(np.concatenate([values, values[..., 1:]], axis=-1)))
    figure.suptitle(
        "The samples of sub-cells (red: their fictitious cell), and the complex of the filtration"
    )
    return figure


def _draw_samples(panel: Axes, samples: int, place: tuple[int, int], title: str) -> None:
    """Draw 2 x 2 cells and the samples in the fictitious cell around a sub-cell."""
    centre = np.array(place) / 2
    at = (np.arange(2 * samples) + 0.5) / samples
    lattice = np.stack(np.meshgrid(at, at, indexing="ij"), axis=-1).reshape(-1, 2)
    if samples % 2:
        # An odd array fits the fictitious cell only after a shift onto the cell boundaries.
        lattice = lattice[(lattice < 1).all(axis=1)] + centre - 0.5
    is_in = (np.abs(lattice - centre) < 0.5 - 1e-9).all(axis=1)
    for k in range(3):
        panel.plot([0, 2], [k, k], [k, k], [0, 2], color="#406070", linewidth=1.0)
    panel.plot(*lattice[~is_in & (lattice <= 2).all(axis=1)].T, ".", color="#bbbbbb", markersize=5)
    panel.plot(*lattice[is_in].T, "o", color=style.INTERIOR_VERTEX, markersize=6)
    low = tuple(centre - 0.5)
    look: dict[str, Any] = {"edgecolor": style.CONNECTING, "linestyle": "--", "linewidth": 1.6}
    panel.add_patch(Rectangle((low[0], low[1]), 1, 1, fill=False, **look))
    _frame(panel, (-0.05, 2.05), (-0.05, 2.05), title)


def _draw_complex(panel: Axes, complex_: Filtration, title: str) -> None:
    """Draw the cells of the grid, and the part of a planar complex present at the threshold."""
    for (i, j), value in np.ndenumerate(_CELLS):
        colour = style.MATERIAL if value >= _THRESHOLD else "white"
        panel.add_patch(
            Rectangle((i, j), 1, 1, facecolor=colour, edgecolor="#406070", linewidth=0.8)
        )
        panel.text(i + 0.06, j + 0.84, f"{value:g}", fontsize=8)
    points = complex_.positions / 2
    edges, triangles = (points[_present(complex_, k)] for k in (1, 2))
    panel.add_collection(
        PolyCollection(list(triangles), facecolors=style.BRIDGE, alpha=0.45, edgecolors="none")
    )
    panel.add_collection(LineCollection(list(edges), colors=style.CONNECTING, linewidths=1.4))
    panel.plot(*points[_present(complex_, 0)[:, 0]].T, "o", color="black", markersize=4)
    _frame(panel, (-0.05, 3.05), (-0.05, 3.05), f"{title}, threshold {_THRESHOLD:g}")


def _draw_in_space(panel: Axes, complex_: Filtration) -> None:
    """Draw the edges of a complex in space, seen from a corner."""
    points = complex_.positions / 2
    seen = np.stack([points[:, 0] + 0.45 * points[:, 1], points[:, 2] + 0.3 * points[:, 1]], axis=1)
    edges = seen[_present(complex_, 1, 0.5)]
    panel.add_collection(LineCollection(list(edges), colors=style.CONNECTING, linewidths=0.8))
    n_odd = (complex_.positions % 2).sum(axis=1)
    looks = {3: ("hexes", "black", 6), 1: ("edges", style.INTERIOR_EDGE, 5)}
    looks[0] = ("vertices", style.INTERIOR_VERTEX, 4)
    for count, (name, colour, size) in looks.items():
        panel.plot(*seen[n_odd == count].T, "o", color=colour, markersize=size, label=name)
    low, high = seen.min(axis=0) - 0.2, seen.max(axis=0) + 0.2
    _frame(panel, (low[0], high[0]), (low[1], high[1]), "in space: nodes and edges")
    panel.legend(fontsize=8, frameon=False, loc="lower right")


def _present(complex_: Filtration, k: int, threshold: float = _THRESHOLD) -> IntArray:
    """Return the k-simplices of a complex that are present at the threshold."""
    return complex_.simplices[k][complex_.simplex_values(k) >= threshold]


def _frame(
    panel: Axes,
    x: tuple[float, float] | FloatArray,
    y: tuple[float, float] | FloatArray,
    title: str,
) -> None:
    panel.set_xlim(x[0], x[1])
    panel.set_ylim(y[0], y[1])
    panel.set_aspect("equal")
    panel.set_axis_off()
    panel.set_title(title, fontsize=9)
