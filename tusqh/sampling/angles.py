"""Exact winding numbers of triangles and segments at many points at once.

The half solid angle of a triangle is the argument of a complex number (van Oosterom and Strackee,
1983); the angle of a segment is the argument of a product of two.  Multiplying the numbers adds
their angles, so one arctangent per point replaces one per point and triangle, in loops that
compilers vectorize.  Whole turns are counted where the product crosses the negative real axis.

All compiled functions that call one another are in this file: numba's cache on disk notices a
changed file, but not a changed callee in another file (`tests/test_structure.py`).
"""

from __future__ import annotations

import numba
import numpy as np

from tusqh.sampling.kernel_arguments import Ball, Points

#: Factors that are multiplied before the product is scaled back: with coordinates of up to 1e6
#: steps of the lattice, no product of this many factors over- or underflows.
_FACTORS = 8
#: Angles up to this are computed from the series of the arctangent.
_SMALL = 0.3
#: Number of terms added in single precision before their sum is added in double precision.
_PARTS = 16
_ONE, _THIRD, _FIFTH, _SEVENTH, _NINTH = (np.float32(1 / k) for k in (1, 3, 5, 7, 9))


@numba.njit(cache=True, error_model="numpy", inline="always")
def _normal_of(corner):  # type: ignore[no-untyped-def]
    """Return the normal of a triangle (length: twice its area) or of a segment (its length)."""
    if corner.shape[0] == 2:
        return corner[1, 2] - corner[0, 2], 0.0, corner[0, 0] - corner[1, 0]
    u_x, v_x = corner[1, 0] - corner[0, 0], corner[2, 0] - corner[0, 0]
    u_y, v_y = corner[1, 1] - corner[0, 1], corner[2, 1] - corner[0, 1]
    u_z, v_z = corner[1, 2] - corner[0, 2], corner[2, 2] - corner[0, 2]
    return u_y * v_z - u_z * v_y, u_z * v_x - u_x * v_z, u_x * v_y - u_y * v_x


@numba.njit(cache=True, error_model="numpy", inline="always")
def _triangle_number(corner, n_x, n_y, n_z, x, y, z):  # type: ignore[no-untyped-def]
    """Return the complex number whose argument is half the solid angle of a triangle at a point.

    Its imaginary part is the distance to the plane of the triangle times the length of the normal.
    """
    a_x, a_y, a_z = corner[0, 0] - x, corner[0, 1] - y, corner[0, 2] - z
    b_x, b_y, b_z = corner[1, 0] - x, corner[1, 1] - y, corner[1, 2] - z
    c_x, c_y, c_z = corner[2, 0] - x, corner[2, 1] - y, corner[2, 2] - z
    a = np.sqrt(a_x * a_x + a_y * a_y + a_z * a_z)
    b = np.sqrt(b_x * b_x + b_y * b_y + b_z * b_z)
    c = np.sqrt(c_x * c_x + c_y * c_y + c_z * c_z)
    real = (
        a * b * c
        + (a_x * b_x + a_y * b_y + a_z * b_z) * c
        + (b_x * c_x + b_y * c_y + b_z * c_z) * a
        + (c_x * a_x + c_y * a_y + c_z * a_z) * b
    )
    return real, n_x * a_x + n_y * a_y + n_z * a_z


@numba.njit(cache=True, error_model="numpy", inline="always")
def _segment_number(corner, n_x, n_z, x, z):  # type: ignore[no-untyped-def]
    """Return the complex number whose argument is the angle of a segment at a point."""
    a_x, a_z = corner[0, 0] - x, corner[0, 2] - z
    b_x, b_z = corner[1, 0] - x, corner[1, 2] - z
    return a_x * b_x + a_z * b_z, n_x * a_x + n_z * a_z


@numba.njit(cache=True, error_model="numpy")
def _wind(points, n, pieces, chosen, work, winding):  # type: ignore[no-untyped-def]
    """Add the winding numbers of chosen pieces at arbitrary points.

    A point on a triangle gets +1/2 from it; at a corner, or in the triangle's plane outside it, the
    contribution is 0.

    Parameters
    ----------
    points
        `Points`; only the first `n` are used.
    n
        Number of points.
    pieces
        `Pieces`.
    chosen
        Indices of the pieces to add.
    work
        Scratch array, shape (5, k) with k at least n.
    winding
        Winding numbers to add to, shape (k,), dimensionless.
    """
    p_x, p_y, p_z = points.x, points.y, points.z
    corners, multiplicity = pieces.corners, pieces.multiplicity
    x, y, turns, real, imaginary = work[0], work[1], work[2], work[3], work[4]
    for k in range(n):
        x[k], y[k], turns[k] = 1.0, 0.0, 0.0
    n_factors = 0
    for t in chosen:
        corner = corners[t]
        n_x, n_y, n_z = _normal_of(corner)
        for k in range(n):
            if corner.shape[0] == 3:
                r, i = _triangle_number(corner, n_x, n_y, n_z, p_x[k], p_y[k], p_z[k])
            else:
                r, i = _segment_number(corner, n_x, n_z, p_x[k], p_z[k])
            real[k] = 1.0 if (i == 0.0) & (r == 0.0) else r
            imaginary[k] = -1e-40 * r if (i == 0.0) & (r < 0.0) else i
        sign = 1.0 if multiplicity[t] > 0 else -1.0
        for _ in range(abs(multiplicity[t])):
            for k in range(n):
                r, i = real[k], sign * imaginary[k]
                new = x[k] * i + y[k] * r + 0.0  # No -0.0: angles lie in (-pi, pi].
                is_over = (y[k] >= 0.0) & (i > 0.0) & (new < 0.0)
                is_under = (y[k] < 0.0) & (i < 0.0) & (new >= 0.0)
                turns[k] += (1.0 if is_over else 0.0) - (1.0 if is_under else 0.0)
                x[k] = x[k] * r - y[k] * i
                y[k] = new
            n_factors += 1
            if n_factors == _FACTORS:
                n_factors = 0
                _scale(x, y, n)
    for k in range(n):
        winding[k] += np.arctan2(y[k], x[k]) / (2 * np.pi) + turns[k]


@numba.njit(cache=True, error_model="numpy", fastmath={"contract"})
def _wind_from_afar(points, ball, pieces, chosen, winding):  # type: ignore[no-untyped-def]
    """Add the winding numbers of far pieces, in single precision if their angles are small.

    Parameters
    ----------
    points
        `Points` in the ball, relative to its centre.
    ball
        A `Ball` from which all chosen pieces are far.
    pieces, chosen
        As in `_wind`.
    winding
        Winding numbers to add to, shape (n,), dimensionless.

    Notes
    -----
    An angle below `_SMALL` is the sum of its series, with a relative error of 3e-7; single
    precision takes a quarter of the time.  Larger angles are left to `_wind`.
    """
    p_x, p_y, p_z = points.x, points.y, points.z
    c_x, c_y, c_z, radius, clearance = ball.x, ball.y, ball.z, ball.radius, ball.clearance
    corners, multiplicity = pieces.corners, pieces.multiplicity
    middle, reach = pieces.middle, pieces.reach
    n = len(p_x)
    x, y, z = p_x.astype(np.float32), p_y.astype(np.float32), p_z.astype(np.float32)
    n_corners = corners.shape[1]
    near = np.empty((n_corners, 3), dtype=np.float32)
    part = np.zeros(n, dtype=np.float32)
    large = np.empty(len(chosen), dtype=np.int64)
    n_parts, n_large = 0, 0
    for c in range(len(chosen)):
        t = chosen[c]
        corner = corners[t]
        d_x, d_y, d_z = middle[t, 0] - c_x, middle[t, 1] - c_y, middle[t, 2] - c_z
        distance = np.sqrt(d_x * d_x + d_y * d_y + d_z * d_z) - reach[t] - radius
        distance = max(distance, clearance)
        m_x, m_y, m_z = _normal_of(corner)
        size = np.sqrt(m_x * m_x + m_y * m_y + m_z * m_z)
        # Upper bound of half the solid angle (triangle) or of the angle (segment).
        largest = size / (4 * distance * distance) if n_corners == 3 else size / distance
        if largest > _SMALL:
            large[n_large] = t
            n_large += 1
            continue
        factor = np.float32(multiplicity[t] / (2 * np.pi))
        n_x, n_y, n_z = np.float32(m_x), np.float32(m_y), np.float32(m_z)
        for k in range(n_corners):
            near[k, 0] = corner[k, 0] - c_x
            near[k, 1] = corner[k, 1] - c_y
            near[k, 2] = corner[k, 2] - c_z
        if n_corners == 3:
            for k in range(n):
                r, i = _triangle_number(near, n_x, n_y, n_z, x[k], y[k], z[k])
                part[k] += factor * _arctangent(i / r)
        else:
            for k in range(n):
                r, i = _segment_number(near, n_x, n_z, x[k], z[k])
                part[k] += factor * _arctangent(i / r)
        n_parts += 1
        if n_parts == _PARTS:
            n_parts = 0
            for k in range(n):
                winding[k] += part[k]
                part[k] = 0.0
    for k in range(n):
        winding[k] += part[k]
    if n_large > 0:
        moved = Points(p_x + c_x, p_y + c_y, p_z + c_z)
        _wind(moved, n, pieces, large[:n_large], np.empty((5, n)), winding)


@numba.njit(cache=True, error_model="numpy", inline="always")
def _arctangent(s):  # type: ignore[no-untyped-def]
    """Return the arctangent of a small single-precision number."""
    q = s * s
    return s * (_ONE - q * (_THIRD - q * (_FIFTH - q * (_SEVENTH - q * _NINTH))))


@numba.njit(cache=True, error_model="numpy")
def _scale(x, y, n):  # type: ignore[no-untyped-def]
    for k in range(n):
        scale = 1.0 / (abs(x[k]) + abs(y[k]))
        x[k] *= scale
        y[k] *= scale


@numba.njit(cache=True, error_model="numpy", parallel=True)
def wind_far(pieces, blocks, nodes, far, rows, is_single, matrix):  # type: ignore[no-untyped-def]
    """Return what follows from the winding numbers of far pieces on the surfaces of some blocks.

    Parameters
    ----------
    pieces
        `Pieces`.
    blocks
        `Blocks`.
    nodes
        `NodeTables`.
    far
        `Lists` of the far pieces of each block.
    rows
        The blocks to evaluate, shape (m,).
    is_single
        Whether single precision suffices.
    matrix
        Maps the winding numbers at the surface nodes to what is wanted, shape (n_surface, k).

    Returns
    -------
    on_surface
        Winding numbers at the surface nodes, shape (m, n_surface), dimensionless.
    mapped
        Their products with the matrix, shape (m, k).
    """
    on_surface = np.zeros((len(rows), len(nodes.surface)))
    mapped = np.zeros((len(rows), matrix.shape[1]))
    for m in numba.prange(len(rows)):
        r = rows[m]
        chosen = far.pieces[far.start[r] : far.start[r + 1]]
        lowest, size = blocks.lowest[r], blocks.size
        _wind_on_surface(pieces, lowest, size, nodes, chosen, is_single, on_surface[m])
        _multiply(on_surface[m], matrix, mapped[m])
    return on_surface, mapped


# The bodies of both loops are compiled on their own: inside `prange` that takes numba much longer.
@numba.njit(cache=True, error_model="numpy")
def _wind_on_surface(pieces, lowest, size, nodes, chosen, is_single, winding):  # type: ignore[no-untyped-def]
    at_x, at_y, at_z = nodes.x, nodes.y, nodes.z
    n_y, n_z = len(at_y), len(at_z)
    n_points = len(nodes.surface)
    radius = 0.5 * size[0] * np.sqrt(3.0 if n_y > 1 else 2.0)
    c_x, c_y, c_z = lowest[0] + 0.5 * size[0], lowest[1] + 0.5 * size[1], lowest[2] + 0.5 * size[2]
    points = np.empty((3, n_points))
    for k in range(n_points):
        node = nodes.surface[k]
        points[0, k] = (at_x[node // (n_y * n_z)] - 0.5) * size[0]
        points[1, k] = (at_y[node // n_z % n_y] - 0.5) * size[1]
        points[2, k] = (at_z[node % n_z] - 0.5) * size[2]
    at = Points(points[0], points[1], points[2])
    if is_single:
        ball = Ball(c_x, c_y, c_z, radius, nodes.distance * size[0] - radius)
        _wind_from_afar(at, ball, pieces, chosen, winding)
    else:
        for k in range(n_points):
            points[0, k] += c_x
            points[1, k] += c_y
            points[2, k] += c_z
        _wind(at, n_points, pieces, chosen, np.empty((5, n_points)), winding)


@numba.njit(cache=True, error_model="numpy")
def _multiply(vector, matrix, product):  # type: ignore[no-untyped-def]
    """Add a vector times a matrix, four rows at a time, because memory is slower than sums."""
    n, m = matrix.shape
    whole = n // 4 * 4
    for k in range(0, whole, 4):
        a, b, c, d = vector[k], vector[k + 1], vector[k + 2], vector[k + 3]
        for i in range(m):
            product[i] += (a * matrix[k, i] + b * matrix[k + 1, i]) + (
                c * matrix[k + 2, i] + d * matrix[k + 3, i]
            )
    for k in range(whole, n):
        for i in range(m):
            product[i] += vector[k] * matrix[k, i]


@numba.njit(cache=True, error_model="numpy", parallel=True)
def add_near(pieces, blocks, side, samples, near, sums):  # type: ignore[no-untyped-def]
    """Add the winding numbers of the near pieces of each block, summed over half-blocks.

    Parameters
    ----------
    pieces
        `Pieces`.
    blocks
        Lowest half-block of each block, shape (n_blocks, 3).
    side
        Number of half-blocks along each side of a block, shape (3,).
    samples
        `Samples`.
    near
        `Lists` of the near pieces of each block.
    sums
        Sums over the samples of each half-block to add to, dimensionless.
    """
    for r in numba.prange(len(blocks)):
        chosen = near.pieces[near.start[r] : near.start[r + 1]]
        if len(chosen):
            _add_near_to_block(pieces, blocks[r], side, samples, chosen, sums)


@numba.njit(cache=True, error_model="numpy")
def _add_near_to_block(pieces, block, side, samples, chosen, sums):  # type: ignore[no-untyped-def]
    begin, half, first, last = samples.begin, samples.half, samples.first, samples.last
    low_x, low_y, low_z = block[0] * half[0], block[1] * half[1], block[2] * half[2]
    size_x, size_y, size_z = side[0] * half[0], side[1] * half[1], side[2] * half[2]
    n_max = size_x * size_y * size_z
    points = np.empty((3, n_max))
    place = np.empty((n_max, 3), dtype=np.int64)
    n = 0
    for i in range(low_x, min(low_x + size_x, sums.shape[0] * half[0])):
        for j in range(low_y, min(low_y + size_y, sums.shape[1] * half[1])):
            for k in range(low_z, min(low_z + size_z, sums.shape[2] * half[2])):
                x = i + begin * half[0]
                is_in = (first[0] <= x) & (x < last[0]) & (first[1] <= j) & (j < last[1])
                if is_in and first[2] <= k < last[2]:
                    points[0, n], points[1, n], points[2, n] = float(x), float(j), float(k)
                    place[n, 0] = i // half[0]
                    place[n, 1] = j // half[1]
                    place[n, 2] = k // half[2]
                    n += 1
    winding = np.zeros(n_max)
    at = Points(points[0], points[1], points[2])
    _wind(at, n, pieces, chosen, np.empty((5, n_max)), winding)
    for k in range(n):
        sums[place[k, 0], place[k, 1], place[k, 2]] += winding[k]
