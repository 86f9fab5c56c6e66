"""Means of the winding number over half-blocks of samples, without touching each sample.

Along a lattice line the winding number of a closed cycle changes only at crossings, so a crossing
adds a run of samples to the half-blocks below it: the whole blocks by a difference array, the
one it ends in by itself (algorithm notes 1).  Chunks of the lattice along x are scanned side by
side; all sums are of integers, so neither chunks nor threads change a bit of the result.
"""

from __future__ import annotations

import numba
import numpy as np

from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.cap import add_cap_means
from tusqh.sampling.crossings import close_soup

#: Parts of the lattice that are scanned side by side.
_CHUNKS = 32


def block_means(
    soup: Soup, axes: list[FloatArray], half: int, first: IntArray, last: IntArray
) -> FloatArray:
    """Return the mean winding number over half-blocks; samples out of a range count 0.

    Parameters
    ----------
    soup
        The triangles, as they are.
    axes
        Evenly spaced sample coordinates along x, y and z, in the units of the soup.
    half
        Samples along each side of a half-block.
    first, last
        Along each axis, the samples ``first <= k < last`` count, shape (3,) each.

    Returns
    -------
    means
        Shape of the lattice over `half`, dimensionless.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]])
    >>> faces = np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]])
    >>> soup = Soup(points, faces, np.zeros(4, dtype=np.int64))
    >>> lattice = [np.array([0.5, 1.5, 2.5, 3.5])] * 3
    >>> all_of_it = np.zeros(3, dtype=np.int64), np.full(3, 4)
    >>> block_means(soup, lattice, 2, *all_of_it)[0, 0].tolist()
    [0.875, 0.125]
    """
    cycle, cap = close_soup(soup)
    origin = np.array([axis[0] for axis in axes])
    step = np.array([axis[1] - axis[0] if len(axis) > 1 else 1.0 for axis in axes])
    corners = cycle.corners - origin
    means = np.empty(tuple(len(axis) // half for axis in axes))
    low, high = corners.min(axis=1), corners.max(axis=1)
    _scan(corners, cycle.multiplicity, low, high, step, half, first, last, means)
    if len(cap.corners):
        add_cap_means(cap.corners - origin, cap.multiplicity, step, half, first, last, means)
    return means


@numba.njit(cache=True, parallel=True)
def _scan(corners, multiplicity, low, high, step, half, first, last, means):  # type: ignore[no-untyped-def]
    """Fill in the means of the integer winding number of a cycle."""
    n_x, n_y, n_z = means.shape
    n_chunks = min(_CHUNKS, n_x)
    for chunk in numba.prange(n_chunks):
        begin, end = chunk * n_x // n_chunks, (chunk + 1) * n_x // n_chunks
        whole = np.zeros((end - begin, n_y, n_z + 1), dtype=np.int32)
        part = np.zeros((end - begin, n_y, n_z + 1), dtype=np.int32)
        i_from, i_to = max(begin * half, first[0]), min(end * half, last[0])
        for t in range(len(corners)):
            # One more on each side: rounding decides below, not here.
            i_first = max(i_from, int(np.floor(low[t, 0] / step[0])) - 1)
            i_last = min(i_to - 1, int(np.ceil(high[t, 0] / step[0])) + 1)
            if i_first > i_last:
                continue
            j_first = max(first[1], int(np.floor(low[t, 1] / step[1])) - 1)
            j_last = min(last[1] - 1, int(np.ceil(high[t, 1] / step[1])) + 1)
            a = corners[t]
            u_x, u_y, u_z = a[1, 0] - a[0, 0], a[1, 1] - a[0, 1], a[1, 2] - a[0, 2]
            v_x, v_y, v_z = a[2, 0] - a[0, 0], a[2, 1] - a[0, 1], a[2, 2] - a[0, 2]
            area = u_x * v_y - u_y * v_x
            for j in range(j_first, j_last + 1):
                y = j * step[1]
                for i in range(i_first, i_last + 1):
                    x = i * step[0]
                    turns = 0
                    for k in range(3):
                        m = (k + 1) % 3
                        if (a[k, 1] <= y) == (a[m, 1] <= y):
                            continue
                        # Looked at from its lower end, an edge says the same to both triangles.
                        b, c = (k, m) if a[k, 1] <= y else (m, k)
                        left = (a[c, 0] - a[b, 0]) * (y - a[b, 1]) - (a[c, 1] - a[b, 1]) * (
                            x - a[b, 0]
                        )
                        if left > 0:
                            turns += 1 if b == k else -1
                    if turns == 0:
                        continue
                    z = low[t, 2]
                    if area != 0.0:
                        p, q = x - a[0, 0], y - a[0, 1]
                        r = (p * v_y - q * v_x) / area
                        s = (u_x * q - u_y * p) / area
                        z = min(max(a[0, 2] + r * u_z + s * v_z, low[t, 2]), high[t, 2])
                    above = min(max(int(np.ceil(z / step[2])), first[2]), last[2])
                    weight = turns * multiplicity[t]
                    column, row = i // half - begin, j // half
                    whole[column, row, above // half] += weight
                    part[column, row, above // half] += weight * (above % half)
                    if first[2] > 0:  # The run begins at the first sample that counts.
                        whole[column, row, first[2] // half] -= weight
                        part[column, row, first[2] // half] -= weight * (first[2] % half)
        for column in range(end - begin):
            for row in range(n_y):
                total = whole[column, row, n_z]
                for block in range(n_z - 1, -1, -1):
                    count = half * total + part[column, row, block]
                    means[begin + column, row, block] = count / half**3
                    total += whole[column, row, block]


@numba.njit(cache=True, parallel=True)
def average_blocks(blocks, resolution):  # type: ignore[no-untyped-def]
    """Return the rounded fractions on the doubled grid of 3D half-block means."""
    n_x, n_y, n_z = blocks.shape
    values = np.empty((n_x + 1, n_y + 1, n_z + 1))
    for i in numba.prange(n_x + 1):
        for j in range(n_y + 1):
            for k in range(n_z + 1):
                total = 0.0
                for x in range(max(i - 1, 0), min(i + 1, n_x)):
                    for y in range(max(j - 1, 0), min(j + 1, n_y)):
                        for z in range(max(k - 1, 0), min(k + 1, n_z)):
                            total += blocks[x, y, z]
                values[i, j, k] = np.rint(total / 8 / resolution) * resolution + 0.0
    return values
