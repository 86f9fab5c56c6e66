"""Draw the errors of the heat problem over the size of the cells."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from studies.heat import BOUNDARIES
from tusqh.figures import style

_LOOKS = {"staircase": (style.SECTION, "s"), "fitted": (style.MESH_LINE, "o")}
_ERRORS = {
    "temperature_error": "error of the temperature, root of the mean square [-]",
    "heat_error": "error of the integral of the temperature [-]",
}


def draw_heat(table: pd.DataFrame, orders: pd.DataFrame) -> Figure:
    """Return a figure with a row for each error and a column for the disk and the ball.

    Parameters
    ----------
    table, orders
        See `studies.heat.measure_heat` and `studies.heat.fit_orders`.
    """
    domains = list(dict.fromkeys(table["domain"]))
    figure, axes = style.new_figure(
        len(_ERRORS), len(domains), width=4.8 * len(domains), height=3.9 * len(_ERRORS)
    )
    for row, (error, label) in zip(axes, _ERRORS.items(), strict=True):
        for panel, domain in zip(row, domains, strict=True):
            rows = table[table["domain"] == domain]
            for boundary in BOUNDARIES:
                colour, marker = _LOOKS[boundary]
                own = rows[rows["boundary"] == boundary]
                of_own = (orders["domain"] == domain) & (orders["boundary"] == boundary)
                order = orders.loc[of_own, error.replace("_error", "_order")].iloc[0]
                panel.loglog(
                    own["cell_size"],
                    own[error].abs(),
                    marker=marker,
                    color=colour,
                    label=f"{boundary}: order {order:.1f}",
                )
            sizes = np.array([rows["cell_size"].min(), rows["cell_size"].max()])
            least = rows.loc[rows["cell_size"] == sizes[1], error].abs().min()
            panel.loglog(
                sizes, least * (sizes / sizes[1]) ** 2, ":", color=style.OUTLINE, label="order 2"
            )
            ticks = sorted(set(rows["cell_size"]))
            panel.set_xticks(ticks, [f"{size:.3g}" for size in ticks])
            panel.xaxis.set_minor_locator(NullLocator())
            panel.set_title(domain)
            panel.set_xlabel("size of a cell [radii]")
            panel.set_ylabel(label, fontsize=8)
            panel.legend(frameon=False, fontsize=8)
    figure.suptitle("Heat in a disk and in a ball: elements of order 1, exact solution known")
    return figure
