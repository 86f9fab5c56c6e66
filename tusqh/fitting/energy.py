r"""Move the vertices of hexes one by one towards less distortion and nearer to their planes.

The energy of a vertex adds up the tetrahedra at the corners of its hexes that contain it.  With
edges ``a, b, c`` and ``d = det(a b c)`` in units of cells::

    f^p + BARRIER / chi(d),   f = (|a|^2 + |b|^2 + |c|^2) / (3 chi(d)^(2/3)),
    chi(d) = (d + sqrt(d^2 + eps^2)) / 2

This is the regularised mean ratio of foldover-free maps (Garanzha et al., 2021); ``eps`` is 0 once
all determinants around the vertex are positive.  The second term keeps hexes from shrinking.  The
fit term is ``lam (x - q)^T A (x - q)``.  ``d`` is affine in the one vertex, so a Newton step with
halving is cheap and safe: a step that makes a positive determinant zero or negative is refused.

In the polish the energy is the sum of ``max(0, wish - s)^2`` with the scaled Jacobians ``s``
instead; a step that lowers the smallest one of the vertex is refused.

Vertices of one colour share no hex, so they move at the same time and the result does not depend
on the number of threads.
"""

from __future__ import annotations

import math

import numba
import numpy as np

#: Weight of the term that keeps hexes from shrinking to a point.
BARRIER = 0.02
#: Weight of the barrier in the polish.
_POLISH_BARRIER = 2e-4
#: Determinants at or below this count as not positive, in cells**3.
_LEAST = 1e-6
#: Around a vertex with a determinant below this, the energy is regularised.
_TANGLED = 0.003
#: Number of halvings of a step.
_HALVINGS = 10


@numba.njit(cache=True)
def _energy(points, cells, neighbours, entries, v, at, eps, power, wish):  # type: ignore[no-untyped-def]
    """Return the energy of a vertex, the least determinant and the least scaled Jacobian."""
    x, y, z = at
    total, least, least_scaled = 0.0, 1e300, 1e300
    for e in entries:
        cell, corner = e >> 3, e & 7
        for w in range(4):
            o = corner if w == 0 else neighbours[corner, w - 1]
            i, j, k = cells[cell, o], cells[cell, neighbours[o, 0]], cells[cell, neighbours[o, 1]]
            m = cells[cell, neighbours[o, 2]]
            ox, oy, oz = points[i, 0], points[i, 1], points[i, 2]
            ax, ay, az = points[j, 0], points[j, 1], points[j, 2]
            bx, by, bz = points[k, 0], points[k, 1], points[k, 2]
            cx, cy, cz = points[m, 0], points[m, 1], points[m, 2]
            if i == v:
                ox, oy, oz = x, y, z
            elif j == v:
                ax, ay, az = x, y, z
            elif k == v:
                bx, by, bz = x, y, z
            else:
                cx, cy, cz = x, y, z
            ax, ay, az = ax - ox, ay - oy, az - oz
            bx, by, bz = bx - ox, by - oy, bz - oz
            cx, cy, cz = cx - ox, cy - oy, cz - oz
            d = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
            aa, bb = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz
            cc = cx * cx + cy * cy + cz * cz
            scaled = d / math.sqrt(aa * bb * cc + 1e-300)
            least, least_scaled = min(least, d), min(least_scaled, scaled)
            if eps == 0.0 and d <= 0.0:
                return 1e300, d, -1.0
            if wish > 0.0:
                total += _POLISH_BARRIER / d
                if scaled < wish:
                    total += (wish - scaled) ** 2
                continue
            chi = d if eps == 0.0 else max(0.5 * (d + math.sqrt(d * d + eps * eps)), 1e-12)
            f = (aa + bb + cc) / (3.0 * np.cbrt(chi) ** 2)
            total += (f if power == 1 else f * f) + BARRIER / chi
    return total, least, least_scaled


@numba.njit(cache=True)
def _derivatives(points, cells, neighbours, entries, v, eps, power, wish):  # type: ignore[no-untyped-def]
    """Return the gradient and the Hessian (xx, yy, zz, xy, xz, yz) of the energy of a vertex.

    The Hessian of the polish is that of Gauss and Newton.
    """
    g0, g1, g2 = 0.0, 0.0, 0.0
    h0, h1, h2, h3, h4, h5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for e in entries:
        cell, corner = e >> 3, e & 7
        for w in range(4):
            o = corner if w == 0 else neighbours[corner, w - 1]
            i, j, k = cells[cell, o], cells[cell, neighbours[o, 0]], cells[cell, neighbours[o, 1]]
            m = cells[cell, neighbours[o, 2]]
            if w > 0:  # The moving vertex comes first; a rotation keeps the determinant.
                if k == v:
                    j, k, m = k, m, j
                elif m == v:
                    j, k, m = m, j, k
            ox, oy, oz = points[i, 0], points[i, 1], points[i, 2]
            ax, ay, az = points[j, 0] - ox, points[j, 1] - oy, points[j, 2] - oz
            bx, by, bz = points[k, 0] - ox, points[k, 1] - oy, points[k, 2] - oz
            cx, cy, cz = points[m, 0] - ox, points[m, 1] - oy, points[m, 2] - oz
            ux, uy, uz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
            d = ax * ux + ay * uy + az * uz
            aa, bb = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz
            cc = cx * cx + cy * cy + cz * cz
            square = aa + bb + cc
            # Derivatives of d, of the sum of squares and of the logarithm of the lengths.
            if w == 0:
                ux += (cy * az - cz * ay) + (ay * bz - az * by)
                uy += (cz * ax - cx * az) + (az * bx - ax * bz)
                uz += (cx * ay - cy * ax) + (ax * by - ay * bx)
                ux, uy, uz = -ux, -uy, -uz
                qx, qy, qz = -2 * (ax + bx + cx), -2 * (ay + by + cy), -2 * (az + bz + cz)
                twice = 6.0
            else:
                qx, qy, qz, twice = 2 * ax, 2 * ay, 2 * az, 2.0
            if wish > 0.0:
                first, second = -_POLISH_BARRIER / (d * d), 2 * _POLISH_BARRIER / (d * d * d)
                inverse = 1.0 / math.sqrt(aa * bb * cc + 1e-300)
                scaled = d * inverse
                gap = wish - scaled
                if gap > 0.0:
                    if w == 0:
                        lx, ly, lz = (
                            -(ax / aa + bx / bb + cx / cc),
                            -(ay / aa + by / bb + cy / cc),
                            -(az / aa + bz / bb + cz / cc),
                        )
                    else:
                        lx, ly, lz = ax / aa, ay / aa, az / aa
                    sx, sy, sz = (
                        ux * inverse - scaled * lx,
                        uy * inverse - scaled * ly,
                        uz * inverse - scaled * lz,
                    )
                    g0, g1, g2 = g0 - 2 * gap * sx, g1 - 2 * gap * sy, g2 - 2 * gap * sz
                    h0, h1, h2 = h0 + 2 * sx * sx, h1 + 2 * sy * sy, h2 + 2 * sz * sz
                    h3, h4, h5 = h3 + 2 * sx * sy, h4 + 2 * sx * sz, h5 + 2 * sy * sz
            else:
                chi, slope, bend = d, 1.0, 0.0
                if eps > 0.0:
                    root = math.sqrt(d * d + eps * eps)
                    chi = max(0.5 * (d + root), 1e-12)
                    slope, bend = chi / root, 0.5 * eps * eps / (root * root * root)
                scale = 1.0 / (3.0 * np.cbrt(chi) ** 2)
                f = square * scale
                by_d = -(2.0 / 3.0) * scale * slope / chi
                by_dd = scale * square * (10.0 / 9.0 * (slope / chi) ** 2 - 2.0 / 3.0 * bend / chi)
                fx, fy, fz = (
                    scale * qx + square * by_d * ux,
                    scale * qy + square * by_d * uy,
                    scale * qz + square * by_d * uz,
                )
                outer = 1.0 if power == 1 else 2 * f
                again = 0.0 if power == 1 else 2.0
                first = -BARRIER * slope / (chi * chi)
                second = BARRIER * (2 * slope * slope / chi - bend) / (chi * chi)
                g0, g1, g2 = g0 + outer * fx, g1 + outer * fy, g2 + outer * fz
                h0 += outer * (scale * twice + 2 * by_d * qx * ux + by_dd * ux * ux)
                h1 += outer * (scale * twice + 2 * by_d * qy * uy + by_dd * uy * uy)
                h2 += outer * (scale * twice + 2 * by_d * qz * uz + by_dd * uz * uz)
                h3 += outer * (by_d * (qx * uy + ux * qy) + by_dd * ux * uy)
                h4 += outer * (by_d * (qx * uz + ux * qz) + by_dd * ux * uz)
                h5 += outer * (by_d * (qy * uz + uy * qz) + by_dd * uy * uz)
                h0, h1, h2 = h0 + again * fx * fx, h1 + again * fy * fy, h2 + again * fz * fz
                h3, h4, h5 = h3 + again * fx * fy, h4 + again * fx * fz, h5 + again * fy * fz
            g0, g1, g2 = g0 + first * ux, g1 + first * uy, g2 + first * uz
            h0, h1, h2 = h0 + second * ux * ux, h1 + second * uy * uy, h2 + second * uz * uz
            h3, h4, h5 = h3 + second * ux * uy, h4 + second * ux * uz, h5 + second * uy * uz
    return (g0, g1, g2), (h0, h1, h2, h3, h4, h5)


@numba.njit(cache=True)
def _newton(g, h):  # type: ignore[no-untyped-def]
    """Return the step of Newton, with a shift that makes the Hessian positive definite."""
    trace = abs(h[0]) + abs(h[1]) + abs(h[2])
    shift = 1e-9 * trace + 1e-12
    for _ in range(12):
        a = h[0] + shift
        if a > 0:
            p, q = h[3] / a, h[4] / a
            b = h[1] + shift - p * h[3]
            if b > 1e-12 * trace:
                m = h[5] - q * h[3]
                r = m / b
                c = h[2] + shift - q * h[4] - r * m
                if c > 1e-12 * trace:
                    y0 = -g[0]
                    y1 = -g[1] - p * y0
                    y2 = -g[2] - q * y0 - r * y1
                    s2 = y2 / c
                    s1 = y1 / b - r * s2
                    return y0 / a - p * s1 - q * s2, s1, s2
        shift = max(10 * shift, 1e-3 * trace + 1e-9)
    length = math.sqrt(g[0] ** 2 + g[1] ** 2 + g[2] ** 2) + 1e-300
    return -0.1 * g[0] / length, -0.1 * g[1] / length, -0.1 * g[2] / length


@numba.njit(cache=True)
def _misfit(plane, q, x, y, z):  # type: ignore[no-untyped-def]
    dx, dy, dz = x - q[0], y - q[1], z - q[2]
    return (
        plane[0] * dx * dx
        + plane[1] * dy * dy
        + plane[2] * dz * dz
        + 2 * (plane[3] * dx * dy + plane[4] * dx * dz + plane[5] * dy * dz)
    )


@numba.njit(cache=True)
def _move(points, cells, neighbours, entries, v, free, fit, lam, q, rule):  # type: ignore[no-untyped-def]
    """Move one vertex by one Newton step; return how far it moved."""
    power, wish, longest, is_wild = rule
    x, y, z = points[v, 0], points[v, 1], points[v, 2]
    eps = 0.0
    energy, least, least_scaled = _energy(
        points, cells, neighbours, entries, v, (x, y, z), 1.0, power, 0.0
    )
    is_tangled = least <= _TANGLED
    if is_tangled:
        wish = 0.0
        eps = (0.02 + 0.5 * max(0.0, -least)) if is_wild else (0.002 + 0.2 * max(0.0, -least))
    elif wish > 0.0 and least_scaled >= wish:
        return 0.0
    energy = _energy(points, cells, neighbours, entries, v, (x, y, z), eps, power, wish)[0]
    g, h = _derivatives(points, cells, neighbours, entries, v, eps, power, wish)
    g0, g1, g2 = g
    h0, h1, h2, h3, h4, h5 = h
    if lam > 0.0:
        energy += lam * _misfit(fit, q, x, y, z)
        dx, dy, dz = x - q[0], y - q[1], z - q[2]
        g0 += 2 * lam * (fit[0] * dx + fit[3] * dy + fit[4] * dz)
        g1 += 2 * lam * (fit[3] * dx + fit[1] * dy + fit[5] * dz)
        g2 += 2 * lam * (fit[4] * dx + fit[5] * dy + fit[2] * dz)
        h0, h1, h2 = h0 + 2 * lam * fit[0], h1 + 2 * lam * fit[1], h2 + 2 * lam * fit[2]
        h3, h4, h5 = h3 + 2 * lam * fit[3], h4 + 2 * lam * fit[4], h5 + 2 * lam * fit[5]
    if wish > 0.0:
        h0, h1, h2 = h0 + 1e-2, h1 + 1e-2, h2 + 1e-2
    if not free & 1:
        g0, h0, h3, h4 = 0.0, 1.0, 0.0, 0.0
    if not free & 2:
        g1, h1, h3, h5 = 0.0, 1.0, 0.0, 0.0
    if not free & 4:
        g2, h2, h4, h5 = 0.0, 1.0, 0.0, 0.0
    s0, s1, s2 = _newton((g0, g1, g2), (h0, h1, h2, h3, h4, h5))
    length = math.sqrt(s0 * s0 + s1 * s1 + s2 * s2)
    if length > longest:
        share = longest / length
        s0, s1, s2, length = s0 * share, s1 * share, s2 * share, longest
    descent = g0 * s0 + g1 * s1 + g2 * s2
    if not descent < 0.0:
        return 0.0
    share = 1.0
    for _ in range(_HALVINGS):
        to = (x + share * s0, y + share * s1, z + share * s2)
        new, new_least, new_scaled = _energy(
            points, cells, neighbours, entries, v, to, eps, power, wish
        )
        if lam > 0.0 and new < 1e299:
            new += lam * _misfit(fit, q, to[0], to[1], to[2])
        is_better = new <= energy + 1e-4 * share * descent
        is_better = is_better and (new_least > _LEAST or least <= _LEAST)
        if wish > 0.0:
            is_better = is_better and new_scaled >= least_scaled - 1e-12
        if is_better:
            if free & 1:
                points[v, 0] = to[0]
            if free & 2:
                points[v, 1] = to[1]
            if free & 4:
                points[v, 2] = to[2]
            return share * length
        share *= 0.5
    return 0.0


@numba.njit(cache=True)
def _visit(points, cells, neighbours, entries, v, free, fit, lam, q, rule, moved, still):  # type: ignore[no-untyped-def]
    """Move a vertex if anything around it still moves."""
    largest = 0.0
    for e in entries:
        for k in range(8):
            largest = max(largest, moved[cells[e >> 3, k]])
    if largest < still or free == 0:
        moved[v] = 0.0
    else:
        moved[v] = _move(points, cells, neighbours, entries, v, free, fit, lam, q, rule)


@numba.njit(cache=True, parallel=True)
def sweep(  # type: ignore[no-untyped-def]
    points,
    cells,
    neighbours,
    start,
    entries,
    order,
    bounds,
    free,
    fits,
    lams,
    qs,
    rule,
    moved,
    still,
):
    """Move every vertex once, one colour after the other.

    Parameters
    ----------
    points
        Coordinates in cells, shape (n, 3); changed in place.
    cells
        Corners of the hexes, shape (m, 8).
    neighbours
        The neighbours of every corner of a hex, shape (8, 3).
    start, entries
        ``entries[start[v]:start[v + 1]]`` are ``8 * hex + corner`` of vertex v.
    order, bounds
        ``order[bounds[c]:bounds[c + 1]]`` are the vertices of colour c.
    free
        Bit k: the vertex may move along axis k, shape (n,).
    fits, lams, qs
        The matrix A (xx, yy, zz, xy, xz, yz), the weight and the place of the fit term of every
        vertex, shapes (n, 6), (n,) and (n, 3).
    rule
        Power of the distortion (1 or 2), wish for the scaled Jacobian (0: no polish), the longest
        step, and whether tangled hexes are strongly regularised.
    moved
        How far every vertex moved in its last step, shape (n,); changed in place.
    still
        Vertices with nothing around them that moved this far are left out.
    """
    for colour in range(len(bounds) - 1):
        for i in numba.prange(bounds[colour], bounds[colour + 1]):
            v = order[i]
            around = entries[start[v] : start[v + 1]]
            _visit(
                points,
                cells,
                neighbours,
                around,
                v,
                free[v],
                fits[v],
                lams[v],
                qs[v],
                rule,
                moved,
                still,
            )
