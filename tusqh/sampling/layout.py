"""Where the background grid lies: over a window, or over the geometry's bounding box."""

from __future__ import annotations

from typing import Any

from tusqh.errors import SamplingError
from tusqh.grid import BackgroundGrid
from tusqh.sampling.field import Geometry
from tusqh.sampling.lattice import Box


def to_window(window: dict[str, list[float]] | None) -> Box | None:
    """Return the window of a configuration entry as its two corners.

    >>> to_window({"lower": [0, 1], "upper": [2, 3]})
    ((0.0, 1.0), (2.0, 3.0))
    """
    if window is None:
        return None
    lower, upper = (tuple(float(x) for x in window[end]) for end in ("lower", "upper"))
    return lower, upper


def lay_grid(geometry: Geometry, window: Box | None, **size: Any) -> BackgroundGrid:
    """Return the background grid for a geometry.

    Parameters
    ----------
    geometry
        The geometry.
    window
        Box to cover instead of the bounding box, in model units.
    **size
        `cells` (an int, or one per axis) or `cell_size`, see `BackgroundGrid.over_box`.

    Raises
    ------
    SamplingError
        The box has no extent along an axis, or another number of axes than the geometry.
    """
    lower, upper = window or geometry.bounding_box()
    dim = len(geometry.bounding_box()[0])
    cells = size.get("cells")
    wrong = [
        f"`{key}` has {n} numbers"
        for key, n in (
            ("window", len(lower)),
            ("grid.cells", len(cells) if isinstance(cells, list) else dim),
        )
        if n != dim
    ]
    if wrong:
        raise SamplingError(
            f"{' and '.join(wrong)}, the geometry has {dim} dimensions",
            where=geometry.name,
            expected=f"{dim} numbers, one for each axis",
            remedy="give one number for each axis",
        )
    if isinstance(size.get("cells"), list):
        size["cells"] = tuple(size["cells"])
    return BackgroundGrid.over_box(lower, upper, **size)
