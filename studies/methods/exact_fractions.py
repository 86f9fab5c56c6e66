"""Compute exact volume fractions of polygons in the plane, with floats or rational numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tusqh.grid import BackgroundGrid, FloatArray
from tusqh.sampling.doubled_grid import combine_half_blocks
from tusqh.sampling.fractions import VolumeFractions, round_fractions

#: Corners of a simple polygon, counter-clockwise.
Polygon = Sequence[tuple[Any, Any]]

#: Value of `VolumeFractions.samples` for fractions that are areas.
EXACT = 0


def area_in_boxes(polygon: Polygon, x: Any, y: Any, size: Any) -> Any:
    """Return the area of a polygon inside square boxes, exactly.

    By Green's theorem it is the sum, over the polygon's sides, of the integral of their height
    above the box's floor, clipped to the box.  Only rational arithmetic is used, so numbers of type
    `fractions.Fraction` give fractions without any rounding.

    Parameters
    ----------
    polygon
        Corners, counter-clockwise.
    x, y
        Lower left corners of the boxes, as numbers or arrays that broadcast.
    size
        Side of the boxes.

    Examples
    --------
    >>> from fractions import Fraction
    >>> triangle = [(0, 0), (Fraction(1, 3), 0), (0, 1)]
    >>> area_in_boxes(triangle, 0, 0, 1)
    Fraction(1, 6)
    """
    total: Any = 0
    for (x_a, y_a), (x_b, y_b) in zip(polygon, [*polygon[1:], polygon[0]], strict=True):
        if abs(x_b - x_a) <= _negligible(x_b - x_a) * size:
            continue
        slope = (y_b - y_a) / (x_b - x_a)
        start, stop = _clip(x_a - x, size), _clip(x_b - x, size)
        low, high = (y_a - y + slope * (x + end - x_a) for end in (start, stop))
        if abs(slope) <= _negligible(slope):
            total = total - (stop - start) * _clip((low + high) / 2, size)
        else:
            total = total - (_integral(high, size) - _integral(low, size)) / slope
    return total


def _negligible(number: Any) -> float:
    """Return the limit, due to rounding, below which a side counts as vertical or horizontal.

    The error is less than a thousandth of the resolution of fractions.
    """
    return 1e-8 if isinstance(number, float) else 0.0


def _clip(value: Any, size: Any) -> Any:
    return np.minimum(np.maximum(value, 0), size)


def _integral(height: Any, size: Any) -> Any:
    """Return the integral of a height clipped to a box, from 0 up to `height`."""
    clipped = _clip(height, size)
    return clipped * (2 * height - clipped) / 2


def exact_fractions(polygons: Sequence[Polygon], grid: BackgroundGrid) -> VolumeFractions:
    """Return the volume fractions of non-overlapping polygons, from areas instead of samples.

    Parameters
    ----------
    polygons
        Counter-clockwise corners of each polygon.
    grid
        A background grid in the plane.

    Examples
    --------
    >>> grid = BackgroundGrid(shape=(2, 1), cell_size=1.0, origin=(0.0, 0.0))
    >>> exact_fractions([[(0, 0), (2, 0), (0, 1)]], grid).cells.tolist()
    [[0.75], [0.25]]
    """
    blocks = _fill(polygons, grid, 2)
    return VolumeFractions(grid, EXACT, combine_half_blocks(blocks))


def exact_cell_fractions(polygons: Sequence[Polygon], grid: BackgroundGrid) -> FloatArray:
    """Return the fractions of the cells alone, shape n, for grids that are too fine for sub-cells.

    Parameters
    ----------
    polygons
        Triangles or quads that do not overlap, counter-clockwise.
    grid
        The background grid.

    Examples
    --------
    >>> grid = BackgroundGrid(shape=(2, 1), cell_size=1.0, origin=(0.0, 0.0))
    >>> exact_cell_fractions([[(0, 0), (2, 0), (0, 1)]], grid).tolist()
    [[0.75], [0.25]]
    """
    return round_fractions(_fill(polygons, grid, 1))


def _fill(polygons: Sequence[Polygon], grid: BackgroundGrid, parts: int) -> FloatArray:
    """Return the filled fraction of each part of each cell, computed near the polygons only."""
    size = grid.cell_size / parts
    filled = np.zeros(tuple(parts * n for n in grid.shape))
    for polygon in polygons:
        corners = np.array(polygon, dtype=np.float64) - grid.origin
        low = np.clip(np.floor(corners.min(axis=0) / size), 0, filled.shape).astype(int)
        high = np.clip(np.ceil(corners.max(axis=0) / size), 0, filled.shape).astype(int)
        x, y = (o + size * np.arange(a, b) for o, a, b in zip(grid.origin, low, high, strict=True))
        area = area_in_boxes(polygon, x[:, None], y[None, :], size)
        filled[low[0] : high[0], low[1] : high[1]] += area / size**2
    return filled
