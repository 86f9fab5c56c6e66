"""Meshes that do not converge: two blocks at a corner, and the islands of a wedge."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from studies.figures.shapes import draw_shapes
from tusqh.figures import style

_CORNERS = {"2/3": "C0", "1/3": "C1"}


def draw_two_triangles(rows: pd.DataFrame, shapes: pd.DataFrame) -> Figure:
    """Return the first refinements of all cases, then what happens at every one of them."""
    names = list(dict.fromkeys(shapes["panel"]))
    cases = list(dict.fromkeys(rows["case"]))
    n_drawn = len(names) // len(cases)
    figure, axes = style.new_figure(len(cases), n_drawn + 2, width=15.5, height=9.0)
    for r, case in enumerate(cases):
        of_case = rows[rows["case"] == case]
        for k in range(n_drawn):
            name = names[r * n_drawn + k]
            fact = of_case.iloc[k]
            title = (
                rf"{name}" + "\n" + rf"{fact['fractions']}, $\beta$ = "
                f"({fact['components']}, {fact['holes']})"
            )
            draw_shapes(axes[r, k], shapes[shapes["panel"] == name], title)
            axes[r, k].set_xlabel("x [-]")
            axes[r, k].set_ylabel("y [-]")
        _draw_fractions(axes[r, n_drawn], rows, case)
        _draw_betti(axes[r, n_drawn + 1], of_case)
    figure.suptitle(
        "Two blocks touching at a corner: the cells kept at threshold 1/2, the thresholds at "
        "which the blocks join, and the topology"
    )
    return figure


def _draw_fractions(axes: Axes, rows: pd.DataFrame, case: str) -> None:
    """Draw the vineyard: the threshold at which each corner joins the blocks, by refinement."""
    corners = list(_CORNERS) if case == "both" else [case]
    for corner in corners:
        of_corner = rows[rows["case"] == corner]
        axes.plot(
            of_corner["refinements"],
            of_corner["largest_fraction"],
            "o-",
            color=_CORNERS[corner],
            markersize=4,
            linewidth=0.9,
            label=f"corner at {corner}",
        )
    axes.axhline(0.5, color="black", linewidth=0.8, linestyle="--")
    axes.set_yticks([7 / 18, 0.5, 10 / 18], ["7/18", "1/2", "10/18"])
    axes.set_ylim(0.33, 0.64)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("refinements")
    axes.set_ylabel("joined below threshold [-]")
    axes.legend(fontsize=7, frameon=False, loc="upper right", ncols=2)


def _draw_betti(axes: Axes, of_case: pd.DataFrame) -> None:
    level = of_case["refinements"]
    axes.step(level, of_case["components"], where="mid", color="C0", label=r"$\beta_0$, cells")
    axes.step(level, of_case["holes"], where="mid", color="C1", label=r"$\beta_1$, cells")
    axes.plot(
        level,
        of_case["sub_cell_components"],
        "o",
        mfc="none",
        color="C0",
        markersize=5,
        label=r"$\beta_0$, mesh",
    )
    axes.plot(
        level,
        of_case["sub_cell_holes"],
        "s",
        mfc="none",
        color="C1",
        markersize=5,
        label=r"$\beta_1$, mesh",
    )
    axes.set_ylim(-0.3, 3.1)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("refinements")
    axes.set_ylabel("Betti numbers [-]")
    axes.legend(fontsize=7, frameon=False, loc="upper right", ncols=2)


def draw_wedge_islands(components: pd.DataFrame, grids: pd.DataFrame, *, degrees: float) -> Figure:
    """Return where the components lie on every grid, linked to what they continue; their number.

    `degrees` is the opening angle of the wedge.
    """
    cotangent = 1 / math.tan(math.radians(degrees))
    figure, (row,) = style.new_figure(1, 2, width=13.0, height=5.4)
    tracks, counts = row
    last: pd.DataFrame | None = None
    for _, of_grid in components.groupby("grid"):
        table = of_grid.reset_index(drop=True)
        size = table["cell_size"]
        for is_main, colour in ((True, style.MATERIAL), (False, style.CONNECTING)):
            chosen = table["is_main"] == is_main
            tracks.hlines(
                size[chosen],
                table["start"][chosen],
                table["stop"][chosen],
                color=colour,
                linewidth=4,
            )
        islands = table[~table["is_main"]]  # A notch where one begins: some touch at a corner.
        tracks.plot(
            islands["start"], islands["cell_size"], "|", color="white", markersize=6, zorder=4
        )
        if last is not None:
            linked = table[table["continues"] >= 0]
            before = last.iloc[linked["continues"]]
            ends = [
                t["start"].where(t["is_main"], np.sqrt(t["start"] * t["stop"]))
                for t in (linked, before)
            ]
            for x1, x0 in zip(*ends, strict=True):
                tracks.plot(
                    [x0, x1],
                    [last["cell_size"].iloc[0], size.iloc[0]],
                    color="#777777",
                    linewidth=0.7,
                    zorder=3,
                )
        last = table
    tracks.set_xscale("log")
    tracks.set_yscale("log", base=2)
    tracks.invert_yaxis()
    tracks.set_xlabel("distance from the apex [-]")
    tracks.set_ylabel("cell size [-], finer upwards")
    tracks.set_title("islands (red) and main body (blue), linked to what they continue", fontsize=9)
    counts.step(
        grids["cell_size"],
        grids["islands"],
        where="mid",
        color=style.CONNECTING,
        label="islands of cells joined by faces",
    )
    counts.step(
        grids["cell_size"],
        grids["islands_of_mesh"],
        where="mid",
        color="C0",
        label="islands of the anti-aliased mesh",
    )
    for end, marker in (("first", "v"), ("last", "^")):
        counts.plot(
            grids["cell_size"],
            grids[f"{end}_in_cells"],
            marker,
            color="#777777",
            markersize=4,
            label=f"{'begin' if end == 'first' else 'end'} of the islands [cells from the apex]",
        )
    counts.axhspan(
        cotangent / 2,
        cotangent,
        color="#999933",
        alpha=0.25,
        linewidth=0,
        label=r"the paper's $[1/2, 1] \cot\,\alpha$ [cells from the apex]",
    )
    counts.set_xscale("log", base=2)
    counts.invert_xaxis()
    counts.set_xlabel("cell size [-], finer to the right")
    counts.set_ylabel("number [-], or distance [cells]")
    counts.yaxis.set_major_locator(MaxNLocator(integer=True))
    counts.set_ylim(-0.5, 27)
    counts.legend(fontsize=8, frameon=False)
    figure.suptitle("A wedge under refinement: its archipelago moves to the apex and never goes")
    return figure
