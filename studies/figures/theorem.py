"""Draw maps of the gap widths at which the result depends on offset or orientation."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from studies.figures.aliasing import CLOSED, DEPENDS, OPEN, OUTCOME_COLOURS
from studies.theorem import CLAIMED, ORIENTATION_LIMIT
from tusqh.figures import style

TITLES = {
    "touching": "cells that touch",
    "faces": "cells joined by faces",
    "filtration": "the paper's filtration",
    "sub-cells": "sub-cells alone",
}
_LINES = {"touching": "s", "faces": "o", "filtration": "^", "sub-cells": "D"}
_CLAIM = "#aa3377"


def draw_map(sweep: pd.DataFrame, orientations: pd.DataFrame) -> Figure:
    """Return a figure of the outcome over rotation and width, with exact areas and with samples.

    Parameters
    ----------
    sweep
        The table of `tabulate_sweep`.
    orientations
        The table of `tabulate_orientations`.
    """
    methods = list(dict.fromkeys(sweep["method"]))
    figure, axes = style.new_figure(len(methods), 4, width=13.0, height=2.9 * len(methods) + 0.8)
    for row, method in zip(axes, methods, strict=True):
        for panel, (rule, title) in zip(row, TITLES.items(), strict=True):
            of_panel = sweep[(sweep["method"] == method) & (sweep["scheme"] == rule)]
            _draw_outcomes(panel, of_panel)
            if method == "exact":
                lines = orientations[
                    (orientations["method"] == method) & (orientations["scheme"] == rule)
                ]
                for name in ("middle_width", "crossing_width"):
                    panel.plot(lines["degrees"], lines[name], color="black", linewidth=0.9)
            for bound in CLAIMED[rule]:
                panel.axhline(bound, color=_CLAIM, linewidth=1.1, linestyle="--")
            panel.set_title(f"{title}, {method}", fontsize=9)
            panel.set_xlabel("rotation [degrees]")
            panel.set_ylabel(r"gap width $L/\ell$ [-]")
    handles = [
        Patch(fc=OUTCOME_COLOURS[CLOSED], label="closed at all offsets"),
        Patch(fc=OUTCOME_COLOURS[DEPENDS], label="depends on the offset, or along the gap"),
        Patch(fc=OUTCOME_COLOURS[OPEN], ec="#888888", label="open at all offsets"),
        Line2D([], [], color=_CLAIM, ls="--", label="the theorem's window"),
        Line2D([], [], color="black", label="closed form"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=5, frameon=False)
    figure.suptitle("A gap between half-planes at threshold 1/2; meshes agree with the filtration")
    return figure


def _draw_outcomes(axes: Axes, rows: pd.DataFrame) -> None:
    n_offsets = rows[["closed", "open", "mixed"]].sum(axis=1)
    outcome = np.where(rows["closed"] == n_offsets, 0, np.where(rows["open"] == n_offsets, 2, 1))
    table = rows.assign(outcome=outcome).pivot_table(
        index="width", columns="degrees", values="outcome"
    )
    axes.pcolormesh(
        table.columns,
        table.index,
        table.to_numpy(),
        cmap=ListedColormap([OUTCOME_COLOURS[name] for name in (CLOSED, DEPENDS, OPEN)]),
        vmin=-0.5,
        vmax=2.5,
        shading="nearest",
        rasterized=True,
    )


def draw_windows(windows: pd.DataFrame) -> Figure:
    """Return a figure of the windows' ends by number of samples, in the plane and in space.

    Parameters
    ----------
    windows
        The table of `tabulate_windows`.
    """
    figure, axes = style.new_figure(1, 2, width=11.0, height=5.0)
    for panel, (dim, table) in zip(axes[0], windows.groupby("dimension"), strict=True):
        methods = list(dict.fromkeys(table["method"]))
        order = [*methods[1:], methods[0]]  # Order by number of samples, with exact fractions last.
        for k, rule in enumerate(TITLES):
            for end, filled in (("lower", False), ("upper", True)):
                rows = table[(table["scheme"] == rule) & (table["end"] == end)]
                found = rows.set_index("method")["found"].loc[order]
                panel.plot(
                    np.arange(len(order)) + 0.06 * (k - 1.5),
                    found,
                    marker=_LINES[rule],
                    color=f"C{k}",
                    mfc=f"C{k}" if filled else "white",
                    linewidth=0.8,
                    linestyle="-" if filled else ":",
                )
        panel.set_xticks(range(len(order)), order)
        panel.set_xlabel("samples along the side of a cell")
        panel.set_ylabel(r"end of the window $L/\ell$ [-]")
        panel.set_title("half-planes" if dim == 2 else "half-spaces: a plane gap in 3D", fontsize=9)
        bounds = {
            r"$\sqrt{2}-1$": math.sqrt(2) - 1,
            r"$1/2$": ORIENTATION_LIMIT,
            r"$\sqrt{2}/2$": math.sqrt(0.5),
            "$1$": 1.0,
        }
        if dim == 3:
            bounds = {r"$\sqrt{3}/2$": math.sqrt(3) / 2, "$1$": 1.0, r"$\sqrt{3}$": math.sqrt(3)}
        for name, bound in bounds.items():
            panel.axhline(bound, color=_CLAIM, linewidth=0.8, linestyle="--", zorder=0)
            panel.text(len(order) - 0.62, bound, name, va="center", fontsize=8, color=_CLAIM)
        panel.set_xlim(-0.4, len(order) - 0.2)
    handles = [
        Line2D([], [], marker=_LINES[rule], color=f"C{k}", label=title)
        for k, (rule, title) in enumerate(TITLES.items())
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False)
    figure.suptitle(
        "Ends of the window: closed below the hollow markers, open above the filled ones"
    )
    return figure


def draw_plane_gap(orientations: pd.DataFrame) -> Figure:
    """Return a figure of the exact ends of the window for every normal of a plane gap.

    The ends are in closed form; the title states how well patches of cells, at some offsets only,
    agree with them.

    Parameters
    ----------
    orientations
        The table of `tabulate_orientations`.
    """
    exact = orientations[orientations["method"] == "exact"]
    gap = exact["crossing_width"] - exact["largest_opening"]
    figure, axes = style.new_figure(1, 5, width=16.5, height=3.7)
    columns = [("faces", "middle_width", "any rule\nclosed up to")]
    columns += [(rule, "crossing_width", f"{TITLES[rule]}\nopen beyond") for rule in TITLES]
    for panel, (rule, value, title) in zip(axes[0], columns, strict=True):
        rows = exact[exact["scheme"] == rule]
        levels = panel.tricontourf(
            rows["ratio_2"], rows["ratio_3"], rows[value], levels=12, cmap="cividis"
        )
        figure.colorbar(levels, ax=panel, label=r"$L/\ell$ [-]", shrink=0.8)
        panel.set_aspect("equal")
        panel.set_xlabel(r"$n_2 / n_1$ [-]")
        panel.set_ylabel(r"$n_3 / n_1$ [-]")
        panel.set_title(title, fontsize=9)
    figure.suptitle(
        r"A plane gap in space, exact volumes, normals $n_1 \geq n_2 \geq n_3 \geq 0$ "
        f"(closed form; patches of cells agree to {max(gap.abs().max(), 1e-9):.1g})",
        fontsize=11,
    )
    return figure
