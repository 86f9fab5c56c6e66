r"""Move the vertices of hexes one by one towards less distortion and nearer to their planes.

The energy of a vertex adds up the tetrahedra at the corners of its hexes that contain it.  With
edges ``a, b, c`` and ``d = det(a b c)`` in units of cells::

    f^p + BARRIER / chi(d),   f = (|a|^2 + |b|^2 + |c|^2) / (3 chi(d)^(2/3)),
    chi(d) = (d + sqrt(d^2 + eps^2)) / 2

This is the regularised mean ratio of foldover-free maps (Garanzha et al., 2021); ``eps`` is 0 once
all determinants around the vertex are positive.  The second term keeps hexes from shrinking.  The
fit term is ``lam (x - q)^T A (x - q)``.  ``d`` is affine in the one vertex, so a Newton step with
halving is cheap and safe: a step that makes a positive determinant zero or negative is refused.

In the polish the energy is the sum of ``max(0, wish - s)^4`` with the scaled Jacobians ``s``
instead.  The fourth power cares most for the worst hexes; refusing every step that lowers the
smallest one instead would stop where two hexes are equally bad.

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
#: Weight of the fourth powers in the polish, which equal squares where 0.2 is lacking.
_STEEP = 25.0


@numba.njit(cache=True)
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@numba.njit(cache=True)
def _cross(a, b):  # type: ignore[no-untyped-def]
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@numba.njit(cache=True)
def _plus(a, s, b):  # type: ignore[no-untyped-def]
    """Return ``a + s b``."""
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


@numba.njit(cache=True)
def _add_pair(h, s, p, q):  # type: ignore[no-untyped-def]
    """Return a Hessian plus ``s (p q^T + q p^T) / 2``."""
    return (
        h[0] + s * p[0] * q[0],
        h[1] + s * p[1] * q[1],
        h[2] + s * p[2] * q[2],
        h[3] + 0.5 * s * (p[0] * q[1] + p[1] * q[0]),
        h[4] + 0.5 * s * (p[0] * q[2] + p[2] * q[0]),
        h[5] + 0.5 * s * (p[1] * q[2] + p[2] * q[1]),
    )


@numba.njit(cache=True)
def _edges(points, cells, neighbours, cell, o, v, at):  # type: ignore[no-untyped-def]
    """Return the edges at a corner with vertex v at a place; one that ends there comes first."""
    i, j, k = cells[cell, o], cells[cell, neighbours[o, 0]], cells[cell, neighbours[o, 1]]
    m = cells[cell, neighbours[o, 2]]
    if k == v:
        j, k, m = k, m, j
    elif m == v:
        j, k, m = m, j, k
    p = at if i == v else (points[i, 0], points[i, 1], points[i, 2])
    q = at if j == v else (points[j, 0], points[j, 1], points[j, 2])
    return (
        (q[0] - p[0], q[1] - p[1], q[2] - p[2]),
        (points[k, 0] - p[0], points[k, 1] - p[1], points[k, 2] - p[2]),
        (points[m, 0] - p[0], points[m, 1] - p[1], points[m, 2] - p[2]),
    )


@numba.njit(cache=True)
def _energy(points, cells, neighbours, entries, v, at, eps, power, wish):  # type: ignore[no-untyped-def]
    """Return the energy of a vertex, the least determinant and the least scaled Jacobian."""
    total, least, least_scaled = 0.0, 1e300, 1e300
    for e in entries:
        cell, corner = e >> 3, e & 7
        for w in range(4):
            o = corner if w == 0 else neighbours[corner, w - 1]
            a, b, c = _edges(points, cells, neighbours, cell, o, v, at)
            d = _dot(a, _cross(b, c))
            aa, bb, cc = _dot(a, a), _dot(b, b), _dot(c, c)
            scaled = d / math.sqrt(aa * bb * cc + 1e-300)
            least, least_scaled = min(least, d), min(least_scaled, scaled)
            if eps == 0.0 and d <= 0.0:
                return 1e300, d, -1.0
            if wish > 0.0:
                total += _POLISH_BARRIER / d + _STEEP * max(0.0, wish - scaled) ** 4
                continue
            chi = d if eps == 0.0 else max(0.5 * (d + math.sqrt(d * d + eps * eps)), 1e-12)
            f = (aa + bb + cc) / (3.0 * np.cbrt(chi) ** 2)
            total += (f if power == 1 else f * f) + BARRIER / chi
    return total, least, least_scaled


@numba.njit(cache=True)
def _add_ratio(g, h, d, square, q, twice, u, eps, power):  # type: ignore[no-untyped-def]
    """Add the derivatives of the energy of a corner; `q`, `twice`: of the squares, `u`: of d."""
    chi, slope, bend = d, 1.0, 0.0
    if eps > 0.0:
        root = math.sqrt(d * d + eps * eps)
        chi = max(0.5 * (d + root), 1e-12)
        slope, bend = chi / root, 0.5 * eps * eps / (root * root * root)
    scale = 1.0 / (3.0 * np.cbrt(chi) ** 2)
    f = square * scale
    by_d = -(2.0 / 3.0) * scale * slope / chi
    by_dd = scale * square * (10.0 / 9.0 * (slope / chi) ** 2 - 2.0 / 3.0 * bend / chi)
    outer = 1.0 if power == 1 else 2 * f
    slope_of_f = _plus((scale * q[0], scale * q[1], scale * q[2]), square * by_d, u)
    first = -BARRIER * slope / (chi * chi)
    second = BARRIER * (2 * slope * slope / chi - bend) / (chi * chi)
    g = _plus(_plus(g, outer, slope_of_f), first, u)
    flat = outer * scale * twice
    h = (h[0] + flat, h[1] + flat, h[2] + flat, h[3], h[4], h[5])
    h = _add_pair(h, 2 * outer * by_d, q, u)
    h = _add_pair(h, outer * by_dd + second, u, u)
    if power == 2:
        h = _add_pair(h, 2.0, slope_of_f, slope_of_f)
    return g, h


@numba.njit(cache=True)
def _add_polish(g, h, d, lengths, along, u, wish):  # type: ignore[no-untyped-def]
    """Add the derivatives of ``max(0, wish - s)^4`` and its barrier (Gauss and Newton's Hessian).

    `lengths` is the product of the lengths of the edges, and `along` the derivative of its
    logarithm.
    """
    g = _plus(g, -_POLISH_BARRIER / (d * d), u)
    h = _add_pair(h, 2 * _POLISH_BARRIER / (d * d * d), u, u)
    scaled = d / lengths
    if scaled < wish:
        slope = _plus((u[0] / lengths, u[1] / lengths, u[2] / lengths), -scaled, along)
        lack = wish - scaled
        g = _plus(g, -4 * _STEEP * lack**3, slope)
        h = _add_pair(h, 12 * _STEEP * lack**2, slope, slope)
    return g, h


@numba.njit(cache=True)
def _derivatives(points, cells, neighbours, entries, v, at, eps, power, wish):  # type: ignore[no-untyped-def]
    """Return the gradient and the Hessian (xx, yy, zz, xy, xz, yz) of the energy of a vertex."""
    g, h = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for e in entries:
        cell, corner = e >> 3, e & 7
        for w in range(4):
            o = corner if w == 0 else neighbours[corner, w - 1]
            a, b, c = _edges(points, cells, neighbours, cell, o, v, at)
            u = _cross(b, c)
            d = _dot(a, u)
            aa, bb, cc = _dot(a, a), _dot(b, b), _dot(c, c)
            if w == 0:
                u = _plus(_plus(u, 1.0, _cross(c, a)), 1.0, _cross(a, b))
                u = (-u[0], -u[1], -u[2])
            if wish > 0.0:
                along = (a[0] / aa, a[1] / aa, a[2] / aa)
                if w == 0:
                    along = _plus(_plus(along, 1 / bb, b), 1 / cc, c)
                    along = (-along[0], -along[1], -along[2])
                lengths = math.sqrt(aa * bb * cc + 1e-300)
                g, h = _add_polish(g, h, d, lengths, along, u, wish)
            else:
                q, twice = (2 * a[0], 2 * a[1], 2 * a[2]), 2.0
                if w == 0:
                    q = _plus(_plus(q, 2.0, b), 2.0, c)
                    q, twice = (-q[0], -q[1], -q[2]), 6.0
                g, h = _add_ratio(g, h, d, aa + bb + cc, q, twice, u, eps, power)
    return g, h


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
def _misfit(fit, q, at):  # type: ignore[no-untyped-def]
    """Return ``(x - q)^T A (x - q)`` and half its gradient."""
    d = _plus(at, -1.0, q)
    pull = (
        fit[0] * d[0] + fit[3] * d[1] + fit[4] * d[2],
        fit[3] * d[0] + fit[1] * d[1] + fit[5] * d[2],
        fit[4] * d[0] + fit[5] * d[1] + fit[2] * d[2],
    )
    return _dot(d, pull), pull


@numba.njit(cache=True)
def _find_step(g, h, fit, lam, pull, free, longest, wish):  # type: ignore[no-untyped-def]
    """Return the step of Newton with the fit term, along free axes, and the descent along it."""
    g = _plus(g, 2 * lam, pull)
    g0, g1, g2 = g
    h0, h1, h2 = h[0] + 2 * lam * fit[0], h[1] + 2 * lam * fit[1], h[2] + 2 * lam * fit[2]
    h3, h4, h5 = h[3] + 2 * lam * fit[3], h[4] + 2 * lam * fit[4], h[5] + 2 * lam * fit[5]
    if wish > 0.0:
        h0, h1, h2 = h0 + 1e-2, h1 + 1e-2, h2 + 1e-2
    if not free & 1:
        g0, h0, h3, h4 = 0.0, 1.0, 0.0, 0.0
    if not free & 2:
        g1, h1, h3, h5 = 0.0, 1.0, 0.0, 0.0
    if not free & 4:
        g2, h2, h4, h5 = 0.0, 1.0, 0.0, 0.0
    step = _newton((g0, g1, g2), (h0, h1, h2, h3, h4, h5))
    length = math.sqrt(_dot(step, step))
    if length > longest:
        share = longest / length
        step = (share * step[0], share * step[1], share * step[2])
    return step, _dot((g0, g1, g2), step)


@numba.njit(cache=True)
def _move(points, cells, neighbours, entries, v, free, fit, lam, q, rule):  # type: ignore[no-untyped-def]
    """Move one vertex by one Newton step; return how far it moved."""
    power, wish, longest, is_wild = rule
    at = (points[v, 0], points[v, 1], points[v, 2])
    eps = 0.0
    _, least, least_scaled = _energy(points, cells, neighbours, entries, v, at, 1.0, power, 0.0)
    if least <= _TANGLED:
        wish = 0.0
        eps = (0.02 + 0.5 * max(0.0, -least)) if is_wild else (0.002 + 0.2 * max(0.0, -least))
    elif wish > 0.0 and least_scaled >= wish:
        return 0.0
    energy = _energy(points, cells, neighbours, entries, v, at, eps, power, wish)[0]
    g, h = _derivatives(points, cells, neighbours, entries, v, at, eps, power, wish)
    wanted = (q[0], q[1], q[2])
    off, pull = _misfit(fit, wanted, at)
    energy += lam * off
    step, descent = _find_step(g, h, fit, lam, pull, free, longest, wish)
    if not descent < 0.0:
        return 0.0
    share = 1.0
    for _ in range(_HALVINGS):
        to = _plus(at, share, step)
        new, new_least, _ = _energy(points, cells, neighbours, entries, v, to, eps, power, wish)
        new += lam * _misfit(fit, wanted, to)[0]
        is_better = new <= energy + 1e-4 * share * descent
        is_better = is_better and (new_least > _LEAST or least <= _LEAST)
        if is_better:
            for k in range(3):
                if free >> k & 1:
                    points[v, k] = to[k]
            return share * math.sqrt(_dot(step, step))
        share *= 0.5
    return 0.0


@numba.njit(cache=True)
def _visit(hexes, entries, v, terms, rule, moved, still):  # type: ignore[no-untyped-def]
    """Move a vertex if anything around it still moves."""
    points, cells, neighbours = hexes
    free, fit, lam, q = terms
    largest = 0.0
    for e in entries:
        for k in range(8):
            largest = max(largest, moved[cells[e >> 3, k]])
    if largest < still or free == 0:
        moved[v] = 0.0
    else:
        moved[v] = _move(points, cells, neighbours, entries, v, free, fit, lam, q, rule)


@numba.njit(cache=True, parallel=True)
def sweep_hexes(  # type: ignore[no-untyped-def]
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
            terms = free[v], fits[v], lams[v], qs[v]
            _visit((points, cells, neighbours), around, v, terms, rule, moved, still)
