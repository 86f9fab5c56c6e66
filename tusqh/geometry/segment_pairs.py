"""Determine which segments cross, touch or overlap: the predicates of `describe_defects`.

Coordinates are compared exactly to distinguish two segments that share an end point from two that
cross.  All other decisions use one tolerance, the rounding of the coordinates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from tusqh.grid import BoolArray, FloatArray, IntArray

#: A point lies on a line when it is nearer than this many units in the last place of the
#: largest coordinate: decimal coordinates are not exactly collinear as binary numbers.
ROUNDING_ULPS = 8.0


@dataclass(frozen=True)
class SegmentPairs:
    """Pairs of segments that cross, overlap or touch.

    Parameters
    ----------
    crossings
        Pairs whose interiors cross in a point, shape (n, 2), segment numbers.
    overlaps
        Pairs that are collinear and share a positive length without being the same, shape
        (m, 2).
    shared_lengths
        Length that each pair of `overlaps` shares, shape (m,), in the units of the model.
    touching
        Indices of the end points that lie inside another segment, shape (k,), sorted and unique.
    """

    crossings: IntArray
    overlaps: IntArray
    shared_lengths: FloatArray
    touching: IntArray


def rounding_of(points: FloatArray) -> float:
    """Return the tolerance, in model units, that coordinates of this size need.

    Parameters
    ----------
    points
        Coordinates, shape (n, 2).

    Examples
    --------
    >>> import numpy as np
    >>> rounding_of(np.array([[0.0, 1.0]])) == 8 * 2.0**-52
    True
    """
    return float(ROUNDING_ULPS * np.spacing(np.abs(points).max()))


def compare_segments(points: FloatArray, segments: IntArray) -> SegmentPairs:
    """Return how segments of positive length meet, other than by sharing end points.

    Parameters
    ----------
    points
        Distinct points, shape (n, 2); equal coordinates have equal indices.
    segments
        Start and end point of every segment, shape (m, 2).  Segments of zero length meet
        nothing.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([[0.0, 0.0], [2.0, 2.0], [0.0, 2.0], [2.0, 0.0]])
    >>> compare_segments(points, np.array([[0, 1], [2, 3]])).crossings.tolist()
    [[0, 1]]
    """
    tolerance = rounding_of(points)
    first, second = _near_pairs(points, segments, tolerance).T
    starts, ends = points[segments[:, 0]], points[segments[:, 1]]
    # The longer segment is the reference line, because short segments have ill-defined directions.
    lengths = np.linalg.norm(ends - starts, axis=1)
    swap = lengths[first] < lengths[second]
    first, second = np.where(swap, second, first), np.where(swap, first, second)

    c_along, c_off = _relative(starts[second], starts[first], ends[first])
    d_along, d_off = _relative(ends[second], starts[first], ends[first])
    a_along, a_off = _relative(starts[first], starts[second], ends[second])
    b_along, b_off = _relative(ends[first], starts[second], ends[second])
    a, b = segments[first].T
    c, d = segments[second].T

    is_collinear = (np.abs(c_off) <= tolerance) & (np.abs(d_off) <= tolerance)
    shared = np.minimum(np.maximum(c_along, d_along), lengths[first]) - np.maximum(
        np.minimum(c_along, d_along), 0.0
    )
    is_same = ((a == c) & (b == d)) | ((a == d) & (b == c))
    is_overlap = is_collinear & (shared > tolerance) & ~is_same

    shares_end = (a == c) | (a == d) | (b == c) | (b == d)
    is_crossing = (
        _on_both_sides(c_off, d_off, tolerance) & _on_both_sides(a_off, b_off, tolerance)
    ) & ~shares_end

    touching = [
        end[~is_collinear & (np.abs(off) <= tolerance) & _inside(along, length, tolerance)]
        for end, along, off, length in (
            (c, c_along, c_off, lengths[first]),
            (d, d_along, d_off, lengths[first]),
            (a, a_along, a_off, lengths[second]),
            (b, b_along, b_off, lengths[second]),
        )
    ]
    pairs = np.column_stack([np.minimum(first, second), np.maximum(first, second)])
    return SegmentPairs(
        crossings=pairs[is_crossing],
        overlaps=pairs[is_overlap],
        shared_lengths=shared[is_overlap],
        touching=np.unique(np.concatenate(touching)),
    )


def _near_pairs(points: FloatArray, segments: IntArray, tolerance: float) -> IntArray:
    """Return the pairs of segments of positive length whose boxes meet, shape (n, 2)."""
    proper = np.flatnonzero(segments[:, 0] != segments[:, 1])
    corners = points[segments[proper]]
    low, high = corners.min(axis=1) - tolerance, corners.max(axis=1) + tolerance
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    left, right = shapely.STRtree(boxes).query(boxes)
    once = left < right
    pairs: IntArray = proper[np.column_stack([left[once], right[once]])].astype(np.int64)
    return np.asarray(pairs[np.lexsort(pairs.T[::-1])])


def _relative(
    point: FloatArray, start: FloatArray, end: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the positions of points along and off (left positive) a segment, shape (n,) each."""
    direction = end - start
    length = np.linalg.norm(direction, axis=1)
    offset = point - start
    along = (offset * direction).sum(axis=1) / length
    off = (direction[:, 0] * offset[:, 1] - direction[:, 1] * offset[:, 0]) / length
    return along, off


def _on_both_sides(off: FloatArray, other: FloatArray, tolerance: float) -> BoolArray:
    """Return whether two signed distances from a line lie strictly on opposite sides."""
    return (np.minimum(off, other) < -tolerance) & (np.maximum(off, other) > tolerance)


def _inside(along: FloatArray, length: FloatArray, tolerance: float) -> BoolArray:
    """Return whether a position along a segment lies strictly between its ends."""
    return (along > tolerance) & (along < length - tolerance)
