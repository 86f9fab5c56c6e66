r"""Winding numbers of a soup on a lattice by counting crossings, not by solid angles.

A triangle soup is a chain with integer boundary.  Its boundary is coned to the centres of its
loops: the *cap* ``K``.  The soup less its cap is a closed cycle, so its winding number is an
integer everywhere, and along a lattice line it changes only where the line crosses a triangle::

    winding(soup) = crossings of (soup - K) above the sample + winding(K)

(algorithm notes 1).  The second term is a sum of solid angles over the few triangles of the cap,
and zero for closed soups, which are exact therefore.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import pandas as pd
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray, IntArray

#: More solid angles than this are left to libigl's tree, which is faster and less exact.
EXACT_ANGLES = 4_000_000_000


@dataclass(frozen=True)
class Chain:
    """Triangles with integer multiplicities.

    Parameters
    ----------
    corners
        Coordinates of the corners, shape (m, 3, 3).
    multiplicity
        How often each triangle counts, shape (m,).
    """

    corners: FloatArray
    multiplicity: IntArray


def close_soup(soup: Soup) -> tuple[Chain, Chain]:
    """Return a closed cycle and a cap whose sum is the soup.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> sheet = Soup(square, np.array([[0, 1, 2], [0, 2, 3]]), np.zeros(2, dtype=np.int64))
    >>> cycle, cap = close_soup(sheet)
    >>> len(cycle.corners), len(cap.corners)
    (6, 4)
    """
    points, triangles = soup.matched()
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    is_forward = edges[:, 0] < edges[:, 1]
    key = np.sort(edges, axis=1) @ np.array([len(points), 1])
    unique, inverse = np.unique(key, return_inverse=True)
    net = np.bincount(inverse, weights=np.where(is_forward, 1.0, -1.0)).astype(np.int64)
    # An edge walked twice to the same point is no boundary of anything.
    ends = np.stack([unique // len(points), unique % len(points)], axis=1)
    is_open = (net != 0) & (ends[:, 0] != ends[:, 1])
    ends, net = ends[is_open], net[is_open]
    corners = points[triangles]
    ones = np.ones(len(corners), dtype=np.int64)
    if len(ends) == 0:
        return Chain(corners, ones), Chain(np.empty((0, 3, 3)), np.empty(0, dtype=np.int64))
    graph = coo_array((np.ones(len(ends)), tuple(ends.T)), shape=(len(points),) * 2)
    _, loop = connected_components(graph, directed=False)
    of_edge = loop[ends[:, 0]]
    n_edges = np.bincount(of_edge)
    middle = points[ends].mean(axis=1)
    centre = np.stack([np.bincount(of_edge, weights=x) for x in middle.T], axis=1)[of_edge]
    centre /= n_edges[of_edge][:, None]
    cap = np.stack([centre, points[ends[:, 0]], points[ends[:, 1]]], axis=1)
    cycle = Chain(np.concatenate([corners, cap]), np.concatenate([ones, -net]))
    return cycle, Chain(cap, net)


def has_small_cap(soup: Soup, axes: list[FloatArray]) -> bool:
    """Return whether the cap's solid angles can be added exactly in reasonable time."""
    n_samples = float(np.prod([len(axis) for axis in axes]))
    return len(close_soup(soup)[1].corners) * n_samples <= EXACT_ANGLES


def describe_winding(soup: Soup, *, n: int = 32) -> pd.DataFrame:
    """Return the range of the winding number on n^3 samples, as rows of the table of defects.

    `count` says how many samples lie below 0 or above 1, where parts are inside out or overlap.

    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> faces = np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]])
    >>> table = describe_winding(Soup(points, faces, np.zeros(4, dtype=np.int64)))
    >>> table["measure"].tolist()
    [0.0, 1.0]
    """
    low, high = (np.array(corner) for corner in soup.bounding_box())
    axes = [a + (b - a) * (np.arange(n) + 0.5) / n for a, b in zip(low, high, strict=True)]
    winding = np.round(wind_on_lattice(soup, axes), 12)
    what = f"winding number over {n}^3 samples of the bounding box; samples"
    rows = [
        ("winding_number_min", int((winding < 0).sum()), winding.min(), f"least {what} below 0"),
        ("winding_number_max", int((winding > 1).sum()), winding.max(), f"greatest {what} above 1"),
    ]
    table = pd.DataFrame(rows, columns=["defect", "count", "measure", "explanation"])
    table.insert(3, "unit", "-")
    return table


def wind_on_lattice(soup: Soup, axes: list[FloatArray]) -> FloatArray:
    """Return the generalized winding number of a soup at every point of a lattice.

    Parameters
    ----------
    soup
        The triangles, as they are.
    axes
        Evenly spaced coordinates along x, y and z, in the units of the soup.

    Returns
    -------
    winding
        Shape of the lattice, dimensionless; exact for closed soups.

    Examples
    --------
    A tetrahedron without its base is open: inside, its winding number is less than one.

    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> faces = np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]])
    >>> lattice = [np.array([0.2, 2.2])] * 3
    >>> closed = Soup(points, faces, np.zeros(4, dtype=np.int64))
    >>> wind_on_lattice(closed, lattice)[0, 0].tolist()
    [1.0, 0.0]
    >>> opened = Soup(points, faces[:3], np.zeros(3, dtype=np.int64))
    >>> round(float(wind_on_lattice(opened, lattice)[0, 0, 0]), 2)
    0.76
    """
    cycle, cap = close_soup(soup)
    # Far from the origin differences lose digits if taken late.
    centre = np.array([axis[0] for axis in axes])
    step = np.array([axis[1] - axis[0] if len(axis) > 1 else 1.0 for axis in axes])
    shape = tuple(len(axis) for axis in axes)
    jumps = np.zeros((*shape[:2], shape[2] + 1), dtype=np.int32)
    _count_crossings(cycle.corners - centre, cycle.multiplicity, step, jumps)
    winding = np.cumsum(jumps[:, :, ::-1], axis=2)[:, :, -2::-1].astype(np.float64)
    if len(cap.corners):
        if len(cap.corners) * winding.size <= EXACT_ANGLES:
            _add_solid_angles(cap.corners - centre, cap.multiplicity, step, winding)
        else:
            _add_by_tree(cap, centre, step, winding)
    return winding


def _add_by_tree(cap: Chain, centre: FloatArray, step: FloatArray, winding: FloatArray) -> None:
    """Add the winding number of a large cap by libigl's hierarchical approximation."""
    import igl

    repeated = np.abs(cap.multiplicity)
    corners = np.where(
        (cap.multiplicity > 0)[:, None, None], cap.corners, cap.corners[:, [0, 2, 1]]
    )
    points = (np.repeat(corners, repeated, axis=0) - centre).reshape(-1, 3)
    triangles = np.arange(len(points), dtype=np.int64).reshape(-1, 3)
    for index in range(len(winding)):
        plane = np.stack(np.meshgrid(*(np.arange(n) for n in winding.shape[1:]), indexing="ij"), -1)
        queries = np.full((plane[..., 0].size, 3), index * step[0])
        queries[:, 1:] = plane.reshape(-1, 2) * step[1:]
        winding[index] += igl.fast_winding_number(points, triangles, queries).reshape(
            winding.shape[1:]
        )


@numba.njit(cache=True)
def _count_crossings(corners, multiplicity, step, jumps):  # type: ignore[no-untyped-def]
    """Add up, at every sample, the crossings with triangles directly above it.

    A line crosses the triangle that its point in the plane lies in.  That is decided edge by
    edge, by the ray to +x, and every edge is looked at from its lower to its upper end: the two
    triangles at an edge agree to the last bit, so the crossings of a cycle always add up to zero.
    """
    n_x, n_y, n_z = jumps.shape[0], jumps.shape[1], jumps.shape[2] - 1
    for t in range(len(corners)):
        a = corners[t]
        x_low = min(a[0, 0], a[1, 0], a[2, 0])
        x_high = max(a[0, 0], a[1, 0], a[2, 0])
        y_low = min(a[0, 1], a[1, 1], a[2, 1])
        y_high = max(a[0, 1], a[1, 1], a[2, 1])
        z_low = min(a[0, 2], a[1, 2], a[2, 2])
        z_high = max(a[0, 2], a[1, 2], a[2, 2])
        # One more on each side: rounding decides below, not here.
        i_first = max(0, int(np.floor(x_low / step[0])) - 1)
        i_last = min(n_x - 1, int(np.ceil(x_high / step[0])) + 1)
        j_first = max(0, int(np.floor(y_low / step[1])) - 1)
        j_last = min(n_y - 1, int(np.ceil(y_high / step[1])) + 1)
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
                    low, high = (k, m) if a[k, 1] <= y else (m, k)
                    left = (a[high, 0] - a[low, 0]) * (y - a[low, 1]) - (a[high, 1] - a[low, 1]) * (
                        x - a[low, 0]
                    )
                    if left > 0:
                        turns += 1 if low == k else -1
                if turns == 0:
                    continue
                z = z_low
                if area != 0.0:
                    p, q = x - a[0, 0], y - a[0, 1]
                    r = (p * v_y - q * v_x) / area
                    s = (u_x * q - u_y * p) / area
                    z = min(max(a[0, 2] + r * u_z + s * v_z, z_low), z_high)
                above = int(np.ceil(z / step[2]))  # Samples 0 .. above - 1 lie below.
                above = min(max(above, 0), n_z)
                jumps[i, j, above] += turns * multiplicity[t]


@numba.njit(cache=True, parallel=True)
def _add_solid_angles(corners, multiplicity, step, winding):  # type: ignore[no-untyped-def]
    """Add the solid angles of triangles over 4 pi (van Oosterom and Strackee, 1983)."""
    n_x, n_y, n_z = winding.shape
    for i in numba.prange(n_x):
        for j in range(n_y):
            for k in range(n_z):
                x, y, z = i * step[0], j * step[1], k * step[2]
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
                winding[i, j, k] += total / (2 * np.pi)
