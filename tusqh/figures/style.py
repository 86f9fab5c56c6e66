"""The common style of all figures, with colour-blind-safe colours of fixed meaning."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from tusqh.atomic import replacing
from tusqh.figures.theme import PALETTE, THEME
from tusqh.figures.units import length_scale as length_scale
from tusqh.geometry.image import Image
from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray, IntArray

MATERIAL = "#a9d6ee"
REMOVED = "#222222"
ADDED = "#e7298a"
FILLED = "#5b8db8"
OUTLINE = "#888888"
#: Edges of elements, and the geometry over them in a section.
ELEMENT_EDGE = "#6f93a6"
SECTION = "#b3262e"
CONNECTING = PALETTE[3]
SEPARATING = PALETTE[2]
BRIDGE = PALETTE[1]
CHOSEN = PALETTE[2]
PEER_COLOURS = (PALETTE[3], "#222222", PALETTE[0], PALETTE[2], PALETTE[4], PALETTE[1])
INTERIOR_VERTEX = PALETTE[0]
INTERIOR_EDGE = PALETTE[4]
DIMENSION_COLOURS = (PALETTE[0], PALETTE[1], PALETTE[2])
#: The mesh in figures of curves, for classes of any dimension.
MESH_LINE = PALETTE[0]
#: Colours of volume fractions below 0 and above 1, where a geometry is inside out or overlaps.
BELOW_RANGE, ABOVE_RANGE = PALETTE[3], PALETTE[6]
DIMENSION_NAMES = ("components", "holes", "voids")

#: Label of every axis of thresholds, which extends from 0 to 1.
THRESHOLD_LABEL = "volume-fraction threshold [-]"

_DPI = 150
#: Ratio of width to height above which a box counts as wide.
_WIDE = 3
_WITHOUT_TIME_AND_VERSION: dict[str, dict[str, Any]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


def new_figure(n_rows: int, n_columns: int, *, width: float, height: float) -> tuple[Figure, Any]:
    """Return a figure with its axes, in the project's style.

    Parameters
    ----------
    n_rows, n_columns
        Number of panels.
    width, height
        Size in inches.

    Returns
    -------
    figure : matplotlib.figure.Figure
        The figure.
    axes : numpy.ndarray
        Its axes, shape (n_rows, n_columns).
    """
    plt.style.use(THEME)
    return plt.subplots(
        n_rows, n_columns, figsize=(width, height), layout="constrained", squeeze=False
    )


def save(figure: Figure, path: Path) -> None:
    """Write a figure as a PNG, SVG or PDF file, which is never incomplete and is reproducible.

    Parameters
    ----------
    figure
        The figure; it is closed.
    path
        The file.
    """
    with replacing(path) as temporary, mpl.rc_context({"svg.hashsalt": "tusqh"}):
        figure.savefig(temporary, dpi=_DPI, metadata=_WITHOUT_TIME_AND_VERSION[path.suffix])
    plt.close(figure)


def duration(seconds: float) -> str:
    """Return a time as text, in a unit that suits its size.

    Parameters
    ----------
    seconds
        The time, in s.

    Examples
    --------
    >>> duration(172800.0), duration(7200.0), duration(30.0), duration(0.0), duration(2.5e-4)
    ('2 d', '2 h', '30 s', '0 s', '0.25 ms')
    """
    for size, unit in ((86400.0, "d"), (3600.0, "h")):
        if seconds >= 2 * size or (seconds >= size and seconds % size == 0):
            return f"{seconds / size:.3g} {unit}"
    if 0 < seconds < 1e-4:
        return f"{1e6 * seconds:.3g} µs"
    if 0 < seconds < 0.1:
        return f"{1e3 * seconds:.3g} ms"
    return f"{seconds:.3g} s"


def unit_text(unit: str) -> str:
    """Return a unit in the form for figures, with a raised exponent.

    Parameters
    ----------
    unit
        A unit as in the tables, such as ``J/m^3``.

    Examples
    --------
    >>> unit_text("J/m^3"), unit_text("s")
    ('J/m$^3$', 's')
    """
    base, caret, exponent = unit.partition("^")
    return f"{base}$^{exponent}$" if caret else base


def is_wide(lower: Any, upper: Any) -> bool:
    """Return whether a box is so wide that its panels should be stacked.

    Parameters
    ----------
    lower, upper
        Corners of the box, shape (2,).

    Examples
    --------
    >>> is_wide((0, 0), (80, 22)), is_wide((0, 0), (80, 80))
    (True, False)
    """
    width, height = np.subtract(upper, lower)
    return bool(width > _WIDE * height)


def draw_polygons(
    axes: Axes, points: FloatArray, cells: IntArray, *, colour: Any, line_width: float = 0.0
) -> None:
    """Fill elements with one common colour or with individual colours.

    Parameters
    ----------
    axes
        The axes on which to draw.
    points
        Coordinates, shape (n, 2).
    cells
        Corners of the elements, shape (m, k).
    colour
        One colour, or m colours.
    line_width
        Width of the edges in points; 0 for none.
    """
    # Without edges of the same colour, white seams appear between neighbours.
    edge, width = ("#406070", line_width) if line_width else ("face", 0.3)
    axes.add_collection(
        PolyCollection(list(points[cells]), facecolors=colour, edgecolors=edge, linewidths=width)
    )


def lines_of(geometry: Outline | Image) -> FloatArray:
    """Return the segments of an outline, or those between full and empty pixels of a picture.

    Parameters
    ----------
    geometry
        The outline or picture.

    Returns
    -------
    lines
        Ends of the segments, shape (n, 2, 2).

    Examples
    --------
    >>> len(lines_of(Image(np.array([[0.0, 1.0], [1.0, 1.0]]))))
    8
    """
    if isinstance(geometry, Outline):
        return np.asarray(geometry.points[geometry.segments])
    is_full = np.pad(geometry.fractions() >= 0.5, 1)
    lines = []
    for axis in range(2):
        start = np.argwhere(np.diff(is_full, axis=axis))
        start[:, 1 - axis] -= 1  # The padding, which the difference removes along the other axis.
        lines.append(np.stack([start, start + np.eye(2, dtype=np.int64)[1 - axis]], axis=1))
    corners = np.concatenate(lines) * geometry.voxel_size
    return np.asarray(corners + np.asarray(geometry.origin))


def draw_outline(axes: Axes, geometry: Outline | Image, scale: float) -> None:
    """Draw the geometry as thin grey lines.

    Parameters
    ----------
    axes
        The axes on which to draw.
    geometry
        The outline or picture.
    scale
        Divisor of coordinates.
    """
    lines = lines_of(geometry) / scale
    axes.add_collection(LineCollection(list(lines), colors=OUTLINE, linewidths=0.4, zorder=3))


def frame(axes: Axes, lower: Any, upper: Any, unit: str) -> None:
    """Show a box at true proportions, with units on the axes.

    Parameters
    ----------
    axes
        The axes on which to draw.
    lower, upper
        Corners of the box, shape (2,).
    unit
        Unit of length.
    """
    axes.set_xlim(lower[0], upper[0])
    axes.set_ylim(lower[1], upper[1])
    axes.set_aspect("equal")
    axes.set_xlabel(f"x [{unit}]")
    axes.set_ylabel(f"y [{unit}]")
