"""Draw the pinches and their templates: the catalogue, pinches in series, connecting edges."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from studies.figures.shapes import FILLS, draw_shapes, legend_of
from studies.pinch_catalogue import STAGES
from tusqh.figures import style
from tusqh.figures.rendering import render, show, surface_of
from tusqh.meshes.volume_mesh import KINDS, VolumeMesh

_BOX = ((0.0, 0.0, 0.0), (2.0, 2.0, 2.0))


def draw_catalogue(facts: pd.DataFrame, elements: pd.DataFrame) -> Figure:
    """Return a figure with a column per configuration: its cells, and both decisions' meshes.

    Parameters
    ----------
    facts, elements
        See `studies.pinch_catalogue.tabulate_catalogue`.
    """
    cases = facts[["dimension", "case"]].drop_duplicates().to_numpy()
    figure, axes = style.new_figure(3, len(cases), width=18.0, height=5.4)
    for column, (dim, case) in enumerate(cases):
        for row, stage in enumerate(STAGES):
            panel = axes[row, column]
            chosen = _rows(elements, dim, case, stage)
            fact = _rows(facts, dim, case, stage).iloc[0]
            betti = f"{fact['components']}, {fact['holes']}"
            title = f"{stage}\n$\\beta$ = ({betti}{', ' + str(fact['voids']) if dim == 3 else ''})"
            if stage == "raw":
                edges = int(fact["pinch_edges"])
                title = (
                    "2D vertex\n"
                    if dim == 2
                    else f"case {case}: {edges} pinch\nedge{'s' * (edges != 1)}"
                )
            corners = chosen.filter(regex=r"^[xyz]\d$").to_numpy().reshape(-1, 8, 3)
            if dim == 2:
                colours = [FILLS[kind] for kind in chosen["kind"]]
                quads = corners[:, :4, :2]
                style.draw_polygons(
                    panel,
                    quads.reshape(-1, 2),
                    np.arange(4 * len(quads)).reshape(-1, 4),
                    colour=colours,
                    line_width=0.8,
                )
                panel.set_xlim(-0.3, 2.3)
                panel.set_ylim(-0.3, 2.3)
                panel.set_aspect("equal")
                panel.set_axis_off()
                panel.set_title(title, fontsize=9)
                continue
            kind = np.array([KINDS.index(name) for name in chosen["kind"]])
            points, cells = np.unique(corners.reshape(-1, 3).round(9), axis=0, return_inverse=True)
            mesh = VolumeMesh(points, cells.reshape(-1, 8), kind, kind * 0 - 1)
            look: dict[str, Any] = {"edge_color": "#203040", "line_width": 1.5, "show_edges": True}
            surface = surface_of(mesh)
            picture = render(surface, _BOX, size=(360, 360), scalars="rgb", rgb=True, **look)
            show(panel, picture, title)
    figure.suptitle(
        "The pinch of the plane and the eleven pinches of space: raw, separated and connected"
    )
    return figure


def _rows(table: pd.DataFrame, dim: int, case: int, stage: str) -> pd.DataFrame:
    of_case = (table["dimension"] == dim) & (table["case"] == case)
    return table[of_case & (table["stage"] == stage)]


def draw_panels(facts: pd.DataFrame, shapes: pd.DataFrame, *, columns: int, title: str) -> Figure:
    """Return a figure with panels of meshes and their measured Betti numbers.

    Parameters
    ----------
    facts, shapes
        Tables with the column `panel`, see `studies.pinch_catalogue.resolve_series`.
    columns
        Number of panels in a row.
    title
        Title of the figure.
    """
    n_rows = -(-len(facts) // columns)
    figure, axes = style.new_figure(n_rows, columns, width=4.4 * columns, height=2.1 * n_rows + 1)
    for panel, (_, fact) in zip(axes.ravel(), facts.iterrows(), strict=False):
        name = fact["panel"]
        betti = rf"$\beta_0$ = {fact['components']}, $\beta_1$ = {fact['holes']}"
        draw_shapes(panel, shapes[shapes["panel"] == name], f"{name}: {betti}")
    for panel in axes.ravel()[len(facts) :]:
        panel.set_axis_off()
    figure.legend(
        handles=legend_of(shapes), loc="outside lower center", ncols=7, frameon=False, fontsize=8
    )
    figure.suptitle(title)
    return figure
