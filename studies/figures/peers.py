"""Compare Tusqh and other programs on the same dirty surfaces."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.peers import FINISHED
from tusqh.figures import style

_MARKERS = ("D", "P", "o", "^", "s", "v")

_PANELS = (
    ("boundary_mean", "mean distance of the boundary\nto the surface [cells]"),
    ("surface_mean", "mean distance of the surface\nto the boundary [cells]"),
    ("volume_error", "volume / winding volume - 1 [-]"),
    ("worst_scaled_jacobian", "worst element, scaled Jacobian [-]"),
)


def draw_peers(table: pd.DataFrame) -> Figure:
    """Return a figure with a panel per measure and a row per model; hollow means non-manifold.

    Parameters
    ----------
    table
        See `studies.peers.run_peer`.
    """
    models, peers = (list(dict.fromkeys(table[key])) for key in ("model", "peer"))
    figure, axes = style.new_figure(1, len(_PANELS), width=14.0, height=0.5 * len(models) + 2.0)
    handles = []
    for rank, peer in enumerate(peers):
        of_peer = table[table["peer"] == peer].set_index("model").loc[models]
        is_done = (of_peer["status"] == FINISHED).to_numpy()
        is_manifold = (of_peer["manifold"].astype(str) == "True").to_numpy()
        at = np.arange(len(models)) + 0.16 * (rank - (len(peers) - 1) / 2)
        colour, marker = style.PEER_COLOURS[rank], _MARKERS[rank]
        for panel, (column, _) in zip(axes[0], _PANELS, strict=True):
            values = of_peer[column].to_numpy(dtype=float)
            for mask, face in ((is_done & is_manifold, colour), (is_done & ~is_manifold, "white")):
                panel.plot(
                    values[mask], at[mask], ls="", marker=marker, color=colour, mfc=face, ms=5
                )
        label = f"{peer}: {is_done.sum()} of {len(models)} finished, {is_manifold.sum()} manifold"
        handles.append(Line2D([], [], ls="", marker=marker, color=colour, label=label))
    for panel, (column, label) in zip(axes[0], _PANELS, strict=True):
        panel.set_xlabel(label)
        panel.set_yticks(np.arange(len(models)), models if panel is axes[0, 0] else [])
        panel.set_ylim(len(models) - 0.5, -0.5)
        panel.grid(visible=True, linewidth=0.3)
        if column in ("boundary_mean", "surface_mean"):
            panel.set_xscale("log")
        if column == "volume_error":
            panel.set_xscale("symlog", linthresh=0.1)
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    figure.suptitle(
        "The same dirty surfaces meshed by several programs; hollow markers: non-manifold solid"
    )
    return figure
