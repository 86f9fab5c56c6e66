"""Where the background grid lies: over a window, or over the geometry's bounding box."""

from __future__ import annotations

from typing import Any

from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid
from tusqh.sampling.fractions import Box


def to_window(window: dict[str, list[float]] | None) -> Box | None:
    """Return the window of a configuration entry as its two corners.

    >>> to_window({"lower": [0, 1], "upper": [2, 3]})
    ((0.0, 1.0), (2.0, 3.0))
    """
    if window is None:
        return None
    lower, upper = (tuple(float(x) for x in window[end]) for end in ("lower", "upper"))
    return lower, upper


def lay_grid(outline: Outline, window: Box | None, **size: Any) -> BackgroundGrid:
    """Return the background grid for an outline.

    Parameters
    ----------
    outline
        The geometry.
    window
        Box to cover instead of the bounding box, in model units.
    **size
        `cells` (an int, or one per axis) or `cell_size`, see `BackgroundGrid.over_box`.

    Raises
    ------
    SamplingError
        The box has no extent along an axis.
    """
    lower, upper = window or outline.bounding_box()
    if isinstance(size.get("cells"), list):
        size["cells"] = tuple(size["cells"])
    return BackgroundGrid.over_box(lower, upper, **size)
