"""Winding numbers of triangles at scattered points, by a tree (Barill et al., 2018).

A node of the tree that is far from a point counts as one dipole: the sum of the vector areas of its
triangles, at their centre.  Near triangles count exactly, by their solid angles.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.halving import halve_triangles

#: A node is far if its centre is at least this many of its radii away.
_FAR = 3.0
#: Most triangles in a leaf.
_LEAF = 8


class WindingTree(NamedTuple):
    """Triangles sorted into a binary tree.

    Parameters
    ----------
    corners
        The triangles in the order of the leaves, shape (m, 3, 3).
    first, last
        Triangles of every node, shape (n,) each.
    child
        The first of the two children of every node, -1 for a leaf, shape (n,).
    centre, dipole
        Centre and sum of the vector areas of every node, shape (n, 3) each.
    radius
        Largest distance of a corner from the centre, shape (n,).
    """

    corners: FloatArray
    first: IntArray
    last: IntArray
    child: IntArray
    centre: FloatArray
    dipole: FloatArray
    radius: FloatArray


def plant(corners: FloatArray) -> WindingTree:
    """Return the tree of triangles.

    Parameters
    ----------
    corners
        Corners of every triangle, shape (m, 3, 3), at least one triangle.
    """
    middle = corners.mean(axis=1)
    order = np.arange(len(corners))
    first, last, child = halve_triangles(middle, order, _LEAF)
    corners = np.ascontiguousarray(corners[order])
    vectors = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    centre, dipole = np.empty((len(first), 3)), np.empty((len(first), 3))
    radius = np.empty(len(first))
    _sum_nodes(corners, vectors, first, last, centre, dipole, radius)
    return WindingTree(corners, first, last, child, centre, dipole, radius)


def wind_beside(tree: WindingTree, points: FloatArray, steps: FloatArray) -> FloatArray:
    """Return the winding numbers at both ends of short steps around points, shape (n, 2).

    What is far counts once for both ends.

    Parameters
    ----------
    tree
        The triangles.
    points
        The points, shape (n, 3).
    steps
        Vectors, shape (n, 3): the ends are ``points + steps`` and ``points - steps``.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> faces = np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]])
    >>> at, step = np.array([[0.2, 0.2, 0.0]]), np.array([[0.0, 0.0, 0.1]])
    >>> (wind_beside(plant(points[faces]), at, step).round(6) + 0.0).tolist()
    [[1.0, 0.0]]
    """
    found = np.empty((len(points), 2))
    _wind(tree, np.ascontiguousarray(points), np.ascontiguousarray(steps), found)
    return found


@numba.njit(cache=True, parallel=True)
def _sum_nodes(corners, vectors, first, last, centre, dipole, radius):  # type: ignore[no-untyped-def]
    """Fill in the centre, the dipole and the radius of every node."""
    for node in numba.prange(len(first)):
        total = 0.0
        at, way = np.zeros(3), np.zeros(3)
        for i in range(first[node], last[node]):
            area = np.sqrt((vectors[i] ** 2).sum()) + 1e-300
            total += area
            for k in range(3):
                way[k] += vectors[i, k]
                at[k] += area * (corners[i, 0, k] + corners[i, 1, k] + corners[i, 2, k]) / 3
        at /= total
        reach = 0.0
        for i in range(first[node], last[node]):
            for c in range(3):
                reach = max(reach, ((corners[i, c] - at) ** 2).sum())
        centre[node], dipole[node], radius[node] = at, way, np.sqrt(reach)


@numba.njit(cache=True)
def _solid_angle(corner, x, y, z):  # type: ignore[no-untyped-def]
    """Return half the solid angle of a triangle (van Oosterom and Strackee, 1983)."""
    ax, ay, az = corner[0, 0] - x, corner[0, 1] - y, corner[0, 2] - z
    bx, by, bz = corner[1, 0] - x, corner[1, 1] - y, corner[1, 2] - z
    cx, cy, cz = corner[2, 0] - x, corner[2, 1] - y, corner[2, 2] - z
    la = np.sqrt(ax * ax + ay * ay + az * az)
    lb = np.sqrt(bx * bx + by * by + bz * bz)
    lc = np.sqrt(cx * cx + cy * cy + cz * cz)
    volume = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    below = la * lb * lc + (ax * bx + ay * by + az * bz) * lc
    below += (bx * cx + by * cy + bz * cz) * la + (cx * ax + cy * ay + cz * az) * lb
    return np.arctan2(volume, below)


@numba.njit(cache=True, parallel=True)
def _wind(tree, points, steps, found):  # type: ignore[no-untyped-def]
    """Fill in the winding numbers at both ends of every step."""
    for q in numba.prange(len(points)):
        px, py, pz = points[q, 0], points[q, 1], points[q, 2]
        sx, sy, sz = steps[q, 0], steps[q, 1], steps[q, 2]
        length = np.sqrt(sx * sx + sy * sy + sz * sz)
        stack = np.empty(128, dtype=np.int64)
        stack[0] = 0
        top = 1
        far, plus, minus = 0.0, 0.0, 0.0
        while top > 0:
            top -= 1
            node = stack[top]
            dx, dy, dz = (
                tree.centre[node, 0] - px,
                tree.centre[node, 1] - py,
                tree.centre[node, 2] - pz,
            )
            square = dx * dx + dy * dy + dz * dz
            if square > (_FAR * (tree.radius[node] + length)) ** 2:
                along = tree.dipole[node, 0] * dx + tree.dipole[node, 1] * dy
                along += tree.dipole[node, 2] * dz
                far += along / (square * np.sqrt(square))
            elif tree.child[node] >= 0:
                stack[top] = tree.child[node]
                stack[top + 1] = tree.child[node] + 1
                top += 2
            else:
                for i in range(tree.first[node], tree.last[node]):
                    plus += _solid_angle(tree.corners[i], px + sx, py + sy, pz + sz)
                    minus += _solid_angle(tree.corners[i], px - sx, py - sy, pz - sz)
        found[q, 0] = far / (4 * np.pi) + plus / (2 * np.pi)
        found[q, 1] = far / (4 * np.pi) + minus / (2 * np.pi)
