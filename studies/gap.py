r"""Compute the fractions of a straight gap between two half-spaces, in any orientation and offset.

This is the setting of the paper's theorem: there is material everywhere except in a slab of width
``L`` around a middle plane (2D: line) with unit normal ``n``; cells have size 1 and the threshold
is 1/2.  The fraction of a cell of any dimension depends only on the signed distance ``u`` of its
centre from the middle plane: its fictitious cell is a unit cube whose points have the distances
``u + P``, where ``P`` is ``n . x`` for points ``x`` of a cube around the origin.  The gap fills at
most half of the cell exactly if ``L`` is at most twice the median of ``|u + P|``, which is the
cell's *critical width*.

With exact volumes it is the median of a continuous distribution (of a sum of uniform variables);
with ``s`` samples along each side it is the upper median of ``s**dim`` numbers.  A cell is kept if
``L <= critical width``, including ties, as in the paper.
"""

from __future__ import annotations

import itertools

import numpy as np
from numba import njit

from tusqh.grid import FloatArray

#: Number of bisections for a median, which give an accuracy of 1e-12.
_HALVINGS = 42

#: Components of a normal below this count as zero.
_FLAT = 1e-9


def sample_distances(normal: FloatArray, samples: int) -> FloatArray:
    """Return the signed distances of a cell's samples from the plane through its centre.

    Parameters
    ----------
    normal
        Unit normal, shape (dim,).
    samples
        Samples along each side; 0 for exact volumes, which need no samples.

    Examples
    --------
    >>> import numpy as np
    >>> sample_distances(np.array([1.0, 0.0]), 2).tolist()
    [-0.25, -0.25, 0.25, 0.25]
    """
    along = (np.arange(samples) + 0.5) / max(samples, 1) - 0.5
    points = np.array(list(itertools.product(along, repeat=len(normal)))).reshape(-1, len(normal))
    return points @ np.asarray(normal, dtype=np.float64)


@njit(cache=True)
def fraction_below(t: float, normal: FloatArray) -> float:
    """Return the fraction of the unit cube around the origin with ``n . x < t``.

    It is the sum of ``sign * max(t - n . corner, 0)**m / (m! prod n)`` over the corners of the
    cube, where ``m`` is the number of nonzero components of the normal; none is negative.

    Parameters
    ----------
    t
        Signed distance of the plane from the centre of the cube, in cell sizes.
    normal
        Unit normal, shape (dim,), no component negative.
    """
    if t > 0:  # The smaller part has smaller rounding errors.
        return 1.0 - fraction_below(-t, normal)
    m, product = 0, 1.0
    for k in range(len(normal)):
        if normal[k] > _FLAT:
            m += 1
            product *= m * normal[k]
    total = 0.0
    for corner in range(2**m):
        height, sign, bit = t, 1.0, 0
        for k in range(len(normal)):
            if normal[k] > _FLAT:
                if corner >> bit & 1:
                    height -= normal[k] / 2
                    sign = -sign
                else:
                    height += normal[k] / 2
                bit += 1
        if height > 0:
            total += sign * height**m
    return min(max(total / product, 0.0), 1.0)


@njit(cache=True)
def fraction_in_gap(u: float, width: float, normal: FloatArray) -> float:
    """Return the fraction of a cell that the gap fills.

    The centre of the cell is at the signed distance `u` from the middle of the gap.

    Parameters
    ----------
    u
        Signed distance of the cell's centre from the middle of the gap, in cell sizes.
    width
        Width of the gap, in cell sizes.
    normal
        Unit normal of the gap, shape (dim,), no component negative.

    Examples
    --------
    >>> import numpy as np
    >>> fraction_in_gap(0.25, 0.5, np.array([1.0, 0.0]))
    0.5
    """
    return fraction_below(width / 2 - u, normal) - fraction_below(-width / 2 - u, normal)


@njit(cache=True)
def critical_width(u: float, normal: FloatArray, distances: FloatArray) -> float:
    """Return the width up to which the gap leaves at least half of a cell.

    Parameters
    ----------
    u
        Signed distance of the cell's centre from the middle plane, in cell sizes.
    normal
        Unit normal of the gap, all components at least 0, shape (dim,).
    distances
        From `sample_distances`; empty for exact volumes.

    Examples
    --------
    A diagonal gap opens the cell in its middle at a width of sqrt(2) - 1 with exact areas, and at a
    larger width with 2 x 2 samples.

    >>> import numpy as np
    >>> diagonal = np.sqrt([0.5, 0.5])
    >>> round(critical_width(0.0, diagonal, np.empty(0)), 9)
    0.414213562
    >>> round(critical_width(0.0, diagonal, sample_distances(diagonal, 2)), 9)
    0.707106781
    """
    if len(distances):
        away: FloatArray = np.sort(np.abs(u + distances))
        return 2.0 * away[len(distances) // 2]  # type: ignore[no-any-return]
    u = abs(u)
    half_extent = float(normal.sum()) / 2
    if u >= half_extent / 2:  # One side of the gap passes through the centre, the other misses it.
        return 2.0 * u
    low, high = u, half_extent + u
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        if fraction_in_gap(u, 2 * middle, normal) > 0.5:
            high = middle
        else:
            low = middle
    return low + high
