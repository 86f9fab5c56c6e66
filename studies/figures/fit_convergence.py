"""Draw the distances of fitted boundaries over the size of the cells."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from tusqh.figures import style

_LOOKS = {
    "at_points": ("o", "at points"),
    "at_facets": ("s", "in the middle of facets"),
    "from_surface": ("^", "from the surface"),
    "max_distance": ("x", "largest of all"),
}


def draw_convergence(table: pd.DataFrame, orders: pd.DataFrame) -> Figure:
    """Return a figure with a panel for each surface.

    Parameters
    ----------
    table, orders
        See `studies.fit_convergence.measure_convergence` and
        `studies.fit_convergence.find_orders`.
    """
    surfaces = list(dict.fromkeys(table["surface"]))
    figure, (axes,) = style.new_figure(1, len(surfaces), width=4.4 * len(surfaces), height=4.0)
    for panel, surface in zip(axes, surfaces, strict=True):
        rows = table[table["surface"] == surface]
        order = orders.set_index("surface").loc[surface]
        for name, (marker, label) in _LOOKS.items():
            text = f"{label}: order {order[name]:.1f}"
            panel.loglog(rows["cell_size"], rows[name], marker=marker, label=text)
        sizes = np.array([rows["cell_size"].min(), rows["cell_size"].max()])
        most = rows.loc[rows["cell_size"] == sizes[1], "at_facets"].iloc[0]
        line = most * (sizes / sizes[1]) ** 2
        panel.loglog(sizes, line, ":", color=style.OUTLINE, label="order 2")
        ticks = sorted(set(rows["cell_size"]))
        panel.set_xticks(ticks, [f"{size:.3g}" for size in ticks])
        panel.xaxis.set_minor_locator(NullLocator())
        panel.set_title(surface)
        panel.set_xlabel("size of a cell [-]")
        panel.set_ylabel("distance [-]")
        panel.legend(frameon=False, fontsize=8)
    figure.suptitle("Mean distances between fitted boundaries and surfaces")
    return figure
