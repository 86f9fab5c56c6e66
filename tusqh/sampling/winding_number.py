"""Generalized winding numbers of an outline (paper: Winding Numbers), by libigl."""

from __future__ import annotations

import numpy as np

from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray


def winding_number(outline: Outline, queries: FloatArray) -> FloatArray:
    """Return how often the outline winds around each point, exact to rounding.

    Parameters
    ----------
    outline
        Directed segments; open ends and overlaps are welcome.
    queries
        Points, shape (n, 2), in the units of the outline.

    Returns
    -------
    winding
        Shape (n,), dimensionless: the integral of the angle along all segments over 2 pi.
        Counter-clockwise loops count +1 inside; an open outline gives fractions.

    Examples
    --------
    >>> import numpy as np
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
    >>> inside = np.array([[0.5, 0.5]])
    >>> float(winding_number(Outline.from_chains([square]), inside).round(12)[0])
    1.0
    >>> float(winding_number(Outline.from_chains([square[:-1]]), inside).round(12)[0])
    0.75
    """
    import igl

    # Far from the origin (map coordinates) the differences below lose digits if taken late.
    centre = outline.points[outline.segments[0, 0]]
    return np.asarray(
        igl.winding_number(
            np.ascontiguousarray(outline.points - centre),
            np.ascontiguousarray(outline.segments),
            np.ascontiguousarray(queries - centre),
        ),
        dtype=np.float64,
    )
