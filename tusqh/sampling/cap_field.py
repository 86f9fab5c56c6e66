r"""Sums of the winding number of a cap over half-blocks of samples, by a tree of blocks.

Away from a triangle its winding number is harmonic, so a polynomial through a few nodes replaces
it over a block that is far from the triangle.  Blocks are halved from large to small::

    block    triangles that are far from this block but from no larger one: exact at the nodes,
      |      and the polynomial through them gives the sums over the half-blocks
    half     the same, for the triangles that were near the block
      :
    leaf     the remaining near triangles: exact, at every sample

Every sample counts every triangle exactly once.  A block without near triangles is finished.  It
reaches from its first sample to its last one along each axis, so that polynomials are only used
where there are samples.

The nodes are Chebyshev nodes with both end points along each axis.  Since the function is
harmonic, its values at the nodes on the surface of the block determine those inside, so only the
surface is evaluated.  In a small block one matrix maps them to the sums; in a large one the
polynomial is evaluated axis by axis.  The interpolation converges like ``rho^-N``, where the
nearest triangle lies on the boundary of the Bernstein ellipse ``rho`` of a coordinate; so the
farther a triangle is, the fewer nodes it needs (`tusqh.sampling.block_nodes`).
"""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.sampling.angles import add_near, wind_far
from tusqh.sampling.block_nodes import BlockNodes, interpolation, orders_for
from tusqh.sampling.closing import Chain
from tusqh.sampling.kernel_arguments import Blocks, Lists, Pieces, Samples
from tusqh.sampling.lattice import Lattice

#: Approximate number of samples along the side of the smallest block, whose near triangles are
#: evaluated exactly.
_LEAF = 8
#: Below this number of triangles a tighter tolerance is cheap, so it is used.
_FEW, _TIGHT = 100, 1e-8
#: Up to this number of half-blocks in a block, one matrix maps its surface to their sums.
_FEW_SUMS = 64
#: Tolerance from which single precision suffices.
_SINGLE = 2e-7


def add_cap(
    cap: Chain, lattice: Lattice, begin: int, end: int, sums: FloatArray, *, tolerance: float
) -> None:
    """Add the winding numbers of a cap over the half-blocks ``begin <= i < end``.

    Parameters
    ----------
    cap
        Triangles or segments, with coordinates in steps of the lattice from its first sample.
    lattice
        The samples.
    begin, end
        Range of half-blocks along x.
    sums
        Sums over the samples of each half-block to add to, shape (end - begin, n_y, n_z).
    tolerance
        Largest error of a fraction, dimensionless.
    """
    if len(cap) == 0:
        return
    if len(cap) <= _FEW:
        tolerance = min(tolerance, _TIGHT)
    orders, is_single = orders_for(tolerance), tolerance >= _SINGLE
    middle = cap.corners.mean(axis=1)
    reach = np.linalg.norm(cap.corners - middle[:, None], axis=2).max(axis=1)
    pieces = Pieces(cap.corners, cap.multiplicity, middle, reach)
    samples = Samples(begin, lattice.half, lattice.first, lattice.last)
    shape = np.array([end - begin, *lattice.n_blocks[1:]])
    blocks, parent = np.zeros((1, 3), dtype=np.int64), np.zeros(1, dtype=np.int64)
    near = Lists(np.arange(len(cap)), np.array([0, len(cap)]))
    sides = _sides(lattice, shape)
    for level, side in enumerate(sides):
        size: FloatArray = np.asarray(side * lattice.half - 1, dtype=np.float64)
        at = Blocks((blocks + np.array([begin, 0, 0])) * lattice.half, size)
        near, *far = _split_lists(pieces, at, orders.distance, near, parent)
        is_whole = _are_whole(samples, blocks, side, shape)
        for n, distance, listed in zip(orders.n_nodes, orders.distance, far, strict=True):
            nodes = BlockNodes.of(int(n), lattice.is_plane)
            weights = _weights(lattice, side, begin, end, nodes.counts)
            tables = nodes.tables(float(distance))
            has_far = np.diff(listed.start) > 0
            rows = np.flatnonzero(has_far & is_whole)
            if len(rows):
                matrix = nodes.sums_from_surface(weights, blocks[rows[0]], side)
                _, added = wind_far(pieces, at, tables, listed, rows, is_single, matrix)
                _add_sums(blocks[rows], side, added, sums)
            rows = np.flatnonzero(has_far & ~is_whole)
            if len(rows):
                known = wind_far(pieces, at, tables, listed, rows, is_single, nodes.fill)
                values = nodes.in_order(*known)
                x, y, z = weights
                _add_polynomials(blocks[rows], side, x, y, z, nodes.counts, values, sums)
        if level == len(sides) - 1:
            add_near(pieces, blocks, side, samples, near, sums)
        else:
            blocks, parent = _halve(blocks, near, sides[level + 1], shape)


def _sides(lattice: Lattice, shape: IntArray) -> list[IntArray]:
    """Return the sides of blocks in half-blocks, from one block for the whole shape to leaves."""
    leaf = np.maximum(1, 2 ** np.floor(np.log2(np.maximum(_LEAF / lattice.half, 1)))).astype(int)
    if lattice.is_plane:
        leaf[1] = 1
    sides = [leaf]
    while (sides[0] < shape).any():
        sides.insert(0, sides[0] * np.array([2, 1 if lattice.is_plane else 2, 2]))
    return sides


def _are_whole(samples: Samples, blocks: IntArray, side: IntArray, shape: IntArray) -> BoolArray:
    """Return which blocks are small and inside the lattice, and all of whose samples count."""
    low = (blocks + np.array([samples.begin, 0, 0])) * samples.half
    is_whole = (low >= samples.first) & (low + side * samples.half <= samples.last)
    is_whole &= (blocks + side <= shape) & (side.prod() <= _FEW_SUMS)
    return np.asarray(is_whole.all(axis=1))


def _weights(
    lattice: Lattice, side: IntArray, begin: int, end: int, n_nodes: IntArray
) -> list[FloatArray]:
    """Return the weights from node values to sums for each axis, shape (half-blocks, nodes)."""
    weights = []
    for axis in range(3):
        n, half = int(n_nodes[axis]), int(lattice.half[axis])
        n_blocks = end - begin if axis == 0 else int(lattice.n_blocks[axis])
        start = begin if axis == 0 else 0
        sample = np.arange(n_blocks * half)
        along = side[axis] * half
        if n > 1:
            of_sample = interpolation(n, np.linspace(-1, 1, along))[sample % along]
        else:
            of_sample = np.ones((len(sample), 1))
        absolute = sample + start * half
        counts = (absolute >= lattice.first[axis]) & (absolute < lattice.last[axis])
        weights.append((of_sample * counts[:, None]).reshape(n_blocks, half, n).sum(axis=1))
    return weights


def _halve(
    blocks: IntArray, near: Lists, side: IntArray, shape: IntArray
) -> tuple[IntArray, IntArray]:
    """Return the halves, inside the lattice, of blocks with near pieces, and their parents."""
    parents = np.flatnonzero(np.diff(near.start))
    offsets = np.indices(np.where(side < shape, 2, 1).tolist()).reshape(3, -1).T
    children = blocks[parents][:, None] + offsets * side
    is_inside = (children < shape).all(axis=2)
    parent = np.repeat(parents, is_inside.sum(axis=1))
    # Every n-th block goes to the same thread, because neighbouring blocks have a similar cost.
    n_threads = numba.get_num_threads()
    order = np.concatenate([np.arange(k, len(parent), n_threads) for k in range(n_threads)])
    return children[is_inside][order], parent[order]


def _split_lists(
    pieces: Pieces, blocks: Blocks, distance: FloatArray, near: Lists, parent: IntArray
) -> list[Lists]:
    """Split the near list of each block's parent into near pieces and those of each order."""
    n = len(blocks.lowest)
    size = np.diff(near.start)[parent]
    first = np.concatenate([[0], np.cumsum(size)])
    order, counts = _find_orders(pieces, blocks, distance, near, parent, first)
    start = np.concatenate([[0], np.cumsum(counts)])
    listed = _sort_lists(near, parent, first, order, start, len(distance) + 1)
    return [Lists(listed, start[c * n : (c + 1) * n + 1]) for c in range(len(distance) + 1)]


# The bodies of loops are compiled on their own: inside `prange` that takes numba much longer.
@numba.njit(cache=True, error_model="numpy")
def _contract(old, to_x, to_y, to_z, new):  # type: ignore[no-untyped-def]
    """Apply a matrix along each axis: ``new[i, j, k] += to_x[i, a] to_y[j, b] to_z[k, c] old``."""
    n_x, n_y, n_z = old.shape
    m_x, m_y, m_z = new.shape
    along_z = np.zeros((n_x, n_y, m_z))
    for a in range(n_x):
        for b in range(n_y):
            for c in range(n_z):
                for k in range(m_z):
                    along_z[a, b, k] += to_z[k, c] * old[a, b, c]
    along_y = np.zeros((n_x, m_y, m_z))
    for a in range(n_x):
        for j in range(m_y):
            for b in range(n_y):
                for k in range(m_z):
                    along_y[a, j, k] += to_y[j, b] * along_z[a, b, k]
    for i in range(m_x):
        for a in range(n_x):
            for j in range(m_y):
                for k in range(m_z):
                    new[i, j, k] += to_x[i, a] * along_y[a, j, k]


@numba.njit(cache=True, error_model="numpy")
def _distance(p, corner):  # type: ignore[no-untyped-def]
    """Return the distance of a point to a triangle or segment."""
    nearest = np.inf
    n = corner.shape[0]
    if n == 3:
        u, v, w = corner[1] - corner[0], corner[2] - corner[0], p - corner[0]
        uu, uv, vv = _dot(u, u), _dot(u, v), _dot(v, v)
        wu, wv = _dot(w, u), _dot(w, v)
        determinant = uu * vv - uv * uv
        if determinant > 0.0:
            s, t = (vv * wu - uv * wv) / determinant, (uu * wv - uv * wu) / determinant
            if s >= 0.0 and t >= 0.0 and s + t <= 1.0:
                q = w - s * u - t * v
                return np.sqrt(_dot(q, q))
    for k in range(n if n == 3 else 1):
        e, w = corner[(k + 1) % n] - corner[k], p - corner[k]
        ee = _dot(e, e)
        s = min(max(_dot(e, w) / ee, 0.0), 1.0) if ee > 0.0 else 0.0
        q = w - s * e
        nearest = min(nearest, np.sqrt(_dot(q, q)))
    return nearest


@numba.njit(cache=True, error_model="numpy")
def _dot(u, v):  # type: ignore[no-untyped-def]
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


@numba.njit(cache=True, error_model="numpy", parallel=True)
def _find_orders(pieces, blocks, distance, near, parent, first):  # type: ignore[no-untyped-def]
    """Return the order of every listed piece, 0 for a near one, and the sizes of all new lists."""
    n = len(blocks.lowest)
    order = np.empty(first[-1], dtype=np.uint8)
    counts = np.zeros((len(distance) + 1, n), dtype=np.int64)
    for r in numba.prange(n):
        listed = near.pieces[near.start[parent[r]] : near.start[parent[r] + 1]]
        centre = blocks.lowest[r] + 0.5 * blocks.size
        side = blocks.size[0]
        _find_order(
            pieces, listed, centre, side, distance, order[first[r] : first[r + 1]], counts[:, r]
        )
    return order, counts.ravel()


@numba.njit(cache=True, error_model="numpy")
def _find_order(pieces, listed, centre, side, distance, order, counts):  # type: ignore[no-untyped-def]
    corners, middle, reach = pieces.corners, pieces.middle, pieces.reach
    farthest = distance[-1] * side
    for c in range(len(listed)):
        t = listed[c]
        d = middle[t] - centre
        apart = np.sqrt(_dot(d, d))
        least = apart - reach[t]
        # The distance of a large piece itself may be larger than this bound.
        if least < farthest and reach[t] > 0.25 * side and apart >= distance[0] * side:
            least = _distance(centre, corners[t])
        found = 0
        while found < len(distance) and least >= distance[found] * side:
            found += 1
        order[c] = found
        counts[found] += 1


@numba.njit(cache=True, error_model="numpy", parallel=True)
def _sort_lists(near, parent, first, order, start, n_orders):  # type: ignore[no-untyped-def]
    n = len(parent)
    listed = np.empty(start[-1], dtype=np.int64)
    for r in numba.prange(n):
        old = near.pieces[near.start[parent[r]] : near.start[parent[r] + 1]]
        _sort_list(old, order[first[r] : first[r + 1]], start, r, n, n_orders, listed)
    return listed


@numba.njit(cache=True, error_model="numpy")
def _sort_list(old, order, start, r, n, n_orders, listed):  # type: ignore[no-untyped-def]
    free = np.empty(n_orders, dtype=np.int64)
    for c in range(n_orders):
        free[c] = start[c * n + r]
    for c in range(len(old)):
        listed[free[order[c]]] = old[c]
        free[order[c]] += 1


@numba.njit(cache=True, error_model="numpy", parallel=True)
def _add_sums(blocks, side, added, sums):  # type: ignore[no-untyped-def]
    for r in numba.prange(len(blocks)):
        i, j, k = blocks[r, 0], blocks[r, 1], blocks[r, 2]
        new = added[r].reshape((side[0], side[1], side[2]))
        sums[i : i + side[0], j : j + side[1], k : k + side[2]] += new


@numba.njit(cache=True, error_model="numpy", parallel=True)
def _add_polynomials(blocks, side, at_x, at_y, at_z, n_nodes, values, sums):  # type: ignore[no-untyped-def]
    for r in numba.prange(len(blocks)):
        _add_polynomial(blocks[r], side, at_x, at_y, at_z, n_nodes, values[r], sums)


@numba.njit(cache=True, error_model="numpy")
def _add_polynomial(block, side, at_x, at_y, at_z, n_nodes, values, sums):  # type: ignore[no-untyped-def]
    i, j, k = block[0], block[1], block[2]
    i_to = min(i + side[0], sums.shape[0])
    j_to = min(j + side[1], sums.shape[1])
    k_to = min(k + side[2], sums.shape[2])
    old = values.reshape((n_nodes[0], n_nodes[1], n_nodes[2]))
    _contract(old, at_x[i:i_to], at_y[j:j_to], at_z[k:k_to], sums[i:i_to, j:j_to, k:k_to])
