"""Draw the suitability for analysis of raw cells, of repaired cells, and of our meshes."""

from __future__ import annotations

import pandas as pd
import seaborn as sns
from matplotlib.figure import Figure

from studies.suitability import OURS, OWN_THRESHOLD, RAW, REPAIRED
from tusqh.figures import style

_LOOKS = {RAW: (style.OUTLINE, "o"), REPAIRED: (style.BRIDGE, "s"), OURS: (style.CONNECTING, "D")}

#: Columns, labels of their axes, and the value from which the axis is logarithmic (None: linear).
_PANELS: tuple[tuple[str, str, float | None], ...] = (
    ("non_manifold_points", "non-manifold boundary points [-]", 1.0),
    ("betti_difference", "difference to the chosen Betti\nnumbers, sum [-]", 1.0),
    ("leak", "heat leaked through pinches [-]", 1e-4),
    ("condition", "condition number, scaled [-]", 0.0),
    ("volume_error", "volume / winding volume - 1 [-]", None),
)


def draw_suitability(table: pd.DataFrame) -> Figure:
    """Return a figure with a panel per measure and a row per model, at the models' thresholds.

    Parameters
    ----------
    table
        See `studies.suitability.compare_suitability`.
    """
    chosen = table[table["choice"] == OWN_THRESHOLD]
    models = list(dict.fromkeys(chosen["model"]))
    figure, axes = style.new_figure(1, len(_PANELS), width=15.0, height=0.32 * len(models) + 1.8)
    chosen = chosen.assign(betti_difference=_differences(chosen))
    for panel, (column, label, linear_up_to) in zip(axes[0], _PANELS, strict=True):
        sns.pointplot(
            chosen,
            x=column,
            y="model",
            hue="scheme",
            order=models,
            hue_order=list(_LOOKS),
            palette=[colour for colour, _ in _LOOKS.values()],
            markers=[marker for _, marker in _LOOKS.values()],
            markersize=4.5,
            linestyle="none",
            dodge=0.44,
            errorbar=None,
            ax=panel,
        )
        if linear_up_to == 0:
            panel.set_xscale("log")
        elif linear_up_to is not None:
            panel.set_xscale("symlog", linthresh=linear_up_to)
            panel.autoscale(axis="x")
            panel.set_xlim(left=-0.3 * linear_up_to)
        panel.set(xlabel=label, ylabel="")
        if panel is not axes[0, 0]:
            panel.set_yticks([])
        panel.grid(visible=True, linewidth=0.3)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    for panel in axes[0]:
        panel.get_legend().remove()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
    figure.suptitle("The same kept cells: raw, repaired by whole cells, and meshed by tusqh")
    return figure


def _differences(rows: pd.DataFrame) -> pd.Series:
    """Return the sum of the differences between the Betti numbers of a mesh and those of ours."""
    numbers = ["betti_0", "betti_1", "betti_2"]
    ours = rows[rows["scheme"] == OURS].set_index("model")[numbers]
    return (rows[numbers] - ours.loc[rows["model"]].set_axis(rows.index)).abs().sum(axis=1)
