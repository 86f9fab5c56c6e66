"""Draw gaps and a wedge before and after anti-aliasing."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from studies.figures.shapes import draw_shapes, legend_of
from tusqh.figures import style

#: The outcomes of a gap, and their colours in all figures.
CLOSED, DEPENDS, OPEN = "closed", "mixed", "open"
OUTCOME_COLOURS = {CLOSED: "#4477aa", DEPENDS: "#ee9966", OPEN: "#f4f4f0"}


def draw_examples(facts: pd.DataFrame, shapes: pd.DataFrame) -> Figure:
    """Return a figure of each example before and after anti-aliasing, with its Betti numbers.

    Parameters
    ----------
    facts, shapes
        See `studies.aliasing.compare_examples`.
    """
    figure, axes = style.new_figure(2, len(facts), width=12.5, height=8.4)
    for column, (_, fact) in enumerate(facts.iterrows()):
        counts = {
            "before": (fact["components_before"], fact["holes_before"]),
            "after": (fact["components"], fact["holes"]),
        }
        for row, (stage, (b0, b1)) in enumerate(counts.items()):
            name = f"{fact['example']}: {stage}"
            title = rf"{name}, $\beta_0$ = {b0}, $\beta_1$ = {b1}"
            if stage == "before":
                title += f", {fact['contacts']} contacts"
            draw_shapes(axes[row, column], shapes[shapes["panel"] == name], title)
    figure.legend(
        handles=legend_of(shapes), loc="outside lower center", ncols=9, frameon=False, fontsize=8
    )
    figure.suptitle("A gap and a wedge: kept cells, and meshes after anti-aliasing")
    return figure


def draw_axis_gap(sweep: pd.DataFrame, shapes: pd.DataFrame) -> Figure:
    """Return a figure of the paper's three gaps, above the outcome at each offset and width.

    Parameters
    ----------
    sweep
        See `studies.aliasing.sweep_axis_gap`.
    shapes
        See `studies.aliasing.draw_axis_gaps`.
    """
    names = list(dict.fromkeys(shapes["panel"]))
    figure, axes = style.new_figure(2, len(names), width=13.0, height=7.4)
    for panel, name in zip(axes[0], names, strict=True):
        draw_shapes(panel, shapes[shapes["panel"] == name], name)
    titles = {
        "touching": "cells that touch",
        "faces": "cells joined by faces",
        "filtration": "the paper's filtration, our meshes",
        "sub-cells": "sub-cells alone",
    }
    prefix = "components_"
    columns = [name for name in map(str, sweep.columns) if name.startswith(prefix)]
    widths = sorted((name.removeprefix(prefix) for name in columns), key=float)
    for panel, (rule, title) in zip(axes[1], titles.items(), strict=True):
        rows = sweep[sweep["scheme"] == rule].sort_values("offset")
        _draw_outcomes(panel, rows, float(widths[0]) - 0.1, float(widths[-1]) + 0.1)
        panel.set_title(title, fontsize=9)
        if rule == "filtration":  # Draw the outcomes of the meshes on top of the bands.
            for width in widths:
                found = rows[f"components_{width}"] == 2
                for is_open, marker in ((True, "o"), (False, "x")):
                    at = rows["offset"][found == is_open][::2]
                    panel.plot(
                        at,
                        np.full(len(at), float(width)),
                        marker,
                        ms=3,
                        mfc="none",
                        color="black",
                        mew=0.7,
                    )
        else:
            for width in widths:
                panel.axhline(float(width), color="black", linewidth=0.7, linestyle=":")
    handles = [
        Patch(fc=c, ec="#888888", label=name)
        for name, c in OUTCOME_COLOURS.items()
        if name != DEPENDS
    ]
    handles += legend_of(shapes)  # type: ignore[arg-type]
    figure.legend(handles=handles, loc="outside lower center", ncols=6, frameon=False, fontsize=8)
    figure.suptitle(
        "An axis-aligned gap at threshold 1/2 (dots and crosses: meshes that are open and closed)"
    )
    return figure


def _draw_outcomes(axes: Axes, rows: pd.DataFrame, low: float, high: float) -> None:
    """Draw the outcome at each offset for gap widths from `low` to `high`, in cells."""
    x = rows["offset"]
    axes.fill_between(x, low, rows["closing"], color=OUTCOME_COLOURS[CLOSED], linewidth=0)
    axes.fill_between(
        x, rows["closing"], rows["opening"], color=OUTCOME_COLOURS[DEPENDS], linewidth=0
    )
    axes.fill_between(x, rows["opening"], high, color=OUTCOME_COLOURS[OPEN], linewidth=0)
    axes.set_xlim(0, 1)
    axes.set_ylim(low, high)
    axes.set_xlabel(r"offset / $\ell$ [-]")
    axes.set_ylabel(r"gap width $L/\ell$ [-]")
