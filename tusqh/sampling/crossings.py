"""Sums of the integer winding number of a cycle over half-blocks of samples.

Along a lattice line the winding number of a closed cycle changes only where the line crosses it,
so a crossing adds a run of samples to the half-blocks below it.  A difference array records the
whole blocks, a second array the partial block; no sample is visited (algorithm 1).

The side on which a line passes an edge is always computed from the edge's lower to its upper end,
for either triangle, and half-open comparisons break ties (they move the line by an infinitesimal
amount, to +x and then +y).  So neighbours agree to the last bit, the crossings along every line add
up to zero, and all sums are sums of integers, which neither chunks nor threads change.
"""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid import BoolArray, FloatArray
from tusqh.sampling.closing import Chain
from tusqh.sampling.lattice import Lattice

#: Parts of the lattice along x that are scanned side by side.
_CHUNKS = 16
#: A triangle is a wall, parallel to the lines along z, if the z part of its normal is at most this.
_STEEP = 1e-9
#: A sample nearer to a cap than this, in steps of the lattice, lies on it up to rounding.
_NEAR = 1e-9


def add_crossings(chain: Chain, lattice: Lattice, begin: int, end: int, sums: FloatArray) -> None:
    """Add the winding numbers of a closed cycle over the half-blocks ``begin <= i < end``.

    Parameters
    ----------
    chain
        A closed chain of triangles (without a boundary) or segments (without end points), with
        coordinates in steps of the lattice from its first sample.
    lattice
        The samples.
    begin, end
        Range of half-blocks along x.
    sums
        Sums over the samples of each half-block, shape (end - begin, n_y, n_z); added to.
    """
    if len(chain) == 0:
        return
    low, high = chain.corners.min(axis=1), chain.corners.max(axis=1)
    _scan(
        chain.corners,
        chain.multiplicity,
        low,
        high,
        lattice.half,
        lattice.first,
        lattice.last,
        begin,
        end,
        sums,
    )


def correct_sides(chain: Chain, lattice: Lattice, begin: int, end: int, sums: FloatArray) -> None:
    """Add the turns by which a cap's angles and its crossings disagree about a sample's side.

    A sample on a cap, up to rounding, gets half a turn from it.  Both the count of crossings and
    the sign of the angle put it on one side; where they disagree, the angle is a whole turn off.

    Parameters
    ----------
    chain
        A cap, with coordinates in steps of the lattice from its first sample.
    lattice
        The samples.
    begin, end
        Range of half-blocks along x.
    sums
        Sums over the samples of each half-block, shape (end - begin, n_y, n_z); added to.
    """
    if len(chain) == 0:
        return
    low, high = chain.corners.min(axis=1), chain.corners.max(axis=1)
    normal = _normals(chain.corners)
    found = _list_sides(
        chain.corners,
        normal,
        low,
        high,
        lattice.half,
        lattice.first,
        lattice.last,
        begin,
        end,
    )
    number, sample, is_positive = found[:, 0], found[:, 1:4], found[:, 4] == 1
    seen = chain.corners[number] - sample[:, None]
    # The same operations in the same order as in `angles`: signs agree to the last bit.
    distance = sum(normal[number, k] * seen[:, 0, k] for k in range(3))
    is_on = np.abs(distance) <= _NEAR * np.linalg.norm(normal[number], axis=1)
    is_on &= _is_facing(seen)
    is_off = is_on & ((distance >= 0.0) != is_positive)
    place = sample[is_off] // lattice.half - [begin, 0, 0]
    turns = np.where(is_positive, 1, -1)[is_off] * chain.multiplicity[number[is_off]]
    np.add.at(sums, tuple(place.T), turns)


def _normals(corners: FloatArray) -> FloatArray:
    """Return normals that equal those in `angles` in every bit."""
    sides = corners[:, 1:] - corners[:, :1]
    if corners.shape[1] == 2:
        zero = np.zeros(len(corners))
        return np.stack([sides[:, 0, 2], zero, -sides[:, 0, 0]], axis=1)
    u, v = sides[:, 0].T, sides[:, 1].T
    return np.stack(
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]], axis=1
    )


def _is_facing(seen: FloatArray) -> BoolArray:
    """Return whether triangles or segments subtend more than a quarter turn at the origin."""
    if seen.shape[1] == 2:
        return np.asarray((seen[:, 0] * seen[:, 1]).sum(axis=1) < 0.0)
    a, b, c = (seen[:, k] for k in range(3))
    d, e, f = (np.linalg.norm(seen[:, k], axis=1) for k in range(3))
    dot = [(x * y).sum(axis=1) for x, y in ((a, b), (b, c), (c, a))]
    return np.asarray(d * e * f + dot[0] * f + dot[1] * d + dot[2] * e < 0.0)


@numba.njit(cache=True, error_model="numpy", inline="always")
def _pass(a, x, y):  # type: ignore[no-untyped-def]
    """Return how a line along z passes a triangle or segment.

    The first number is the winding number of the projection around the line, the second the side
    on which the line passes otherwise: -1 for -x, 1 for +x, -2 for -y, 2 for +y.
    """
    if a.shape[0] == 2:
        is_first, is_second = a[0, 0] <= x, a[1, 0] <= x
        return (1 if is_second else 0) - (1 if is_first else 0), 1 if is_first else -1
    turns = 0
    side = 2 if a[0, 1] <= y else -2
    for k in range(3):
        m = (k + 1) % 3
        if (a[k, 1] <= y) == (a[m, 1] <= y):
            continue
        # Orient each edge from its lower end so that both adjacent triangles get the same sign.
        b, c = (k, m) if a[k, 1] <= y else (m, k)
        left = (a[c, 0] - a[b, 0]) * (y - a[b, 1]) - (a[c, 1] - a[b, 1]) * (x - a[b, 0])
        side = -1 if left > 0 else 1
        if left > 0:
            turns += 1 if b == k else -1
    return turns, side


@numba.njit(cache=True, error_model="numpy", inline="always")
def _height_of(a, x, y, z_low, z_high):  # type: ignore[no-untyped-def]
    """Return where a line along z meets the plane of a triangle or segment, clipped to it."""
    if a.shape[0] == 2:
        b, c = (0, 1) if a[0, 0] <= a[1, 0] else (1, 0)
        z = a[b, 2] + (x - a[b, 0]) / (a[c, 0] - a[b, 0]) * (a[c, 2] - a[b, 2])
        return min(max(z, z_low), z_high)
    u_x, u_y, u_z = a[1, 0] - a[0, 0], a[1, 1] - a[0, 1], a[1, 2] - a[0, 2]
    v_x, v_y, v_z = a[2, 0] - a[0, 0], a[2, 1] - a[0, 1], a[2, 2] - a[0, 2]
    area = u_x * v_y - u_y * v_x
    if area == 0.0:
        return z_low
    p, q = x - a[0, 0], y - a[0, 1]
    r = (p * v_y - q * v_x) / area
    s = (u_x * q - u_y * p) / area
    return min(max(a[0, 2] + r * u_z + s * v_z, z_low), z_high)


@numba.njit(cache=True, error_model="numpy", parallel=True)
def _scan(  # type: ignore[no-untyped-def]
    corners, multiplicity, low, high, half, first, last, begin, end, sums
):
    n_chunks = min(_CHUNKS, end - begin)
    for chunk in numba.prange(n_chunks):
        from_ = begin + chunk * (end - begin) // n_chunks
        to = begin + (chunk + 1) * (end - begin) // n_chunks
        _scan_slab(
            corners, multiplicity, low, high, half, first, last, from_, to, sums[from_ - begin :]
        )


# Compiled on its own, because numba takes many times as long for the same loops inside `prange`.
@numba.njit(cache=True, error_model="numpy")
def _scan_slab(  # type: ignore[no-untyped-def]
    corners, multiplicity, low, high, half, first, last, from_, to, sums
):
    """Add the sums of the half-blocks `from_` to `to` along x, which begin `sums`."""
    n_y, n_z = sums.shape[1], sums.shape[2]
    whole = np.zeros((to - from_, n_y, n_z + 1), dtype=np.int32)
    part = np.zeros((to - from_, n_y, n_z + 1), dtype=np.int32)
    i_from, i_to = max(from_ * half[0], first[0]), min(to * half[0], last[0])
    for t in range(len(corners)):
        # Add one sample on each side, so that the predicate decides and not the box's rounding.
        i_first = max(i_from, int(np.floor(low[t, 0])) - 1)
        i_last = min(i_to - 1, int(np.ceil(high[t, 0])) + 1)
        if i_first > i_last:
            continue
        j_first = max(first[1], int(np.floor(low[t, 1])) - 1)
        j_last = min(last[1] - 1, int(np.ceil(high[t, 1])) + 1)
        for j in range(j_first, j_last + 1):
            for i in range(i_first, i_last + 1):
                turns, _ = _pass(corners[t], float(i), float(j))
                if turns == 0:
                    continue
                z = _height_of(corners[t], float(i), float(j), low[t, 2], high[t, 2])
                above = int(min(max(np.ceil(z), float(first[2])), float(last[2])))
                weight = turns * multiplicity[t]
                column, row = i // half[0] - from_, j // half[1]
                whole[column, row, above // half[2]] += weight
                part[column, row, above // half[2]] += weight * (above % half[2])
                if first[2] > 0:  # The run begins at the first sample that counts.
                    whole[column, row, first[2] // half[2]] -= weight
                    part[column, row, first[2] // half[2]] -= weight * (first[2] % half[2])
    for column in range(to - from_):
        for row in range(n_y):
            total = whole[column, row, n_z]
            for block in range(n_z - 1, -1, -1):
                sums[column, row, block] += half[2] * total + part[column, row, block]
                total += whole[column, row, block]


@numba.njit(cache=True, error_model="numpy")
def _list_sides(  # type: ignore[no-untyped-def]
    corners, normal, low, high, half, first, last, begin, end
):
    """List the samples that may lie on a triangle, and the side on which counting puts them.

    Each row holds the triangle, the sample (3 numbers) and whether its angle is positive; the shape
    is (n, 5).
    """
    found = [(0, 0, 0, 0, 0) for _ in range(0)]
    i_from, i_to = max(begin * half[0], first[0]), min(end * half[0], last[0])
    for t in range(len(corners)):
        a = corners[t]
        n_x, n_y, n_z = normal[t]
        is_steep = abs(n_z) <= _STEEP * np.sqrt(n_x * n_x + n_y * n_y + n_z * n_z)
        i_first = max(i_from, int(np.floor(low[t, 0])) - 1)
        i_last = min(i_to - 1, int(np.ceil(high[t, 0])) + 1)
        j_first = max(first[1], int(np.floor(low[t, 1])) - 1)
        j_last = min(last[1] - 1, int(np.ceil(high[t, 1])) + 1)
        for j in range(j_first, j_last + 1):
            for i in range(i_first, i_last + 1):
                x, y = float(i), float(j)
                turns, side = _pass(a, x, y)
                if turns == 0 and not is_steep:
                    continue
                z = _height_of(a, x, y, low[t, 2], high[t, 2]) if turns != 0 else low[t, 2]
                k_from, k_to = (low[t, 2], high[t, 2]) if is_steep else (z, z)
                # The angle is positive below a crossing that turns once and negative above it;
                # beside a wall, the side on which the line passes decides.
                along = n_x if abs(side) == 1 else n_y
                is_behind = (along > 0) == (side < 0)
                for k in range(
                    max(int(np.ceil(max(k_from, -1e9))) - 1, first[2]),
                    min(int(np.ceil(min(k_to, 1e9))) + 1, last[2]),
                ):
                    is_positive = (turns > 0) == (k < z) if turns != 0 else is_behind
                    found.append((t, i, j, k, 1 if is_positive else 0))
    rows = np.empty((len(found), 5), dtype=np.int64)
    for r in range(len(found)):
        for c in range(5):
            rows[r, c] = found[r][c]
    return rows
