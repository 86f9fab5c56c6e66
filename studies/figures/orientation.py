"""Draw the dependence of the topology on the placement of the grid, and its reduction."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from studies.orientation import AS_CONFIGURED, SUB_CELLS
from tusqh.figures import style

_LOOKS = {
    SUB_CELLS: (style.INTERIOR_VERTEX, "o"),
    AS_CONFIGURED: (style.CONNECTING, "D"),
}
_SHIFTS = (0.0, 0.2)


def draw_orientation(spread: pd.DataFrame, pooled: pd.DataFrame) -> Figure:
    """Return a figure of the spread, its reduction, and the agreement of placements by model.

    It shows the models' chosen thresholds on the finest grid of the study.

    Parameters
    ----------
    spread
        See `studies.spread.measure_spread`, with the columns is_chosen and
        is_finest.
    pooled
        See `studies.spread.pool_spreads`, with the column choice.
    """
    chosen = spread[spread["is_chosen"] & spread["is_finest"]]
    models = list(dict.fromkeys(chosen["model"]))
    figure, axes = style.new_figure(1, 3, width=13.0, height=0.36 * len(models) + 2.2)
    at = np.arange(len(models))
    for panel, column in ((axes[0, 0], "spread"), (axes[0, 2], "agreement")):
        raw = (
            chosen[chosen["scheme"] == AS_CONFIGURED]
            .set_index("model")
            .loc[models, f"raw_{column}"]
        )
        panel.plot(raw, at - 0.2, "o", color=style.OUTLINE, label="raw cells")
    for shift, (scheme, (colour, marker)) in zip(_SHIFTS, _LOOKS.items(), strict=True):
        of_scheme = chosen[chosen["scheme"] == scheme].set_index("model").loc[models]
        look = {"ls": "", "marker": marker, "color": colour, "label": scheme}
        axes[0, 0].plot(of_scheme["spread"], at + shift, **look)
        axes[0, 2].plot(of_scheme["agreement"], at + shift, **look)
        of_pool = pooled[(pooled["scheme"] == scheme) & (pooled["choice"] == "chosen")]
        last = of_pool.sort_values("grid_rank").iloc[0]
        values = np.append(of_scheme["shrinks"], last["shrinks"])
        ends = np.stack([np.append(of_scheme[end], last[end]) for end in ("low", "high")])
        axes[0, 1].errorbar(
            values,
            np.append(at, len(models)) + shift,
            # A percentile interval does not always contain the value itself.
            xerr=np.maximum(0, np.stack([values - ends[0], ends[1] - values])),
            capsize=2,
            linewidth=0.9,
            **look,
        )
    axes[0, 1].axvline(0, color="black", linewidth=0.8)
    axes[0, 1].set_xlim(-1.05, 1.05)
    axes[0, 0].set_xscale("symlog", linthresh=1)
    axes[0, 0].set_xlabel("spread of Betti numbers [-]")
    axes[0, 1].set_xlabel(
        "relative reduction of the spread [-],\n95 % bootstrap interval; below -1 not shown"
    )
    axes[0, 2].set_xlabel("share of placements with the\nmost frequent topology [-]")
    for panel in axes[0]:
        panel.set_yticks(
            np.arange(len(models) + 1), [*models, "sum of all"] if panel is axes[0, 0] else []
        )
        panel.set_ylim(len(models) + 0.5, -0.5)
        panel.grid(visible=True, linewidth=0.3)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
    cells = " or ".join(str(n) for n in sorted(chosen["cells"].unique()))
    figure.suptitle(f"Betti numbers over random orientations and offsets, {cells} cells")
    return figure
