"""Draw the persistence diagram over the threshold.

The paper plots one minus the volume fractions of birth and death; here both axes are the
threshold, as in all other figures.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tusqh.figures import style

_MARKERS = ("o", "^", "s")
#: Height of the line for classes that exist at every threshold below their birth.
_NEVER = -0.06


def draw_diagram(
    pairs: pd.DataFrame,
    diagonal: pd.DataFrame,
    *,
    threshold: float,
    base: float | None = None,
    name: str,
) -> Figure:
    """Return a figure of the persistence diagram with the chosen threshold marked.

    A class is in the mesh at threshold ``t``, and its point in the shaded quadrant, if it is born
    at or above ``t`` and dies below it.

    Parameters
    ----------
    pairs
        Persistence pairs with the columns dimension, birth, death and essential; essential pairs
        are hollow and lie on the line of classes that never die.
    diagonal
        Counts of the pairs with persistence 0, with the columns dimension, birth and pairs.
    threshold
        The chosen threshold, dimensionless.
    base
        With the local scope: the threshold of the base, whose quadrant is outlined; None with one
        threshold.
    name
        The model, for the title.
    """
    figure, axes = style.new_figure(1, 1, width=5.6, height=6.0)
    panel = axes[0, 0]
    shown = pairs.assign(x=pairs["birth"], y=pairs["death"])
    shown.loc[shown["essential"], "y"] = _NEVER
    high = max(1.03, float(shown["x"].max()) + 0.03)
    panel.plot([0, high], [0, high], color="black", linewidth=0.8)
    panel.axhline(_NEVER, color="black", linewidth=0.6, linestyle=":")
    panel.fill_between([threshold, high], -0.12, threshold, color="#000000", alpha=0.06)
    is_local = base is not None and base != threshold
    if is_local:
        panel.plot([base, base, high], [-0.12, base, base], color="black", linewidth=0.8, ls="--")
    panel.text(high + 0.01, _NEVER, "never\ndies", va="center", ha="left", fontsize=8)
    handles = []
    for k in sorted(shown["dimension"].unique().tolist()):
        of_dimension = shown[shown["dimension"] == k]
        on_diagonal = diagonal[diagonal["dimension"] == k]
        _draw_pairs(panel, of_dimension, k)
        at = on_diagonal["birth"]
        colour = style.DIMENSION_COLOURS[k]
        panel.plot(at, at, marker=_MARKERS[k], ls="", color=colour, markersize=1.8, alpha=0.8)
        alive = (of_dimension["birth"] >= threshold) & (of_dimension["death"] < threshold)
        label = _label(k, of_dimension, int(alive.sum()), int(on_diagonal["pairs"].sum()))
        handles.append(Line2D([], [], ls="", marker=_MARKERS[k], color=colour, label=label))
    panel.set_xlim(-0.03, high)
    panel.set_ylim(-0.12, high)
    panel.set_aspect("equal")
    panel.set_xlabel("threshold at birth [-]")
    panel.set_ylabel("threshold at death [-]")
    shaded = f"{name}: persistence; shaded: in the mesh at threshold {threshold:.4g}"
    if is_local:
        shaded = f"{name}: persistence; shaded: in the seed at {threshold:.4g}, whose topology the "
        shaded += f"mesh has;\ndashed: at the base {base:.4g}"
    panel.set_title(shaded, fontsize=9 if is_local else None)
    figure.legend(handles=handles, loc="outside lower center", fontsize=8, frameon=False)
    return figure


def _draw_pairs(panel: Axes, of_dimension: pd.DataFrame, k: int) -> None:
    """Draw the pairs of a dimension; label coinciding pairs with their number."""
    points = of_dimension.groupby(["x", "y"], as_index=False).size()
    is_hollow = (points["y"] == _NEVER).to_numpy()
    colour = style.DIMENSION_COLOURS[k]
    panel.scatter(
        points["x"],
        points["y"],
        s=22 * np.sqrt(points["size"]),
        marker=_MARKERS[k],
        facecolors=[(0, 0, 0, 0) if hollow else to_rgba(colour, 0.75) for hollow in is_hollow],
        linewidths=[1.2 if hollow else 0.4 for hollow in is_hollow],
        edgecolors=[colour if hollow else "white" for hollow in is_hollow],
    )
    for x, y, count in points[points["size"] > 1].to_numpy():
        panel.annotate(f"{count:.0f}", (x, y), (5, 2), textcoords="offset points", fontsize=6)


def _label(k: int, of_dimension: pd.DataFrame, n_alive: int, n_diagonal: int) -> str:
    """Return the legend entry of a dimension."""
    n_pairs, n_essential = len(of_dimension), int(of_dimension["essential"].sum())
    return (
        rf"$H_{k}$ {style.DIMENSION_NAMES[k]}: {n_pairs} pair{'' if n_pairs == 1 else 's'}, "
        f"{n_alive} at the threshold,\n"
        f"{n_essential} never {'dies' if n_essential == 1 else 'die'} (hollow), "
        f"{n_diagonal} on the diagonal (small)"
    )
