"""The energy of a vertex of a quad mesh, and sweeps that lower it (compiled).

A corner of a quad with the edges a and b, which leave its vertex, has the determinant d = a x b.
The energy of a vertex sums ``f**p + BARRIER / d`` over all corners that it changes, with
``f = (|a|^2 + |b|^2) / (2 d)``, which is 1 for a square, and adds
``lam (x - q)^T A (x - q)``, the distance from its planes.  The determinant is affine in the vertex,
so each problem is smooth while d is positive: Newton steps with a line search, and no step that
makes a determinant non-positive.  The energy is the one of Garanzha et al. (2021), in the plane.
"""

from __future__ import annotations

import numba
import numpy as np

#: Weight of the term that keeps quads from shrinking to points.
BARRIER = 0.02

#: Longest step of a vertex in a sweep, in cells.
_LONGEST = 0.25

#: A step shorter than this is not taken, in cells.
_SHORTEST = 1e-6


@numba.njit(cache=True)
def _corner(points, cells, neighbours, cell, local, own, x, y, values):  # type: ignore[no-untyped-def]
    """Fill in d, its gradient, |a|^2 + |b|^2 and its gradient and curvature, for one corner.

    `own` is 0 for the corner at the vertex itself, 1 and 2 for the corners at its neighbours.
    """
    if own == 0:
        i, j = cells[cell, neighbours[local, 0]], cells[cell, neighbours[local, 1]]
        ax, ay = points[i, 0] - x, points[i, 1] - y
        bx, by = points[j, 0] - x, points[j, 1] - y
        values[0] = ax * by - ay * bx
        values[1], values[2] = ay - by, bx - ax
        values[4], values[5], values[6] = -2 * (ax + bx), -2 * (ay + by), 4.0
        values[7] = values[0] / np.sqrt((ax * ax + ay * ay) * (bx * bx + by * by) + 1e-300)
    else:
        other = neighbours[local, own - 1]
        at = cells[cell, other]
        is_first = neighbours[other, 0] == local
        k = cells[cell, neighbours[other, 1 if is_first else 0]]
        sign = 1.0 if is_first else -1.0
        ax, ay = x - points[at, 0], y - points[at, 1]
        bx, by = points[k, 0] - points[at, 0], points[k, 1] - points[at, 1]
        values[0] = sign * (ax * by - ay * bx)
        values[1], values[2] = sign * by, -sign * bx
        values[4], values[5], values[6] = 2 * ax, 2 * ay, 2.0
        values[7] = values[0] / np.sqrt((ax * ax + ay * ay) * (bx * bx + by * by) + 1e-300)
    values[3] = ax * ax + ay * ay + bx * bx + by * by


@numba.njit(cache=True)
def _energy(points, cells, neighbours, first, corner, v, x, y, power, values):  # type: ignore[no-untyped-def]
    """Return the energy of the quads at a vertex, infinite where a determinant is not positive."""
    total = 0.0
    for e in range(first[v], first[v + 1]):
        for own in range(3):
            _corner(points, cells, neighbours, corner[e] >> 2, corner[e] & 3, own, x, y, values)
            if values[0] <= 1e-9:
                return np.inf
            f = values[3] / (2 * values[0])
            total += f**power + BARRIER / values[0]
    return total


@numba.njit(cache=True)
def _derivatives(points, cells, neighbours, first, corner, v, x, y, power, values, out):  # type: ignore[no-untyped-def]
    """Fill in energy, gradient and curvature at a vertex: E, Ex, Ey, Exx, Exy, Eyy."""
    out[:] = 0.0
    for e in range(first[v], first[v + 1]):
        for own in range(3):
            _corner(points, cells, neighbours, corner[e] >> 2, corner[e] & 3, own, x, y, values)
            d, gx, gy, q, qx, qy, qq = values[:7]
            f = q / (2 * d)
            k1, k2, k3 = 0.5 / d, -0.5 / (d * d), q / (d * d * d)
            fx, fy = k1 * qx + q * k2 * gx, k1 * qy + q * k2 * gy
            raised = f**power
            m1 = power * raised / f
            m2 = (power - 1) * m1 / f
            v1, v2 = -BARRIER / (d * d), 2 * BARRIER / (d * d * d)
            out[0] += raised + BARRIER / d
            out[1] += m1 * fx + v1 * gx
            out[2] += m1 * fy + v1 * gy
            out[3] += m1 * (k1 * qq + 2 * k2 * qx * gx + k3 * gx * gx) + m2 * fx * fx + v2 * gx * gx
            out[4] += m1 * (k2 * (qx * gy + gx * qy) + k3 * gx * gy) + m2 * fx * fy + v2 * gx * gy
            out[5] += m1 * (k1 * qq + 2 * k2 * qy * gy + k3 * gy * gy) + m2 * fy * fy + v2 * gy * gy


@numba.njit(cache=True)
def sweep_points(  # type: ignore[no-untyped-def]
    points, cells, neighbours, first, corner, order, is_free, weight, matrix, goal, power, moved
):
    """Move each vertex of `order` once by a Newton step.

    Parameters
    ----------
    points
        Coordinates in cells, shape (n, 2), which change in place.
    cells, neighbours
        Quads, shape (m, 4), and `tusqh.meshes.jacobians.QUAD_NEIGHBOURS`.
    first, corner
        For each vertex its corners as ``4 * quad + local corner``: where they begin in the list,
        shape (n + 1,), and the list.
    order
        The vertices to move, in this order.
    is_free
        Coordinates that may change, shape (n, 2); others stay as they are, bit for bit.
    weight, matrix, goal
        lam, shape (n,); the entries xx, xy, yy of A, shape (n, 3); and q, shape (n, 2).
    power
        p, at least 1.
    moved
        Receives the length of the step of each vertex, shape (n,).
    """
    values, out = np.empty(8), np.empty(6)
    for v in order:
        x, y, lam = points[v, 0], points[v, 1], weight[v]
        axx, axy, ayy = matrix[v, 0], matrix[v, 1], matrix[v, 2]
        _derivatives(points, cells, neighbours, first, corner, v, x, y, power, values, out)
        dx, dy = x - goal[v, 0], y - goal[v, 1]
        energy = out[0] + lam * (axx * dx * dx + 2 * axy * dx * dy + ayy * dy * dy)
        gx = out[1] + 2 * lam * (axx * dx + axy * dy)
        gy = out[2] + 2 * lam * (axy * dx + ayy * dy)
        hxx, hxy, hyy = out[3] + 2 * lam * axx, out[4] + 2 * lam * axy, out[5] + 2 * lam * ayy
        if not is_free[v, 0]:
            gx, hxx, hxy = 0.0, 1.0, 0.0
        if not is_free[v, 1]:
            gy, hyy, hxy = 0.0, 1.0, 0.0
        trace, det = hxx + hyy, hxx * hyy - hxy * hxy
        if hxx <= 0 or det <= 1e-9 * trace * trace:
            shift = abs(trace) + abs(hxy) + 1e-9
            hxx, hyy = hxx + shift, hyy + shift
            det = hxx * hyy - hxy * hxy
        sx, sy = -(hyy * gx - hxy * gy) / det, -(hxx * gy - hxy * gx) / det
        length = np.sqrt(sx * sx + sy * sy)
        if length > _LONGEST:
            sx, sy, length = sx * _LONGEST / length, sy * _LONGEST / length, _LONGEST
        moved[v] = 0.0
        slope = gx * sx + gy * sy
        if slope >= 0 or length < _SHORTEST:
            continue
        part = 1.0
        for _ in range(12):
            u, w = x + part * sx, y + part * sy
            dx, dy = u - goal[v, 0], w - goal[v, 1]
            there = lam * (axx * dx * dx + 2 * axy * dx * dy + ayy * dy * dy)
            there += _energy(points, cells, neighbours, first, corner, v, u, w, power, values)
            if there <= energy + 1e-4 * part * slope:
                points[v, 0], points[v, 1] = u, w
                moved[v] = part * length
                break
            part *= 0.5


@numba.njit(cache=True)
def _smallest_at(points, cells, neighbours, first, corner, v, x, y, values):  # type: ignore[no-untyped-def]
    """Return the smallest scaled determinant of the corners that a vertex at (x, y) changes."""
    least = np.inf
    for e in range(first[v], first[v + 1]):
        for own in range(3):
            _corner(points, cells, neighbours, corner[e] >> 2, corner[e] & 3, own, x, y, values)
            least = min(least, values[7])
    return least


@numba.njit(cache=True)
def move_if_valid(points, cells, neighbours, first, corner, order, places, least, done):  # type: ignore[no-untyped-def]
    """Move vertices to given places where the scaled determinants around stay large enough.

    A place is taken in full or not at all.  A vertex whose determinants are too small already may
    move if they do not become smaller still.

    Parameters
    ----------
    points
        Coordinates in cells, shape (n, 2), which change in place.
    cells, neighbours
        Quads, shape (m, 4), and `tusqh.meshes.jacobians.QUAD_NEIGHBOURS`.
    first, corner
        For each vertex its corners as ``4 * quad + local corner``: where they begin in the list,
        shape (n + 1,), and the list.
    order
        The vertices to move, in this order.
    places
        Where each vertex should be, shape (n, 2).
    least
        Smallest scaled determinant that may result.
    done
        Receives whether each vertex moved, shape (n,).
    """
    values = np.empty(8)
    for v in order:
        x, y = places[v, 0], places[v, 1]
        before = _smallest_at(
            points, cells, neighbours, first, corner, v, points[v, 0], points[v, 1], values
        )
        after = _smallest_at(points, cells, neighbours, first, corner, v, x, y, values)
        done[v] = after > 0 and after >= min(least, before)
        if done[v]:
            points[v, 0], points[v, 1] = x, y
