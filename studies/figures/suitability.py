"""Fitness for analysis of raw cells, of cells repaired by whole cells, and of our meshes."""

from __future__ import annotations

import numpy as np
import pandas as pd
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
    """Return one panel per measure, one row per model, at the models' own thresholds.

    Parameters
    ----------
    table
        See `studies.suitability.compare_suitability`.
    """
    chosen = table[table["choice"] == OWN_THRESHOLD]
    betti = chosen.set_index(["scheme", "model"])[["betti_0", "betti_1", "betti_2"]]
    models = list(dict.fromkeys(chosen["model"]))
    figure, axes = style.new_figure(1, len(_PANELS), width=15.0, height=0.32 * len(models) + 1.8)
    for panel, (column, label, linear_up_to) in zip(axes[0], _PANELS, strict=True):
        for shift, (scheme, (colour, marker)) in zip(
            (-0.22, 0.0, 0.22), _LOOKS.items(), strict=True
        ):
            of_scheme = chosen[chosen["scheme"] == scheme].set_index("model").loc[models]
            if column == "betti_difference":
                ours, theirs = (betti.loc[s].loc[models].to_numpy() for s in (OURS, scheme))
                values = np.abs(theirs - ours).sum(axis=1)
            else:
                values = of_scheme[column].to_numpy(dtype=float)
            panel.plot(
                values,
                np.arange(len(models)) + shift,
                ls="",
                marker=marker,
                color=colour,
                markersize=4.5,
                label=scheme,
            )
        if linear_up_to == 0:
            panel.set_xscale("log")
        elif linear_up_to is not None:
            panel.set_xscale("symlog", linthresh=linear_up_to)
            panel.set_xlim(left=-0.3 * linear_up_to)
        panel.set_xlabel(label)
        panel.set_yticks(np.arange(len(models)), models if panel is axes[0, 0] else [])
        panel.set_ylim(len(models) - 0.5, -0.5)
        panel.grid(visible=True, linewidth=0.3)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
    figure.suptitle("The same kept cells: raw, repaired by whole cells, and meshed by tusqh")
    return figure
