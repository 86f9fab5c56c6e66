"""The Betti numbers at every threshold, and the interval that was chosen."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from tusqh.figures import style
from tusqh.grid import FloatArray

#: Betti numbers beyond this are drawn on a logarithmic scale.
_LINEAR_UP_TO = 10


def draw_curves(
    plateaus: pd.DataFrame,
    topologies: pd.DataFrame,
    *,
    threshold: float,
    interval: tuple[float, float],
    wanted: str,
    name: str,
) -> Figure:
    """Return the Betti curves of a model: of its filtration, and of the meshes made from it.

    Parameters
    ----------
    plateaus
        Plateaus of the filtration with the columns lower, upper and ``betti_*``; each pinch
        follows its own sub-cell there.
    topologies
        Plateaus that were looked at, with the Betti numbers of the meshes, all decisions made.
    threshold
        The chosen threshold, dimensionless.
    interval
        The thresholds ``t`` with ``lower < t <= upper`` have the chosen topology.
    wanted
        What was asked for, in words.
    name
        The model, for the title.
    """
    dimensions = [k for k in range(3) if k < 2 or plateaus[f"betti_{k}"].any()]
    figure, axes = style.new_figure(len(dimensions), 1, width=7.0, height=1.9 * len(dimensions) + 1)
    for k, panel in zip(dimensions, axes[:, 0], strict=True):
        colour = style.DIMENSION_COLOURS[k]
        of_filtration, of_meshes = (
            _as_steps(table, table[f"betti_{k}"].to_numpy(dtype=float))
            for table in (plateaus, topologies)
        )
        panel.axvspan(*interval, color=style.CHOSEN, alpha=0.3, linewidth=0)
        panel.axvline(threshold, color="black", linewidth=0.8)
        panel.plot(*of_filtration, color="#999999", linewidth=0.8)
        panel.plot(*of_meshes, color=colour, linewidth=1.4)
        largest = max(np.nanmax(of_filtration[1]), np.nanmax(of_meshes[1]))
        if largest > 3 * _LINEAR_UP_TO:
            panel.set_yscale("symlog", linthresh=_LINEAR_UP_TO)
        panel.set_ylim(-0.04 * _LINEAR_UP_TO, 1.1 * max(largest, 2))
        panel.set_xlim(1.0, 0.0)
        panel.set_ylabel(rf"$\beta_{k}$: {style.DIMENSION_NAMES[k]} [-]")
        panel.grid(visible=True, axis="y", linewidth=0.3)
    axes[-1, 0].set_xlabel("volume-fraction threshold [-]")
    handles = [
        Line2D([], [], color="#999999", label="the filtration, pinch by pinch"),
        Line2D([], [], color=style.DIMENSION_COLOURS[0], label="the mesh, all decisions made"),
        Line2D([], [], color="black", linewidth=0.8, label=f"chosen: {threshold:.4g}"),
        Patch(
            color=style.CHOSEN,
            alpha=0.3,
            label=f"the same topology: {interval[0]:.4g} < t <= {interval[1]:.4g}",
        ),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)
    figure.suptitle(f"{name}: asked for {wanted}")
    return figure


def _as_steps(table: pd.DataFrame, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return plateaus as the points of a line, broken where plateaus were not looked at.

    >>> table = pd.DataFrame({"upper": [1.0, 0.5], "lower": [0.75, 0.0]})
    >>> x, y = _as_steps(table, np.array([2.0, 3.0]))
    >>> x.tolist(), y.tolist()
    ([1.0, 0.75, 0.75, 0.5, 0.0, 0.0], [2.0, 2.0, nan, 3.0, 3.0, nan])
    """
    upper, lower = table["upper"].to_numpy(), table["lower"].to_numpy()
    is_broken = np.append(lower[:-1] != upper[1:], True)
    breaks = np.where(is_broken, np.nan, values)
    return (
        np.stack([upper, lower, lower], axis=1).ravel(),
        np.stack([values, values, breaks], axis=1).ravel(),
    )
