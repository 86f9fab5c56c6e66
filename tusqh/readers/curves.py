"""Replace a curve by chords that stay close to it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tusqh.grid import FloatArray

#: Largest distance of a curve from its polyline, relative to the larger side of the drawing.  In a
#: grid of a hundred cells this is a hundredth of a cell, too little to affect a volume fraction.
CHORD_TOLERANCE = 1e-4

#: Largest number of chords for one curve, regardless of the tolerance.
MOST_CHORDS = 4096


def flatten_curve(
    points_at: Callable[[FloatArray], FloatArray], tolerance: float, *, fewest: int = 4
) -> FloatArray:
    """Return points on a curve, including both ends, whose chords stay within a tolerance of it.

    Parameters
    ----------
    points_at
        Function that returns the points, shape (n, 2), at parameters from 0 to 1, shape (n,).
    tolerance
        Largest distance of the curve from its chords, in the units of the model.
    fewest
        Initial number of chords, which is doubled until the chords fit.

    Examples
    --------
    >>> parabola = lambda t: np.column_stack([t, t * t])
    >>> len(flatten_curve(parabola, 0.02)), len(flatten_curve(parabola, 0.001))
    (5, 17)
    """
    # Compare three points inside every chord, because a single one could be an inflection.
    weight = np.array([0.25, 0.5, 0.75])[:, None]
    n_chords = fewest
    while True:
        fine = points_at(np.linspace(0.0, 1.0, 4 * n_chords + 1))
        start, end = fine[:-1:4, None], fine[4::4, None]
        inside = fine[:-1].reshape(n_chords, 4, 2)[:, 1:]
        off = np.linalg.norm(inside - (start + weight * (end - start)), axis=2)
        # This form ends the search for non-finite coordinates, which are rejected later.
        if not off.max() > tolerance or 2 * n_chords > MOST_CHORDS:
            return fine[::4]
        n_chords *= 2
