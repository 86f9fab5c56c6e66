"""Hanging nodes on the boundary of hex meshes, found by sorting points into bins."""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid import FloatArray, IntArray

#: Distances from a face, as a share of the longest edge, at which a point hangs on it.
_TOLERANCE = 1e-9


def count_points_in_faces(points: FloatArray, faces: IntArray) -> int:
    """Return how many points of some quads in space lie on another quad, or on its edges.

    Parameters
    ----------
    points
        Coordinates, shape (n, 3).
    faces
        Corners of the quads, shape (m, 4).

    Examples
    --------
    >>> square = [[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]
    >>> beside = [[2.0, 1, 0], [4, 1, 0], [4, 3, 0], [2, 3, 0]]
    >>> points = np.array(square + beside)
    >>> count_points_in_faces(points, np.array([[0, 1, 2, 3], [4, 5, 6, 7]]))
    2
    """
    used = np.unique(faces)
    corners = points[faces]
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    size = float((corners.max(axis=1) - corners.min(axis=1)).max())
    if size == 0:
        return 0
    # Bins as large as the largest face: a face touches at most eight of them.  Few bins overall.
    n_bins = np.minimum(np.maximum(((high - low) / size).astype(np.int64) + 1, 1), 512)
    width = np.maximum((high - low) / n_bins, size * 1e-12) * (1 + 1e-12)
    bin_of = np.minimum(((points[used] - low) / width).astype(np.int64), n_bins - 1)
    flat = np.ravel_multi_index(tuple(bin_of.T), tuple(n_bins))
    order = np.argsort(flat, kind="stable")
    start = np.searchsorted(flat[order], np.arange(int(np.prod(n_bins)) + 1))
    hangs = np.zeros(len(points), dtype=np.bool_)
    _mark(points, faces, used[order], start, low, width, n_bins, _TOLERANCE * size, hangs)
    return int(hangs.sum())


@numba.njit(cache=True)
def _mark(points, faces, used, start, low, width, n_bins, tolerance, hangs):  # type: ignore[no-untyped-def]
    first, last = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    for face in range(len(faces)):
        corners = faces[face]
        for axis in range(3):
            least, greatest = np.inf, -np.inf
            for corner in corners:
                least = min(least, points[corner, axis])
                greatest = max(greatest, points[corner, axis])
            first[axis] = max(0, int((least - tolerance - low[axis]) / width[axis]))
            last[axis] = min(
                n_bins[axis] - 1, int((greatest + tolerance - low[axis]) / width[axis])
            )
        for i in range(first[0], last[0] + 1):
            for j in range(first[1], last[1] + 1):
                for k in range(first[2], last[2] + 1):
                    at = (i * n_bins[1] + j) * n_bins[2] + k
                    for place in range(start[at], start[at + 1]):
                        point = used[place]
                        if hangs[point]:
                            continue
                        is_corner = False
                        for corner in corners:
                            if corner == point:
                                is_corner = True
                        if not is_corner and _is_on(points, corners, point, tolerance):
                            hangs[point] = True


@numba.njit(cache=True)
def _is_on(points, corners, point, tolerance):  # type: ignore[no-untyped-def]
    """Return whether a point lies on one of the two triangles of a quad."""
    p = points[point]
    for half in range(2):
        a = points[corners[0]]
        b, c = points[corners[1 + half]], points[corners[2 + half]]
        u, v, w = b - a, c - a, p - a
        normal = np.cross(u, v)
        area = np.sqrt((normal * normal).sum())
        if area == 0.0 or abs((normal * w).sum()) > tolerance * area:
            continue
        s = (np.cross(w, v) * normal).sum() / (area * area)
        t = (np.cross(u, w) * normal).sum() / (area * area)
        slack = tolerance / np.sqrt(area)
        if s >= -slack and t >= -slack and s + t <= 1 + slack:
            return True
    return False
