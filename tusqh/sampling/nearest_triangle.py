"""Find the nearest point on triangles, by a tree of boxes."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.halving import halve_triangles

#: Most triangles in a leaf.
_LEAF = 4


class BoxTree(NamedTuple):
    """Triangles sorted into a binary tree of boxes.

    Parameters
    ----------
    corners
        The triangles in the order of the leaves, shape (m, 3, 3).
    order
        The number of each of them as it was given, shape (m,).
    first, last
        Triangles of every node, shape (n,) each.
    child
        The first of the two children of every node, -1 for a leaf, shape (n,).
    lower, upper
        Box of every node, shape (n, 3) each.
    """

    corners: FloatArray
    order: IntArray
    first: IntArray
    last: IntArray
    child: IntArray
    lower: FloatArray
    upper: FloatArray


class NearestPoints(NamedTuple):
    """The nearest points on triangles.

    Parameters
    ----------
    points
        The nearest point, shape (n, 3).
    triangle
        The triangle on which it lies, shape (n,); -1 if there is none.
    distance
        Distance to it, shape (n,); infinite if there is none.
    """

    points: FloatArray
    triangle: IntArray
    distance: FloatArray


def make_tree(corners: FloatArray) -> BoxTree:
    """Return the tree of triangles, which may be degenerate.

    Parameters
    ----------
    corners
        Corners of every triangle, shape (m, 3, 3).
    """
    order = np.arange(len(corners))
    first, last, child = halve_triangles(corners.mean(axis=1), order, _LEAF)
    corners = np.ascontiguousarray(corners[order], dtype=np.float64)
    lower, upper = np.empty((len(first), 3)), np.empty((len(first), 3))
    _bound(corners, first, last, child, lower, upper)
    return BoxTree(corners, order, first, last, child, lower, upper)


def find_nearest(tree: BoxTree, points: FloatArray, *, within: float = np.inf) -> NearestPoints:
    """Return the nearest point on any triangle of a tree for every point.

    Parameters
    ----------
    tree
        The triangles.
    points
        The points, shape (n, 3).
    within
        Triangles this far away or farther are not looked for; the distance is then infinite and the
        triangle -1.

    Examples
    --------
    >>> flat = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    >>> float(find_nearest(make_tree(flat), np.array([[0.25, 0.25, 2.0]])).distance[0])
    2.0
    """
    found = np.zeros((len(points), 3))
    which = np.full(len(points), -1, dtype=np.int64)
    square = np.full(len(points), within * within)
    if len(tree.corners):
        _search(tree, np.ascontiguousarray(points, dtype=np.float64), found, which, square)
    square[which < 0] = np.inf
    which[which >= 0] = tree.order[which[which >= 0]]
    return NearestPoints(found, which, np.sqrt(square))


@numba.njit(cache=True)
def _bound(corners, first, last, child, lower, upper):  # type: ignore[no-untyped-def]
    """Fill in the boxes, children before parents."""
    for node in range(len(first) - 1, -1, -1):
        if child[node] >= 0:
            a = child[node]
            for k in range(3):
                lower[node, k] = min(lower[a, k], lower[a + 1, k])
                upper[node, k] = max(upper[a, k], upper[a + 1, k])
        else:
            lower[node], upper[node] = np.inf, -np.inf
            for i in range(first[node], last[node]):
                for c in range(3):
                    for k in range(3):
                        lower[node, k] = min(lower[node, k], corners[i, c, k])
                        upper[node, k] = max(upper[node, k], corners[i, c, k])


@numba.njit(cache=True)
def _square_to_box(lower, upper, p):  # type: ignore[no-untyped-def]
    square = 0.0
    for k in range(3):
        away = max(lower[k] - p[k], p[k] - upper[k], 0.0)
        square += away * away
    return square


@numba.njit(cache=True)
def _nearest_on_segment(a, b, p, found):  # type: ignore[no-untyped-def]
    """Fill in the nearest point of a segment, and return the square of its distance."""
    along, length = 0.0, 0.0
    for k in range(3):
        along += (p[k] - a[k]) * (b[k] - a[k])
        length += (b[k] - a[k]) ** 2
    share = min(max(along / length, 0.0), 1.0) if length > 0 else 0.0
    square = 0.0
    for k in range(3):
        found[k] = a[k] + share * (b[k] - a[k])
        square += (p[k] - found[k]) ** 2
    return square


@numba.njit(cache=True)
def _nearest_on_triangle(corner, p, found, other):  # type: ignore[no-untyped-def]
    """Fill in the nearest point of a triangle, and return the square of its distance."""
    uu, uv, vv, wu, wv = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        u, v = corner[1, k] - corner[0, k], corner[2, k] - corner[0, k]
        w = p[k] - corner[0, k]
        uu += u * u
        uv += u * v
        vv += v * v
        wu += w * u
        wv += w * v
    determinant = uu * vv - uv * uv
    if determinant > 1e-14 * uu * vv:
        s, t = (vv * wu - uv * wv) / determinant, (uu * wv - uv * wu) / determinant
        if s >= 0 and t >= 0 and s + t <= 1:
            square = 0.0
            for k in range(3):
                found[k] = corner[0, k] + s * (corner[1, k] - corner[0, k])
                found[k] += t * (corner[2, k] - corner[0, k])
                square += (p[k] - found[k]) ** 2
            return square
    best = np.inf
    for side in range(3):
        square = _nearest_on_segment(corner[side], corner[(side + 1) % 3], p, other)
        if square < best:
            best = square
            found[:] = other
    return best


@numba.njit(cache=True, parallel=True)
def _search(tree, points, found, which, square):  # type: ignore[no-untyped-def]
    """Fill in the nearest point, its triangle and the square of the distance for every point.

    Only triangles nearer than the given square of a distance are found.
    """
    for q in numba.prange(len(points)):
        p = points[q]
        stack, away = np.empty(128, dtype=np.int64), np.empty(128)
        at, other = np.empty(3), np.empty(3)
        stack[0], away[0] = 0, 0.0
        top, best = 1, square[q]
        while top > 0:
            top -= 1
            if away[top] >= best:
                continue
            node = stack[top]
            if tree.child[node] < 0:
                for i in range(tree.first[node], tree.last[node]):
                    near = _nearest_on_triangle(tree.corners[i], p, at, other)
                    if near < best:
                        best = near
                        which[q] = i
                        found[q] = at
                continue
            a = tree.child[node]
            to_a = _square_to_box(tree.lower[a], tree.upper[a], p)
            to_b = _square_to_box(tree.lower[a + 1], tree.upper[a + 1], p)
            nearer, to_near, farther, to_far = a, to_a, a + 1, to_b
            if to_b < to_a:
                nearer, to_near, farther, to_far = a + 1, to_b, a, to_a
            stack[top], away[top] = farther, to_far
            stack[top + 1], away[top + 1] = nearer, to_near
            top += 2
        square[q] = best
