"""Draw the Betti numbers at every threshold, and the chosen interval."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from tusqh.figures import style
from tusqh.grid import FloatArray

#: Betti numbers above this are drawn on a logarithmic scale.
_LINEAR_UP_TO = 10


def draw_curves(
    curves: pd.DataFrame,
    topologies: pd.DataFrame,
    *,
    threshold: float,
    base: float | None = None,
    interval: tuple[float, float],
    wanted: str,
    name: str,
) -> Figure:
    """Return a figure of the Betti curves of a model's filtration and of its meshes.

    Parameters
    ----------
    curves
        Plateaus of the filtration, in which each pinch follows its own sub-cell, with the columns
        lower, upper and ``betti_*``.
    topologies
        Examined plateaus, with the Betti numbers of their meshes after all decisions.
    threshold
        The chosen threshold, dimensionless.
    base
        With the local scope: the threshold of the base; None with one threshold.
    interval
        Ends of the interval; thresholds ``t`` with ``lower < t <= upper`` have the chosen topology.
    wanted
        The request, in words.
    name
        The model, for the title.
    """
    dimensions = [k for k in range(3) if k < 2 or curves[f"betti_{k}"].any()]
    figure, axes = style.new_figure(len(dimensions), 1, width=7.0, height=1.9 * len(dimensions) + 1)
    for k, panel in zip(dimensions, axes[:, 0], strict=True):
        of_filtration, of_meshes = (
            _as_steps(table, table[f"betti_{k}"].to_numpy(dtype=float))
            for table in (curves, topologies)
        )
        panel.axvspan(*interval, color=style.CHOSEN, alpha=0.3, linewidth=0)
        panel.axvline(threshold, color="black", linewidth=0.8)
        if base is not None and base != threshold:
            panel.axvline(base, color="black", linewidth=0.8, linestyle="--")
        panel.plot(*of_filtration, color="#999999", linewidth=0.8)
        panel.plot(*of_meshes, color=style.MESH_LINE, linewidth=1.4)
        largest = max(np.nanmax(of_filtration[1]), np.nanmax(of_meshes[1]))
        if largest > 3 * _LINEAR_UP_TO:
            panel.set_yscale("symlog", linthresh=_LINEAR_UP_TO)
        else:
            panel.yaxis.set_major_locator(MaxNLocator(integer=True))
        panel.set_ylim(-0.04 * _LINEAR_UP_TO, 1.1 * max(largest, 2))
        panel.set_xlim(0.0, 1.0)
        panel.set_ylabel(rf"$\beta_{k}$: {style.DIMENSION_NAMES[k]} [-]")
        panel.grid(visible=True, axis="y", linewidth=0.3)
    axes[-1, 0].set_xlabel(style.THRESHOLD_LABEL)
    handles = [
        Line2D([], [], color="#999999", label="filtration, each pinch decided by itself"),
        Line2D([], [], color=style.MESH_LINE, label="mesh, after all decisions"),
        *_lines_of_thresholds(threshold, base),
        Patch(
            color=style.CHOSEN,
            alpha=0.3,
            label=f"same topology: {interval[0]:.4g} < threshold ≤ {interval[1]:.4g}",
        ),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)
    figure.suptitle(f"{name}: Betti numbers; requested: {_in_symbols(wanted)}")
    return figure


def _lines_of_thresholds(threshold: float, base: float | None) -> list[Line2D]:
    """Return the entries of the legend for the threshold and, if it is another one, the base."""
    if base is None or base == threshold:
        label = f"chosen threshold: {threshold:.4g}"
        return [Line2D([], [], color="black", linewidth=0.8, label=label)]
    return [
        Line2D([], [], color="black", linewidth=0.8, label=f"topology of {threshold:.4g} (seed)"),
        Line2D([], [], color="black", linewidth=0.8, ls="--", label=f"cells of {base:.4g} (base)"),
    ]


def _in_symbols(wanted: str) -> str:
    r"""Return a request with the symbols of Betti numbers instead of their keys.

    >>> print(_in_symbols("betti_0 = 1, 2 <= betti_1"))
    $\beta_0$ = 1, 2 ≤ $\beta_1$
    """
    symbols = re.sub(r"betti_(\d)", r"$\\beta_\1$", wanted)
    return symbols.replace("<=", "≤").replace(">=", "≥")


def _as_steps(table: pd.DataFrame, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return plateaus as points of a line that is broken between plateaus that do not meet.

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
