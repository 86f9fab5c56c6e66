"""Measure the effect of anti-aliasing on a diagonal gap, a wedge, and a gap along the axes.

Paper: Topological Anti-aliasing and Anti-aliasing.  All examples have exact fractions, cells of
size 1 and threshold 1/2.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from studies.examples import GEOMETRY, mesh_example, mesh_rows, shape_rows
from studies.gap_kernels import RULES
from studies.gap_patch import measure_widths
from studies.methods.exact_fractions import Polygon, exact_fractions
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.grid import BackgroundGrid
from tusqh.settings.policy import Criteria, Policy

#: Widths of the paper's three gaps along the axes: below half a cell, above a cell, and between.
GAP_WIDTHS = (0.4, 0.75, 1.2)

#: Islands with fewer cells than this are removed after bridges have joined components.
_MIN_CELLS = 4


def diagonal_gap(width: float, degrees: float, size: int) -> list[Polygon]:
    """Return the two sides of an inclined gap through the middle of a square.

    Parameters
    ----------
    width
        Width of the gap, in cells.
    degrees
        Angle between the gap and the y axis, at most 45.
    size
        Side of the square, in cells.
    """
    lean = math.tan(math.radians(degrees))
    half = width / 2 / math.cos(math.radians(degrees))
    bottom, top = (size / 2 + lean * (y - size / 2) for y in (0.0, float(size)))
    return [
        [(0.0, 0.0), (bottom - half, 0.0), (top - half, float(size)), (0.0, float(size))],
        [(bottom + half, 0.0), (float(size), 0.0), (float(size), float(size)), (top + half, size)],
    ]


def wedge(apex: tuple[float, float], degrees: float, turn: float, length: float) -> Polygon:
    """Return a wedge of material as a triangle.

    Parameters
    ----------
    apex
        Apex of the wedge.
    degrees
        Opening angle.
    turn
        Direction of the axis, in degrees from the x axis.
    length
        Length of the axis, in cells.
    """
    low, high = (math.radians(turn + side * degrees / 2) for side in (-1, 1))
    reach = length / math.cos(math.radians(degrees / 2))
    ends = [
        (apex[0] + reach * math.cos(angle), apex[1] + reach * math.sin(angle))
        for angle in (low, high)
    ]
    return [apex, *ends]


def compare_examples() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return shapes and facts of the diagonal gap and the wedge before and after anti-aliasing.

    Returns
    -------
    shapes, facts
        One row per shape, and one row of facts per panel.
    """
    policy = Policy(components=Criteria(min_cells=_MIN_CELLS))
    square = BackgroundGrid(shape=(12, 12), cell_size=1.0, origin=(0.0, 0.0))
    strip = BackgroundGrid(shape=(40, 20), cell_size=1.0, origin=(0.0, 0.0))
    examples = [
        mesh_example("diagonal gap", diagonal_gap(1.0, 33.0, 12), square, policy=policy),
        mesh_example("wedge", [wedge((0.3, 0.7), 5.0, 27.0, 38.0)], strip, policy=policy),
    ]
    shapes, facts = zip(*examples, strict=True)
    return pd.concat(shapes, ignore_index=True), pd.DataFrame(facts)


def axis_gap(width: float, offset: float, grid: BackgroundGrid) -> list[Polygon]:
    """Return the two sides of a gap along the y axis; offset 0 centres it on a row of cells.

    Parameters
    ----------
    width
        Width of the gap, in cell sizes.
    offset
        Offset of its middle, in cell sizes.
    grid
        The background grid.
    """
    middle = (grid.shape[0] - 1) // 2 + 0.5 + offset
    x, y = grid.shape
    left, right = middle - width / 2, middle + width / 2
    return [
        [(0.0, 0.0), (left, 0.0), (left, float(y)), (0.0, float(y))],
        [(right, 0.0), (float(x), 0.0), (float(x), float(y)), (right, float(y))],
    ]


def sweep_axis_gap(n_offsets: int) -> pd.DataFrame:
    """Return the widths at which the gap closes and opens, for offsets over one period.

    There is one row per offset and rule (`studies.gap_kernels.RULES`); `components_<width>` counts
    the components of the measured mesh at the widths of the paper's three gaps.

    Parameters
    ----------
    n_offsets
        Number of offsets over one period.
    """
    grid = BackgroundGrid(shape=(7, 3), cell_size=1.0, origin=(0.0, 0.0))
    offsets = np.arange(n_offsets + 1) / n_offsets
    normal, exact = np.array([[1.0, 0.0]]), np.empty((1, 0))
    closing, opening = measure_widths(normal, offsets, exact, length=3)
    meshed = {
        f"components_{width:g}": [
            _count_components(axis_gap(width, float(offset), grid), grid) for offset in offsets
        ]
        for width in GAP_WIDTHS
    }
    tables = [
        pd.DataFrame(
            {
                "scheme": rule,
                "offset": offsets,
                "closing": closing[0, :, r],
                "opening": opening[0, :, r],
                **meshed,
            }
        )
        for r, rule in enumerate(RULES)
    ]
    return pd.concat(tables, ignore_index=True)


def _count_components(polygons: list[Polygon], grid: BackgroundGrid) -> int:
    cells = CellSets(exact_fractions(polygons, grid)).at(0.5)
    return build_mesh(cells, grid).mesh.measurement.by_euler.betti_0


def draw_axis_gaps() -> pd.DataFrame:
    """Return the shapes of the paper's three gaps, with the middle one at two offsets."""
    grid = BackgroundGrid(shape=(7, 6), cell_size=1.0, origin=(0.0, 0.0))
    small, middle, large = GAP_WIDTHS
    tables = []
    for width, offset in ((small, 0.2), (large, 0.2), (middle, 0.05), (middle, 0.5)):
        panel = f"gap {width:g}, offset {offset:g}"
        polygons = axis_gap(width, offset, grid)
        mesh = build_mesh(CellSets(exact_fractions(polygons, grid)).at(0.5), grid).mesh
        tables += [shape_rows(panel, GEOMETRY, np.array(p)[None]) for p in polygons]
        tables.append(mesh_rows(panel, mesh))
    return pd.concat(tables, ignore_index=True)
