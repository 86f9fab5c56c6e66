"""The persistence diagram, as in the paper: one minus the fractions of birth and death."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tusqh.figures import style

_MARKERS = ("o", "^", "s")
#: Height at which classes are drawn that no threshold above 0 destroys.
_NEVER = 1.06


def draw_diagram(
    pairs: pd.DataFrame, diagonal: pd.DataFrame, *, threshold: float, name: str
) -> Figure:
    """Return the persistence diagram with the chosen threshold marked.

    The classes in the mesh at threshold ``t`` are born at or before and die after ``1 - t``:
    those in the shaded quadrant.

    Parameters
    ----------
    pairs
        Persistence pairs with the columns dimension, birth, death and essential; essential ones
        are drawn hollow, on the line of those that never die.
    diagonal
        Pairs born and dead at one fraction, counted by the columns dimension, birth and pairs.
    threshold
        The chosen threshold, dimensionless.
    name
        The model, for the title.
    """
    figure, axes = style.new_figure(1, 1, width=5.6, height=6.0)
    panel = axes[0, 0]
    shown = pairs.assign(x=1 - pairs["birth"], y=1 - pairs["death"])
    shown.loc[shown["essential"], "y"] = _NEVER
    low = min(-0.03, float(shown["x"].min()) - 0.03)
    panel.plot([low, 1], [low, 1], color="black", linewidth=0.8)
    panel.axhline(_NEVER, color="black", linewidth=0.6, linestyle=":")
    panel.fill_between([low, 1 - threshold], 1 - threshold, 1.12, color="#000000", alpha=0.06)
    panel.text(1.04, _NEVER, "never\ndies", va="center", ha="left", fontsize=8)
    handles = []
    for dimension, of_dimension in shown.groupby("dimension"):
        k = int(str(dimension))
        points = of_dimension.groupby(["x", "y"], as_index=False).size()
        alive = (of_dimension["birth"] >= threshold) & (of_dimension["death"] < threshold)
        is_hollow = (points["y"] == _NEVER).to_numpy()
        colour = style.DIMENSION_COLOURS[k]
        panel.scatter(
            points["x"],
            points["y"],
            s=22 * np.sqrt(points["size"]),
            marker=_MARKERS[k],
            facecolors=[(0, 0, 0, 0) if hollow else to_rgba(colour, 0.75) for hollow in is_hollow],
            linewidths=np.where(is_hollow, 1.2, 0.4),
            edgecolors=[colour if hollow else "white" for hollow in is_hollow],
        )
        on_diagonal = diagonal[diagonal["dimension"] == k]
        at = 1 - on_diagonal["birth"]
        panel.plot(at, at, marker=_MARKERS[k], ls="", color=colour, markersize=1.8, alpha=0.8)
        handles.append(
            Line2D(
                [],
                [],
                ls="",
                marker=_MARKERS[k],
                color=colour,
                label=rf"$H_{k}$ {style.DIMENSION_NAMES[k]}: {len(of_dimension)} pairs, "
                f"{int(alive.sum())} at the threshold,\n"
                f"{int(of_dimension['essential'].sum())} never die (hollow), "
                f"{int(on_diagonal['pairs'].sum())} on the diagonal (small)",
            )
        )
        for x, y, count in points[points["size"] > 1].to_numpy():
            panel.annotate(f"{count:.0f}", (x, y), (5, 2), textcoords="offset points", fontsize=6)
    panel.set_xlim(low, 1.03)
    panel.set_ylim(low, 1.12)
    panel.set_aspect("equal")
    panel.set_xlabel("1 - volume fraction at birth [-]")
    panel.set_ylabel("1 - volume fraction at death [-]")
    panel.set_title(f"{name}: persistence, threshold {threshold:.4g} (shaded: in the mesh)")
    figure.legend(handles=handles, loc="outside lower center", fontsize=8, frameon=False)
    return figure
