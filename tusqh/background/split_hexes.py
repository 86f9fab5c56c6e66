"""Split hexes at pinch vertices and edges, so that every pinch has elements of its own.

*Split at v* makes every hex at v a corner hex and three others, each between a face of the corner
hex and a face of the old hex that does not contain v (Schneiders, 1996)::

        b -------- f        A quad at v becomes a corner quad and two others.
        |        / |        Sides away from v stay whole, so the mesh conforms after each split,
        q --- c    |        whatever the number of cells at v, and splits can follow one another.
        |     |    |
        v --- p -- a

The corner hexes at a pinch vertex are its *ball*.  A pinch edge then runs from ball to ball; the
hexes that contain the rest of the edge are its *stick*.  Where a stick would touch a ball or a
stick with another decision, its ends on the balls are split as well, which makes it thinner.
"""

from __future__ import annotations

import numba
import numpy as np

from tusqh.background.growing import Growing, Parts
from tusqh.background.pinches import Pinches
from tusqh.grid import BoolArray, FloatArray, IntArray

#: Radius of a ball as a share of the shortest edge at its vertex, and its most along an edge.
_RADIUS, _LONGEST = 0.33, 0.45


def _turns() -> IntArray:
    """Return the corners of a hex as seen from each corner: o, x, xy, y, z, xz, far, yz."""
    at = np.array([[c in (1, 2, 5, 6), c in (2, 3, 6, 7), c >= 4] for c in range(8)]).astype(int)
    right_handed = [(1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7)]
    right_handed += [(7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3)]
    rows = []
    for o, (x, y, z) in enumerate(right_handed):
        step = {k: at[k] ^ at[o] for k in (x, y, z)}
        number = {tuple(a): k for k, a in enumerate(at)}
        ways = [(), (x,), (x, y), (y,), (z,), (x, z), (x, y, z), (y, z)]
        rows.append([number[tuple(at[o] ^ sum((step[k] for k in way), 0 * at[o]))] for way in ways])
    return np.array(rows, dtype=np.int64)


#: Corners of a hex in the order o, x, xy, y, z, xz, far, yz for each corner o.
TURNS = _turns()


def split_hexes(
    points: FloatArray,
    hexes: IntArray,
    shortest: FloatArray,
    pinches: Pinches,
    ends: IntArray,
    connects: tuple[BoolArray, BoolArray],
) -> Parts:
    """Return hexes, split at pinches.

    Parameters
    ----------
    points, hexes
        All hexes at pinch vertices.
    shortest
        Length of the shortest edge at every point, shape (n,).
    pinches
        The pinches.
    ends
        The vertices of every pinch edge, shape (q, 2).
    connects
        Whether each pinch vertex, and each pinch edge, connects.
    """
    number = np.full(len(points), -1, dtype=np.int64)
    number[pinches.vertices] = np.arange(len(pinches.vertices))
    ends = number[ends].reshape(-1, 2)
    flat = ends.ravel()
    start = np.zeros(len(pinches.vertices) + 1, dtype=np.int64)
    np.cumsum(np.bincount(flat, minlength=len(pinches.vertices)), out=start[1:])
    at_vertex = np.argsort(flat, kind="stable")
    reached = np.full((len(ends), 2), -1, dtype=np.int64)
    growing, done = Growing(points, hexes), 0
    n_steps = len(pinches.vertices) + len(ends)
    while True:
        done = _split_all(
            growing.arrays,
            TURNS,
            pinches.vertices,
            shortest,
            ends,
            start,
            at_vertex,
            reached,
            *connects,
            done,
        )
        if done == n_steps:
            break
        growing.grow()
    return growing.parts()


@numba.njit(cache=True)
def _count(arrays, v):  # type: ignore[no-untyped-def]
    """Return the number of hexes at a vertex."""
    _, _, _, _, alive, head, after, _ = arrays
    n, entry = 0, head[v]
    while entry >= 0:
        n += alive[entry >> 3]
        entry = after[entry]
    return n


@numba.njit(cache=True)
def _add_hex(arrays, corners, parent_of, tag_of):  # type: ignore[no-untyped-def]
    _, hexes, parent, tag, alive, head, after, counts = arrays
    h = counts[0]
    counts[0] += 1
    parent[h], tag[h], alive[h] = parent_of, tag_of, True
    for c in range(8):
        hexes[h, c] = corners[c]
        after[8 * h + c] = head[corners[c]]
        head[corners[c]] = 8 * h + c


@numba.njit(cache=True)
def _point(arrays, keys, values, n, a, b, c, x, y, z):  # type: ignore[no-untyped-def]
    """Return the new point with a key, and the number of keys; it is made if there is none."""
    points, counts = arrays[0], arrays[7]
    for k in range(n):
        if keys[k, 0] == a and keys[k, 1] == b and keys[k, 2] == c:
            return values[k], n
    keys[n, 0], keys[n, 1], keys[n, 2] = a, b, c
    values[n] = counts[1]
    points[counts[1], 0], points[counts[1], 1], points[counts[1], 2] = x, y, z
    counts[1] += 1
    return values[n], n + 1


@numba.njit(cache=True)
def _split(arrays, turns, v, new_tag, size, keys, values):  # type: ignore[no-untyped-def]
    """Split all hexes at a vertex; return the number of keys of new points.

    The key of a point on an edge is its other end with two -1.
    """
    points, hexes, parent, tag, alive, head, after, _ = arrays
    off, new, n = np.empty((3, 3)), np.empty(8, dtype=np.int64), 0
    child = np.empty(8, dtype=np.int64)
    entry = head[v]
    while entry >= 0:
        h, turn = entry >> 3, turns[entry & 7]
        entry = after[entry]
        if not alive[h]:
            continue
        r = hexes[h][turn]
        for k in range(3):
            w = r[(1, 3, 4)[k]]
            length = 0.0
            for axis in range(3):
                off[k, axis] = points[w, axis] - points[v, axis]
                length += off[k, axis] ** 2
            off[k] *= min(_LONGEST, size / np.sqrt(length))
        for way in range(1, 8):  # Bits: along x, y, z.
            p = points[v].copy()
            for k in range(3):
                if way >> k & 1:
                    p += off[k]
            if way in (1, 2, 4):
                key = (r[1] if way == 1 else r[3] if way == 2 else r[4], -1, -1)
            elif way == 7:
                key = (-1, -1, h)
            else:
                a = r[3] if way == 6 else r[1]
                b = r[3] if way == 3 else r[4]
                key = (min(a, b), max(a, b), r[2] if way == 3 else r[5] if way == 5 else r[7])
            new[way], n = _point(arrays, keys, values, n, key[0], key[1], key[2], p[0], p[1], p[2])
        px, py, pz, c = new[1], new[2], new[4], new[7]
        fxy, fxz, fyz = new[3], new[5], new[6]
        alive[h] = False
        old, own = tag[h], parent[h]
        child[:] = (v, px, fxy, py, pz, fxz, c, fyz)
        _add_hex(arrays, child, own, old if old else new_tag)
        child[:] = (px, r[1], r[2], fxy, fxz, r[5], r[6], c)
        _add_hex(arrays, child, own, old)
        child[:] = (py, fxy, r[2], r[3], fyz, c, r[6], r[7])
        _add_hex(arrays, child, own, old)
        child[:] = (pz, fxz, c, fyz, r[4], r[5], r[6], r[7])
        _add_hex(arrays, child, own, old)
    return n


@numba.njit(cache=True)
def _on_edge(keys, values, n, other):  # type: ignore[no-untyped-def]
    """Return the new point on the edge to another vertex."""
    for k in range(n):
        if keys[k, 0] == other and keys[k, 1] == -1 and keys[k, 2] == -1:
            return values[k]
    return -1


@numba.njit(cache=True)
def _list_bars(arrays, p, q, bars):  # type: ignore[no-untyped-def]
    """List the hexes without a tag that contain two points; return how many."""
    _, hexes, _, tag, alive, head, after, _ = arrays
    n, entry = 0, head[p]
    while entry >= 0:
        h = entry >> 3
        entry = after[entry]
        if alive[h] and tag[h] == 0:
            for w in hexes[h]:
                if w == q:
                    bars[n] = h
                    n += 1
    return n


@numba.njit(cache=True)
def _is_crowded(arrays, bars, one, two, n_vertices, edge_connects, connects):  # type: ignore[no-untyped-def]
    """Return whether a stick would touch what decides otherwise, or lie beside a ball."""
    _, hexes, _, tag, alive, head, after, _ = arrays
    for h in bars:
        for w in hexes[h]:
            is_at_end, entry = False, head[w]
            while entry >= 0:
                t = tag[entry >> 3] if alive[entry >> 3] else 0
                entry = after[entry]
                if t in (one, two):
                    is_at_end = True
                elif t > n_vertices:
                    if edge_connects[t - 1 - n_vertices] != connects:
                        return True
                elif t > 0:
                    return True
            if not is_at_end:
                return True
    return False


@numba.njit(cache=True)
def _least_distance(arrays, p, most):  # type: ignore[no-untyped-def]
    """Return the distance to the nearest other corner of the hexes at a point."""
    points, hexes, _, _, alive, head, after, _ = arrays
    least, entry = most, head[p]
    while entry >= 0:
        h = entry >> 3
        entry = after[entry]
        if alive[h]:
            for w in hexes[h]:
                if w != p:
                    least = min(least, np.sqrt(((points[w] - points[p]) ** 2).sum()))
    return least


@numba.njit(cache=True)
def _split_all(  # type: ignore[no-untyped-def]
    arrays,
    turns,
    vertices,
    shortest,
    ends,
    start,
    at_vertex,
    reached,
    connects,
    edge_connects,
    done,
):
    """Split at pinches from number `done` on, vertices first; stop where the arrays are full."""
    points, hexes, _, tag, _, _, _, counts = arrays
    n_vertices, n_edges = len(vertices), len(ends)
    while done < n_vertices + n_edges:
        if done < n_vertices:
            p = q = vertices[done]
        else:
            edge = done - n_vertices
            later = 0 if ends[edge, 0] > ends[edge, 1] else 1
            p, q = reached[edge, 1 - later], reached[edge, later]
        # Splitting at one point can triple the hexes at another.
        most = 4 * (_count(arrays, p) + _count(arrays, q)) + 8
        if counts[0] + 4 * most > len(hexes) or counts[1] + 7 * most > len(points):
            return done
        keys, values = np.empty((7 * most, 3), dtype=np.int64), np.empty(7 * most, dtype=np.int64)
        if done < n_vertices:
            n = _split(arrays, turns, p, 1 + done, _RADIUS * shortest[p], keys, values)
            for k in range(start[done], start[done + 1]):
                at, side = at_vertex[k] // 2, at_vertex[k] % 2
                other = reached[at, 1 - side]
                if other < 0:
                    other = vertices[ends[at, 1 - side]]
                reached[at, side] = _on_edge(keys, values, n, other)
        else:
            one, two, own = 1 + ends[edge, 0], 1 + ends[edge, 1], 1 + done
            bars = np.empty(most, dtype=np.int64)
            n_bars = _list_bars(arrays, p, q, bars)
            wish = edge_connects[edge]
            is_thin = connects[ends[edge, 0]] != wish or connects[ends[edge, 1]] != wish
            if is_thin or _is_crowded(
                arrays, bars[:n_bars], one, two, n_vertices, edge_connects, wish
            ):
                length = np.sqrt(((points[p] - points[q]) ** 2).sum())
                sizes = (
                    _RADIUS * _least_distance(arrays, p, length),
                    _RADIUS * _least_distance(arrays, q, length),
                )
                n = _split(arrays, turns, p, own, sizes[0], keys, values)
                p = _on_edge(keys, values, n, q)
                n = _split(arrays, turns, q, own, sizes[1], keys, values)
                q = _on_edge(keys, values, n, p)
                n_bars = _list_bars(arrays, p, q, bars)
            for k in range(n_bars):
                tag[bars[k]] = own
        done += 1
    return done
