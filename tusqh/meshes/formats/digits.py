"""Keep the digits of coordinates, and their unit, in formats of short fields."""

from __future__ import annotations

import numpy as np

from tusqh.grid import FloatArray

#: Points farther from 0 than this many times their extent are moved.
_FAR = 1e4


def near_zero(points: FloatArray, mark: str) -> tuple[FloatArray, str]:
    """Return points, moved near 0 where short fields would lose digits, and a comment on that.

    Parameters
    ----------
    points
        Shape (n, 3).
    mark
        How a comment begins in the format.

    Returns
    -------
    points, comment
        The points, and one line, empty if nothing was moved.
    """
    low, extent = points.min(axis=0), float(np.ptp(points, axis=0).max())
    if np.abs(low).max() <= _FAR * extent:
        return points, ""
    offset = np.floor(low)
    shown = ", ".join(f"{x:.17g}" for x in offset)
    text = "Coordinates are relative to a point, so that they keep their digits:"
    return points - offset, f"{mark} {text} {shown}\n"


def unit_comment(unit: str, mark: str) -> str:
    """Return the comment on the unit of length of a file, empty if that is not known.

    Parameters
    ----------
    unit
        The unit.
    mark
        How a comment begins in the format.
    """
    return f"{mark} Unit of length: {unit}\n" if unit else ""
