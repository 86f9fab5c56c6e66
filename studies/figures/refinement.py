"""Draw meshes that do not converge: two blocks at a corner, and the islands of a wedge."""

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
    """Return a figure of the first refinements, and of all fractions and Betti numbers, by case.

    Parameters
    ----------
    rows
        See `studies.two_triangles.refine`.
    shapes
        See `studies.two_triangles.draw_refinements`.
    """
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
        "Two blocks that touch at a corner: kept cells at threshold 1/2, thresholds at which the "
        "blocks join, and Betti numbers"
    )
    return figure


def _draw_fractions(axes: Axes, rows: pd.DataFrame, case: str) -> None:
    """Draw the largest threshold at which each corner joins the blocks at each refinement."""
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
    axes.margins(y=0.25)  # Leave room for the legend.
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
    axes.margins(y=0.25)  # Leave room for the legend.
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("refinements")
    axes.set_ylabel("Betti numbers [-]")
    axes.legend(fontsize=7, frameon=False, loc="upper right", ncols=2)


def draw_wedge_islands(components: pd.DataFrame, grids: pd.DataFrame, *, degrees: float) -> Figure:
    """Return a figure of the components' positions on each grid, and of the number of islands.

    Parameters
    ----------
    components, grids
        See `studies.wedge_islands.follow_islands`.
    degrees
        Opening angle of the wedge.
    """
    figure, ((tracks, counts),) = style.new_figure(1, 2, width=13.0, height=5.4)
    _draw_tracks(tracks, components)
    _draw_counts(counts, grids, cotangent=1 / math.tan(math.radians(degrees)))
    figure.suptitle("A wedge under refinement: its islands move towards the apex and never vanish")
    return figure


def _draw_tracks(axes: Axes, components: pd.DataFrame) -> None:
    """Draw the components of each grid as bars, linked to the components that they continue."""
    last: pd.DataFrame | None = None
    for _, of_grid in components.groupby("grid"):
        table = of_grid.reset_index(drop=True)
        for is_main, colour in ((True, style.MATERIAL), (False, style.CONNECTING)):
            bars = table[table["is_main"] == is_main]
            axes.hlines(bars["cell_size"], bars["start"], bars["stop"], color=colour, linewidth=4)
        # A notch marks where an island begins, because some islands touch at a corner.
        islands = table[~table["is_main"]]
        axes.plot(
            islands["start"], islands["cell_size"], "|", color="white", markersize=6, zorder=4
        )
        if last is not None:
            _draw_links(axes, last, table)
        last = table
    axes.set_xscale("log")
    axes.set_yscale("log", base=2)
    axes.invert_yaxis()
    axes.set_xlabel("distance from the apex [-]")
    axes.set_ylabel("cell size [-], finer upwards")
    axes.set_title("islands (red) and main body (blue), linked to what they continue", fontsize=9)


def _draw_links(axes: Axes, last: pd.DataFrame, table: pd.DataFrame) -> None:
    """Draw a line from each component to the component of the coarser grid that it continues."""
    linked = table[table["continues"] >= 0]
    before = last.iloc[linked["continues"]]
    x_now, x_before = (
        part["start"].where(part["is_main"], np.sqrt(part["start"] * part["stop"])).to_numpy()
        for part in (linked, before)
    )
    sizes = [last["cell_size"].iloc[0], table["cell_size"].iloc[0]]
    for x, x_last in zip(x_now, x_before, strict=True):
        axes.plot([x_last, x], sizes, color="#777777", linewidth=0.7, zorder=3)


def _draw_counts(axes: Axes, grids: pd.DataFrame, *, cotangent: float) -> None:
    """Draw the number of islands on each grid, and their range of distances from the apex."""
    size = grids["cell_size"]
    for column, colour, label in (
        ("islands", style.CONNECTING, "islands of cells joined by faces"),
        ("islands_of_mesh", "C0", "islands of the anti-aliased mesh"),
    ):
        axes.step(size, grids[column], where="mid", color=colour, label=label)
    for column, marker, word in (
        ("first_in_cells", "v", "first"),
        ("last_in_cells", "^", "last"),
    ):
        axes.plot(
            size,
            grids[column],
            marker,
            color="#777777",
            markersize=4,
            label=f"{word} island [cells from the apex]",
        )
    axes.axhspan(
        cotangent / 2,
        cotangent,
        color="#999933",
        alpha=0.25,
        linewidth=0,
        label=r"the paper's $[1/2, 1] \cot\,\alpha$ [cells from the apex]",
    )
    axes.set_xscale("log", base=2)
    axes.invert_xaxis()
    axes.set_xlabel("cell size [-], finer to the right")
    axes.set_ylabel("number [-], or distance [cells]")
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    # Put the legend above the highest point.
    axes.set_ylim(top=1.5 * max(float(grids["last_in_cells"].max()), cotangent))
    axes.legend(fontsize=8, frameon=False)
