"""Find hanging nodes: boundary points inside a boundary side (in 2D) or face (in 3D).

Points of hex meshes are sorted into bins, because `scipy.spatial.cKDTree.query_ball_point` on the
centres of the faces takes four times as long (7.7 s against 2.1 s for 506,000 faces).
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid import FloatArray, IntArray

#: Distance at which a point is on a side or face, as a share of the longest one.  Hanging nodes
#: lie there up to rounding, so a tolerance far below the element size is enough.
_TOLERANCE = 1e-9


def count_hanging_nodes(points: FloatArray, boundary: IntArray) -> int:
    """Return the number of boundary points inside a boundary side (in 3D a face or its edge).

    Parameters
    ----------
    points
        Coordinates, shape (n, dim).
    boundary
        Points of the boundary facets, shape (m, 2**(dim - 1)).

    Examples
    --------
    >>> square = [[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]
    >>> beside = [[2.0, 1, 0], [4, 1, 0], [4, 3, 0], [2, 3, 0]]
    >>> points = np.array(square + beside)
    >>> count_hanging_nodes(points, np.array([[0, 1, 2, 3], [4, 5, 6, 7]]))
    2
    """
    return len(find_hanging_nodes(points, boundary))


def find_hanging_nodes(points: FloatArray, boundary: IntArray) -> IntArray:
    """Return the boundary points inside a boundary side (in 3D a face or its edge), ascending.

    Parameters
    ----------
    points, boundary
        See `count_hanging_nodes`.
    """
    if len(boundary) == 0:
        return np.zeros(0, dtype=np.int64)
    find = _find_on_sides if boundary.shape[1] == 2 else _find_on_faces
    return find(points, boundary)


def _find_on_sides(points: FloatArray, sides: IntArray) -> IntArray:
    import shapely

    lines = shapely.linestrings(points[sides])
    candidates = np.unique(sides)
    node, side = shapely.STRtree(lines).query(
        shapely.points(points[candidates]),
        predicate="dwithin",
        distance=_TOLERANCE * float(shapely.length(lines).max()),
    )
    is_end = (sides[side] == candidates[node][:, None]).any(axis=1)
    return np.asarray(np.unique(candidates[node[~is_end]]), dtype=np.int64)


class _Bins(NamedTuple):
    """Points sorted into a lattice of bins, which are at least as large as the largest face.

    Parameters
    ----------
    low, width
        Lowest corner of the lattice and size of a bin, shape (3,).
    shape
        Number of bins along each axis, shape (3,).
    points
        Point numbers, sorted by bin.
    start
        Index in `points` at which each bin starts; the last entry is the number of points.
    """

    low: FloatArray
    width: FloatArray
    shape: IntArray
    points: IntArray
    start: NDArray[np.int32]


def _find_on_faces(points: FloatArray, faces: IntArray) -> IntArray:
    corners = points[faces]
    size = float((corners.max(axis=1) - corners.min(axis=1)).max())
    if size == 0:
        return np.zeros(0, dtype=np.int64)
    hangs = np.zeros(len(points), dtype=np.bool_)
    _mark(points, faces, _sort_into_bins(points, np.unique(faces), size), _TOLERANCE * size, hangs)
    return np.flatnonzero(hangs).astype(np.int64)


def _sort_into_bins(points: FloatArray, used: IntArray, size: float) -> _Bins:
    """Return the bins of the used points; a bin is at least as large as the largest face."""
    low, high = points[used].min(axis=0), points[used].max(axis=0)
    # A face overlaps at most eight bins, and there are at most 512 along an axis.
    shape = np.minimum(np.maximum(((high - low) / size).astype(np.int64) + 1, 1), 512)
    width = np.maximum((high - low) / shape, size * 1e-12) * (1 + 1e-12)
    bin_of = np.minimum(((points[used] - low) / width).astype(np.int64), shape - 1)
    flat = np.ravel_multi_index(tuple(bin_of.T), tuple(shape))
    order = np.argsort(flat, kind="stable")
    start = np.zeros(int(np.prod(shape)) + 1, dtype=np.int32)
    _count_before(flat, start)
    return _Bins(low=low, width=width, shape=shape, points=used[order], start=start)


@numba.njit(cache=True)
def _count_before(bins, start):  # type: ignore[no-untyped-def]
    """Add the number of points in lower bins to `start`, which is one longer than the bins."""
    for number in bins:
        start[number + 1] += 1
    for number in range(1, len(start)):
        start[number] += start[number - 1]


@numba.njit(cache=True)
def _mark(points, faces, bins, tolerance, hangs):  # type: ignore[no-untyped-def]
    """Mark the points that lie on a face without being its corner."""
    first, last = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    for corners in faces:
        for axis in range(3):
            least, greatest = np.inf, -np.inf
            for corner in corners:
                least = min(least, points[corner, axis])
                greatest = max(greatest, points[corner, axis])
            low, width = bins.low[axis], bins.width[axis]
            first[axis] = max(0, int((least - tolerance - low) / width))
            last[axis] = min(bins.shape[axis] - 1, int((greatest + tolerance - low) / width))
        for i in range(first[0], last[0] + 1):
            for j in range(first[1], last[1] + 1):
                for k in range(first[2], last[2] + 1):
                    flat = (i * bins.shape[1] + j) * bins.shape[2] + k
                    inside = bins.points[bins.start[flat] : bins.start[flat + 1]]
                    _mark_those_on(points, corners, inside, tolerance, hangs)


@numba.njit(cache=True)
def _mark_those_on(points, corners, candidates, tolerance, hangs):  # type: ignore[no-untyped-def]
    """Mark the candidates that lie on one face."""
    for point in candidates:
        if hangs[point] or point in corners:
            continue
        for half in range(2):
            a, b, c = corners[0], corners[1 + half], corners[2 + half]
            if _is_on(points[a], points[b], points[c], points[point], tolerance):
                hangs[point] = True


@numba.njit(cache=True)
def _is_on(a, b, c, point, tolerance):  # type: ignore[no-untyped-def]
    """Return whether a point lies on a triangle."""
    u, v, w = b - a, c - a, point - a
    normal = np.cross(u, v)
    area = np.sqrt((normal * normal).sum())
    if area == 0.0 or abs((normal * w).sum()) > tolerance * area:
        return False
    s = (np.cross(w, v) * normal).sum() / (area * area)
    t = (np.cross(u, w) * normal).sum() / (area * area)
    slack = tolerance / np.sqrt(area)
    return s >= -slack and t >= -slack and s + t <= 1 + slack
