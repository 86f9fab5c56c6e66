"""Draw what each topology costs with one threshold for the whole model and with local changes."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.scopes import SCOPES
from tusqh.figures import style

_LOOKS = {"global": (style.OUTLINE, "s"), "local": (style.CONNECTING, "o")}

#: Columns, labels of their axes, and the value up to which the axis is linear (None: all of it).
_PANELS: tuple[tuple[str, str, float | None], ...] = (
    ("cells_changed", "cells other than at 1/2 [-]", 1.0),
    ("volume_ratio", "volume over that of the geometry [-]", None),
    ("boundary_mean", "boundary to surface, mean [cells]", None),
    ("surface_mean", "surface to boundary, mean [cells]", 0.1),
)


def draw_scopes(table: pd.DataFrame) -> Figure:
    """Return a figure with a row per model and target, and a line between the two scopes.

    Parameters
    ----------
    table
        See `studies.scopes.compare_scopes`, of all models.
    """
    pairs = zip(table["model"].tolist(), table["target"].tolist(), strict=True)
    wishes: list[tuple[str, str]] = list(dict.fromkeys(pairs))
    height = 0.21 * len(wishes) + 1.8
    figure, axes = style.new_figure(1, len(_PANELS), width=15.0, height=height)
    places = {wish: -k for k, wish in enumerate(wishes)}
    for panel, (column, label, linear_up_to) in zip(axes[0], _PANELS, strict=True):
        if linear_up_to is not None:
            panel.set_xscale("symlog", linthresh=linear_up_to)
        _draw_pairs(panel, table, column, places)
        panel.set_xlabel(label)
        panel.set_yticks([])
        panel.set_ylim(-len(wishes) + 0.3, 0.7)
        panel.grid(visible=True, axis="x", linewidth=0.3)
        for k in range(1, len(wishes)):
            if wishes[k][0] != wishes[k - 1][0]:
                panel.axhline(0.5 - k, color="#bbbbbb", linewidth=0.4)
    axes[0, 1].axvline(1.0, color="black", linewidth=0.6)
    labels = [f"{model}: {_in_symbols(target)}" for model, target in wishes]
    axes[0, 0].set_yticks(list(places.values()), labels, fontsize=8)
    handles = [
        Line2D([], [], ls="", marker=marker, color=colour, label=f"scope: {scope}")
        for scope, (colour, marker) in _LOOKS.items()
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)
    return figure


def _draw_pairs(
    panel: Axes, table: pd.DataFrame, column: str, places: dict[tuple[str, str], int]
) -> None:
    """Draw the values of both scopes in the row of each target."""
    ends: dict[tuple[str, str], list[float]] = {}
    for scope in SCOPES:
        rows = table[table["scope"] == scope]
        keys = list(zip(rows["model"].tolist(), rows["target"].tolist(), strict=True))
        values = rows[column].astype(float).tolist()
        colour, marker = _LOOKS[scope]
        panel.plot(values, [places[key] for key in keys], marker, color=colour, markersize=4)
        for key, value in zip(keys, values, strict=True):
            ends.setdefault(key, []).append(value)
    lines = {places[key]: values for key, values in ends.items() if len(values) == 2}
    starts, stops = zip(*lines.values(), strict=True) if lines else ((), ())
    panel.hlines(list(lines), starts, stops, color="#999999", linewidth=0.9, zorder=1)


def _in_symbols(target: str) -> str:
    r"""Return a target with the symbols of Betti numbers instead of their keys.

    >>> print(_in_symbols("betti_0 = 1, betti_1 <= 2"))
    $\beta_0$ = 1, $\beta_1$ ≤ 2
    """
    for k in range(3):
        target = target.replace(f"betti_{k}", rf"$\beta_{k}$")
    return target.replace("<=", "≤")
