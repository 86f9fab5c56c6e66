r"""Refine two blocks that touch at a corner, whose meshes never converge (paper: Non-convergence).

Their sides have the slopes -3 and 1; the corner is at (2/3, 0) or at (1/3, 0)::

        ________      ___          The cell with the corner is 10/18 full if the corner is
       |  left  \    / right       2/3 of the way along its bottom side, 7/18 full at 1/3; every
       |_________\  /_______       refinement turns one into the other.
                  \/
                corner

With *both* corners between the same two blocks (the second corner upside down and below the first)
exactly one corner is joined at a time.  The blocks are cut at a distance of one from the corner, so
only the corner is a small feature.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pandas as pd

from studies.examples import GEOMETRY, cell_rows, shape_rows
from studies.methods.digital_topology import closed_betti
from studies.methods.exact_fractions import (
    Polygon,
    area_in_boxes,
    exact_cell_fractions,
    exact_fractions,
)
from tusqh.antialias.cells import CellSets
from tusqh.grid import BackgroundGrid

#: The corners of each case, by the numerator of their x coordinate over 3.
CASES = {"2/3": (2,), "1/3": (1,), "both": (2, 1)}

#: Number of refinements up to which the sub-cells are also examined.
_SUB_CELL_LEVELS = 7

#: Number of refinements that are drawn.
_DRAWN_LEVELS = 4


def blocks_at_corner(thirds: int, *, upside_down: bool = False) -> list[Polygon]:
    """Return the exact blocks left and right of the corner at (thirds/3, 0).

    Upside down, they are below the line ``y = -1``.

    Parameters
    ----------
    thirds
        Position of the corner along x, in thirds of the unit.
    upside_down
        Whether the blocks are below the line ``y = -1``.

    Examples
    --------
    >>> blocks_at_corner(2)[0][1:3]
    [(Fraction(2, 3), 0), (Fraction(1, 3), 1)]
    """
    x = Fraction(thirds, 3)
    blocks: list[Polygon] = [
        [(-1, 0), (x, 0), (x - Fraction(1, 3), 1), (-1, 1)],
        [(x, 0), (2, 0), (2, 1), (x + 1, 1)],
    ]
    if not upside_down:
        return blocks
    return [[(a, -1 - b) for a, b in reversed(block)] for block in blocks]


def blocks_of(case: str) -> list[Polygon]:
    """Return the exact geometry of a case, without overlaps.

    Parameters
    ----------
    case
        Name of the case.
    """
    corners = CASES[case]
    blocks = blocks_at_corner(corners[0])
    if len(corners) == 2:
        blocks += [[(a, -1), (a + 1, -1), (a + 1, 0), (a, 0)] for a in (-1, 1)]
        blocks += blocks_at_corner(corners[1], upside_down=True)
    return blocks


def grid_of(case: str, level: int) -> BackgroundGrid:
    """Return the unit grid over a case, refined `level` times; the origin is a grid vertex.

    Parameters
    ----------
    case
        Name of the case.
    level
        Number of refinements.
    """
    n = 2**level
    low = -2 if case == "both" else 0
    return BackgroundGrid(shape=(3 * n, (1 - low) * n), cell_size=1 / n, origin=(-1.0, float(low)))


def corner_fraction(thirds: int, level: int) -> Fraction:
    """Return the exact filled fraction of the cell with the corner.

    Parameters
    ----------
    thirds
        Position of the corner along x, in thirds of the unit.
    level
        Number of refinements.

    Examples
    --------
    >>> [str(corner_fraction(2, level)) for level in range(4)]
    ['5/9', '7/18', '5/9', '7/18']
    """
    size = Fraction(1, 2**level)
    x = Fraction(thirds, 3) // size * size
    area = sum(area_in_boxes(block, x, 0, size) for block in blocks_at_corner(thirds))
    return Fraction(area) / size**2


def refine(n_refinements: int) -> pd.DataFrame:
    """Return one row per case and refinement, with fractions at the corners and topology at 1/2.

    `joined` names the corners whose cell is kept.  `components` and `holes` count those of the kept
    cells, which have no pinches; `sub_cell_components` and `sub_cell_holes` count those of the mesh
    with all sub-cells and bridges, up to 7 refinements.

    Parameters
    ----------
    n_refinements
        Number of refinements.
    """
    return pd.DataFrame([_row(case, level) for case in CASES for level in range(n_refinements + 1)])


def _row(case: str, level: int) -> dict[str, Any]:
    grid = grid_of(case, level)
    polygons = [[(float(a), float(b)) for a, b in block] for block in blocks_of(case)]
    kept = exact_cell_fractions(polygons, grid) >= 0.5
    raw = closed_betti(kept)
    fractions = {thirds: corner_fraction(thirds, level) for thirds in CASES[case]}
    row: dict[str, Any] = {
        "case": case,
        "refinements": level,
        "cell_size": grid.cell_size,
        "fractions": " and ".join(f"{f * 18}/18" for f in fractions.values()),
        "largest_fraction": float(max(fractions.values())),
        "smallest_fraction": float(min(fractions.values())),
        "joined": " ".join(f"{t}/3" for t, f in fractions.items() if 2 * f >= 1) or "none",
        "components": raw.betti_0,
        "holes": raw.betti_1,
    }
    if level <= _SUB_CELL_LEVELS:
        predicted = CellSets(exact_fractions(polygons, grid)).at(0.5).predicted
        row["sub_cell_components"] = predicted.betti_0
        row["sub_cell_holes"] = predicted.betti_1
    return row


def draw_refinements() -> pd.DataFrame:
    """Return the kept cells around the corners of every case in the first refinements."""
    tables = []
    for case in CASES:
        for level in range(_DRAWN_LEVELS):
            panel = f"{case}: {level} refinements"
            grid = grid_of(case, level)
            polygons = [[(float(a), float(b)) for a, b in block] for block in blocks_of(case)]
            kept = exact_cell_fractions(polygons, grid) >= 0.5
            tables += [shape_rows(panel, GEOMETRY, np.array(p)[None]) for p in polygons]
            tables.append(cell_rows(panel, kept, grid))
    return pd.concat(tables, ignore_index=True)
