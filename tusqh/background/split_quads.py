"""Split quads at pinch vertices, see `tusqh.background.split_hexes`."""

from __future__ import annotations

import numba
import numpy as np

from tusqh.background.growing import Growing, Parts
from tusqh.grid import FloatArray, IntArray

#: Radius of a ball as a share of the shortest edge at its vertex, and its most along an edge.
_RADIUS, _LONGEST = 0.4, 0.45
#: Factor of the radius where a quad would be inverted, and most tries.
_SMALLER, _TRIES = 0.6, 12


def split_quads(
    points: FloatArray, quads: IntArray, shortest: FloatArray, vertices: IntArray
) -> Parts:
    """Return quads, split at pinch vertices.

    Parameters
    ----------
    points, quads
        All quads at pinch vertices.
    shortest
        Length of the shortest edge at every point, shape (n,).
    vertices
        The pinch vertices, shape (p,).
    """
    growing, done = Growing(points, quads), 0
    while True:
        done = _split_all(growing.arrays, vertices, shortest, done)
        if done == len(vertices):
            return growing.parts()
        growing.grow()


@numba.njit(cache=True)
def _add_quad(arrays, corners, parent_of, tag_of):  # type: ignore[no-untyped-def]
    _, cells, parent, tag, alive, head, after, counts = arrays
    q = counts[0]
    counts[0] += 1
    parent[q], tag[q], alive[q] = parent_of, tag_of, True
    for c in range(4):
        cells[q, c] = corners[c]
        after[4 * q + c] = head[corners[c]]
        head[corners[c]] = 4 * q + c


@numba.njit(cache=True)
def _offset(points, v, w, size):  # type: ignore[no-untyped-def]
    """Return the step from a vertex towards another one."""
    dx, dy = points[w, 0] - points[v, 0], points[w, 1] - points[v, 1]
    share = min(_LONGEST, size / np.sqrt(dx * dx + dy * dy))
    return share * dx, share * dy


@numba.njit(cache=True)
def _is_valid(corners):  # type: ignore[no-untyped-def]
    """Return whether a quad is positive at all corners."""
    for k in range(4):
        here, after, before = corners[k], corners[(k + 1) % 4], corners[k - 1]
        ax, ay = after[0] - here[0], after[1] - here[1]
        bx, by = before[0] - here[0], before[1] - here[1]
        if ax * by - ay * bx <= 0.0:
            return False
    return True


@numba.njit(cache=True)
def _radius(arrays, v, size):  # type: ignore[no-untyped-def]
    """Return a radius with which no new quad at a vertex is inverted, if one is found."""
    points, cells, _, _, alive, head, after, _ = arrays
    corners = np.empty((4, 2))
    for _ in range(_TRIES):
        fits, entry = True, head[v]
        while entry >= 0:
            q, corner = entry >> 2, entry & 3
            entry = after[entry]
            if not alive[q]:
                continue
            a, f, b = cells[q, (corner + 1) % 4], cells[q, (corner + 2) % 4], cells[q, corner - 1]
            px, py = _offset(points, v, a, size)
            rx, ry = _offset(points, v, b, size)
            x, y = points[v, 0], points[v, 1]
            corners[0, 0], corners[0, 1] = x + px, y + py
            corners[1], corners[2] = points[a], points[f]
            corners[3, 0], corners[3, 1] = x + px + rx, y + py + ry
            fits = fits and _is_valid(corners)
            corners[0] = corners[3].copy()
            corners[1], corners[2] = points[f], points[b]
            corners[3, 0], corners[3, 1] = x + rx, y + ry
            fits = fits and _is_valid(corners)
        if fits:
            break
        size *= _SMALLER
    return size


@numba.njit(cache=True)
def _split_all(arrays, vertices, shortest, done):  # type: ignore[no-untyped-def]
    """Split at vertices from number `done` on; stop where the arrays are full."""
    points, cells, parent, tag, alive, head, after, counts = arrays
    offset, new, child = np.empty((2, 2)), np.empty(2, np.int64), np.empty(4, np.int64)
    while done < len(vertices):
        v, most, entry = vertices[done], 0, head[vertices[done]]
        while entry >= 0:
            most += alive[entry >> 2]
            entry = after[entry]
        if counts[0] + 3 * most > len(alive) or counts[1] + 3 * most > len(points):
            return done
        ends, made, n = np.empty(2 * most, np.int64), np.empty(2 * most, np.int64), 0
        size = _radius(arrays, v, _RADIUS * shortest[v])
        entry = head[v]
        while entry >= 0:
            q, corner = entry >> 2, entry & 3
            entry = after[entry]
            if not alive[q]:
                continue
            a, f, b = cells[q, (corner + 1) % 4], cells[q, (corner + 2) % 4], cells[q, corner - 1]
            for side in range(2):
                w = a if side == 0 else b
                offset[side, 0], offset[side, 1] = _offset(points, v, w, size)
                k = 0
                while k < n and ends[k] != w:
                    k += 1
                if k == n:
                    ends[n], made[n] = w, counts[1]
                    points[counts[1]] = points[v] + offset[side]
                    counts[1] += 1
                    n += 1
                new[side] = made[k]
            c = counts[1]
            counts[1] += 1
            points[c] = points[v] + offset[0] + offset[1]
            alive[q] = False
            child[:] = (v, new[0], c, new[1])
            _add_quad(arrays, child, parent[q], tag[q] if tag[q] else 1 + done)
            child[:] = (new[0], a, f, c)
            _add_quad(arrays, child, parent[q], tag[q])
            child[:] = (c, f, b, new[1])
            _add_quad(arrays, child, parent[q], tag[q])
        done += 1
    return done
