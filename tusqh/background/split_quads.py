"""Split quads at pinch vertices, see `tusqh.background.split_hexes`."""

from __future__ import annotations

import numba
import numpy as np

from tusqh.background.growing import Growing, Parts
from tusqh.grid import FloatArray, IntArray

#: Radius of a ball as a share of the shortest edge at its vertex, and its most along an edge.
_RADIUS, _LONGEST = 0.4, 0.45


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
        entry = head[v]
        while entry >= 0:
            q, corner = entry >> 2, entry & 3
            entry = after[entry]
            if not alive[q]:
                continue
            a, f, b = cells[q, (corner + 1) % 4], cells[q, (corner + 2) % 4], cells[q, corner - 1]
            for side in range(2):
                w = a if side == 0 else b
                dx, dy = points[w, 0] - points[v, 0], points[w, 1] - points[v, 1]
                share = min(_LONGEST, _RADIUS * shortest[v] / np.sqrt(dx * dx + dy * dy))
                offset[side, 0], offset[side, 1] = share * dx, share * dy
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
