"""The winding number of the cap, averaged over half-blocks of samples.

The cap's winding number is a harmonic function away from the cap.  A block of the lattice is
compared with its distance to the cap: far away the function is evaluated at the nodes of a
Chebyshev grid only and interpolated, with weights that already hold the mean over samples; near
the cap the block is halved, down to half-blocks whose samples are evaluated one by one.

Error of the interpolation: inside a ball of ``rho`` block sizes without singularities the
coefficients of a harmonic function fall by a factor of about ``1 / (2 rho)`` per degree, so
`_NODES` = 9 nodes along an axis keep the error below 1e-6 at one block's distance (measured in
`tests/sampling/test_cap.py`).
"""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid import FloatArray, IntArray

#: Half-blocks along the side of the largest block.
_LARGEST = 16
#: Half-blocks along the side of the smallest block that is interpolated: a smaller one would
#: need more nodes than it has samples.
_SMALLEST = 4
#: Chebyshev nodes along each axis of a block.
_NODES = 7
#: Distance to the cap, in sides of the block, from which a block is interpolated.
_FAR = 1.0


def add_cap_means(
    corners: FloatArray,
    multiplicity: IntArray,
    step: FloatArray,
    half: int,
    first: IntArray,
    last: IntArray,
    means: FloatArray,
) -> None:
    """Add the mean winding number of a cap to half-blocks.

    Parameters
    ----------
    corners
        Corners of the cap's triangles relative to the first sample, shape (m, 3, 3).
    multiplicity
        How often each triangle counts, shape (m,).
    step
        Distance of samples along each axis, shape (3,).
    half
        Samples along each side of a half-block.
    first, last
        Along each axis, the samples ``first <= k < last`` count, shape (3,) each.
    means
        Means to add to, one per half-block; changed in place.
    """
    levels = []
    size = _LARGEST
    while size >= _SMALLEST:
        levels.append(_interpolation(size, half))
        size //= 2
    sizes = np.array([_LARGEST >> k for k in range(len(levels))], dtype=np.int64)
    nodes = (1 - np.cos(np.pi * (2 * np.arange(_NODES) + 1) / (2 * _NODES))) / 2
    weights = np.zeros((len(levels), _LARGEST, _NODES))
    for k, level in enumerate(levels):
        weights[k, : len(level)] = level
    places = [np.arange(0, n, _LARGEST) for n in means.shape]
    roots = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1).reshape(-1, 3)
    is_whole = bool((first == 0).all() and (last == np.array(means.shape) * half).all())
    _add(
        corners,
        multiplicity,
        step,
        half,
        first,
        last,
        means,
        roots,
        sizes,
        nodes,
        weights,
        is_whole,
    )


def _interpolation(size: int, half: int) -> FloatArray:
    """Return weights, shape (size, `_NODES`), from values at nodes to means over half-blocks."""
    nodes = -np.cos(np.pi * (2 * np.arange(_NODES) + 1) / (2 * _NODES))
    samples = 2 * (np.arange(size * half) + 0.5) / (size * half) - 1
    to_coefficients = np.linalg.inv(np.polynomial.chebyshev.chebvander(nodes, _NODES - 1))
    at_samples = np.polynomial.chebyshev.chebvander(samples, _NODES - 1) @ to_coefficients
    return np.asarray(at_samples.reshape(size, half, _NODES).mean(axis=1))


@numba.njit(cache=True)
def _wind(corners, multiplicity, x, y, z):  # type: ignore[no-untyped-def]
    """Return the winding number at a point (van Oosterom and Strackee, 1983)."""
    total = 0.0
    for t in range(len(corners)):
        a_x, a_y, a_z = corners[t, 0, 0] - x, corners[t, 0, 1] - y, corners[t, 0, 2] - z
        b_x, b_y, b_z = corners[t, 1, 0] - x, corners[t, 1, 1] - y, corners[t, 1, 2] - z
        c_x, c_y, c_z = corners[t, 2, 0] - x, corners[t, 2, 1] - y, corners[t, 2, 2] - z
        a = np.sqrt(a_x * a_x + a_y * a_y + a_z * a_z)
        b = np.sqrt(b_x * b_x + b_y * b_y + b_z * b_z)
        c = np.sqrt(c_x * c_x + c_y * c_y + c_z * c_z)
        volume = (
            a_x * (b_y * c_z - b_z * c_y)
            + a_y * (b_z * c_x - b_x * c_z)
            + a_z * (b_x * c_y - b_y * c_x)
        )
        rest = (
            a * b * c
            + (a_x * b_x + a_y * b_y + a_z * b_z) * c
            + (b_x * c_x + b_y * c_y + b_z * c_z) * a
            + (c_x * a_x + c_y * a_y + c_z * a_z) * b
        )
        total += multiplicity[t] * np.arctan2(volume, rest)
    return total / (2 * np.pi)


@numba.njit(cache=True)
def _distance_to_triangle(p, a, b, c):  # type: ignore[no-untyped-def]
    """Return the distance of a point to a triangle (Ericson, Real-Time Collision Detection)."""
    ab, ac, ap = b - a, c - a, p - a
    d1, d2 = (ab * ap).sum(), (ac * ap).sum()
    if d1 <= 0 and d2 <= 0:
        return np.sqrt((ap * ap).sum())
    bp = p - b
    d3, d4 = (ab * bp).sum(), (ac * bp).sum()
    if d3 >= 0 and d4 <= d3:
        return np.sqrt((bp * bp).sum())
    vc = d1 * d4 - d3 * d2
    if vc <= 0 and d1 >= 0 and d3 <= 0 and d1 != d3:
        q = a + d1 / (d1 - d3) * ab - p
        return np.sqrt((q * q).sum())
    cp = p - c
    d5, d6 = (ab * cp).sum(), (ac * cp).sum()
    if d6 >= 0 and d5 <= d6:
        return np.sqrt((cp * cp).sum())
    vb = d5 * d2 - d1 * d6
    if vb <= 0 and d2 >= 0 and d6 <= 0 and d2 != d6:
        q = a + d2 / (d2 - d6) * ac - p
        return np.sqrt((q * q).sum())
    va = d3 * d6 - d5 * d4
    if va <= 0 and d4 - d3 >= 0 and d5 - d6 >= 0 and (d4 - d3) + (d5 - d6) > 0:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        q = b + w * (c - b) - p
        return np.sqrt((q * q).sum())
    total = va + vb + vc
    if total == 0.0:
        return 0.0
    q = a + vb / total * ab + vc / total * ac - p
    return np.sqrt((q * q).sum())


@numba.njit(cache=True, parallel=True)
def _add(  # type: ignore[no-untyped-def]
    corners, multiplicity, step, half, first, last, means, roots, sizes, nodes, weights, is_whole
):
    shape = np.array(means.shape)
    leaf = sizes[-1] // 2
    for r in numba.prange(len(roots)):
        # Blocks that are still to be done: level and lowest half-block.
        stack = np.empty((8 * (len(sizes) + 1), 4), dtype=np.int64)
        stack[0, 0] = 0
        stack[0, 1:] = roots[r]
        n = 1
        while n > 0:
            n -= 1
            level = stack[n, 0]
            i0, j0, k0 = stack[n, 1], stack[n, 2], stack[n, 3]
            if i0 >= shape[0] or j0 >= shape[1] or k0 >= shape[2]:
                continue
            if level == len(sizes):
                for i in range(i0, min(i0 + leaf, shape[0])):
                    for j in range(j0, min(j0 + leaf, shape[1])):
                        for k in range(k0, min(k0 + leaf, shape[2])):
                            _add_samples(
                                corners, multiplicity, step, half, first, last, means, i, j, k
                            )
                continue
            size = sizes[level]
            side = size * half * step  # Samples fill it from half a step before the first one.
            corner = (np.array([i0, j0, k0]) * half - 0.5) * step
            centre = corner + side / 2
            radius = np.sqrt((side * side).sum()) / 2
            nearest = np.inf
            for t in range(len(corners)):
                d = _distance_to_triangle(centre, corners[t, 0], corners[t, 1], corners[t, 2])
                nearest = min(nearest, d)
            if is_whole and nearest - radius >= _FAR * side.max():
                _interpolate(
                    corners,
                    multiplicity,
                    corner,
                    side,
                    nodes,
                    weights[level],
                    size,
                    means,
                    i0,
                    j0,
                    k0,
                )
                continue
            smaller = size // 2
            for child in range(8):
                stack[n, 0] = level + 1
                stack[n, 1] = i0 + smaller * (child & 1)
                stack[n, 2] = j0 + smaller * (child >> 1 & 1)
                stack[n, 3] = k0 + smaller * (child >> 2)
                n += 1


@numba.njit(cache=True)
def _interpolate(  # type: ignore[no-untyped-def]
    corners, multiplicity, corner, side, nodes, weights, size, means, i0, j0, k0
):
    n = len(nodes)
    at_nodes = np.empty((n, n, n))
    for a in range(n):
        for b in range(n):
            for c in range(n):
                at_nodes[a, b, c] = _wind(
                    corners,
                    multiplicity,
                    corner[0] + nodes[a] * side[0],
                    corner[1] + nodes[b] * side[1],
                    corner[2] + nodes[c] * side[2],
                )
    along_z = np.zeros((n, n, size))
    for a in range(n):
        for b in range(n):
            for k in range(size):
                for c in range(n):
                    along_z[a, b, k] += weights[k, c] * at_nodes[a, b, c]
    along_y = np.zeros((n, size, size))
    for a in range(n):
        for j in range(size):
            for b in range(n):
                for k in range(size):
                    along_y[a, j, k] += weights[j, b] * along_z[a, b, k]
    for i in range(min(size, means.shape[0] - i0)):
        for a in range(n):
            for j in range(min(size, means.shape[1] - j0)):
                for k in range(min(size, means.shape[2] - k0)):
                    means[i0 + i, j0 + j, k0 + k] += weights[i, a] * along_y[a, j, k]


@numba.njit(cache=True)
def _add_samples(  # type: ignore[no-untyped-def]
    corners, multiplicity, step, half, first, last, means, i0, j0, k0
):
    total = 0.0
    for i in range(max(i0 * half, first[0]), min((i0 + 1) * half, last[0])):
        for j in range(max(j0 * half, first[1]), min((j0 + 1) * half, last[1])):
            for k in range(max(k0 * half, first[2]), min((k0 + 1) * half, last[2])):
                total += _wind(corners, multiplicity, i * step[0], j * step[1], k * step[2])
    means[i0, j0, k0] += total / half**3
