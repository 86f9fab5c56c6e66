r"""Sums of the winding number of a cap over half-blocks of samples, by a tree of blocks.

Away from a triangle its winding number is harmonic, so a polynomial through a few nodes replaces
it over a block that is far from the triangle.  Blocks are halved from large to small::

    block    values at N x N x N nodes: exact for triangles that are far from this block but from no
      |      larger one; for those far from a larger block, from the larger block's polynomial
    half     the same, for the triangles that were near the block
      :
    leaf     the remaining near triangles: exact, at every sample

Every sample counts every triangle exactly once.  A block without near triangles is finished: its
polynomial gives the sums over all its half-blocks, with weights that add up the samples.

The nodes are Chebyshev nodes with both end points, so most of them lie on the surface of the block.
Since the function is harmonic, its values on the surface determine those inside, so with many far
triangles only the surface is evaluated.  The interpolation converges like ``rho^-N``, where the
nearest triangle lies on the boundary of the Bernstein ellipse ``rho`` of a coordinate; at `FAR`
sides from the block's centre ``rho`` is at least 3.9, in the corner towards the triangle
(docs/sampling.md).
"""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.angles import FAR, add_far, add_near
from tusqh.sampling.block_nodes import BlockNodes, interpolation, nodes_for
from tusqh.sampling.closing import Chain
from tusqh.sampling.kernel_arguments import Blocks, Lists, Pieces, Samples
from tusqh.sampling.lattice import Lattice

#: Approximate number of samples along the side of the smallest block, whose near triangles are
#: evaluated exactly.
_LEAF = 8
#: Below this number of triangles a tighter tolerance is cheap, so it is used.
_FEW, _TIGHT = 100, 1e-7
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
    nodes = BlockNodes.of(nodes_for(tolerance), lattice.is_plane)
    leaf = np.maximum(1, 2 ** np.floor(np.log2(np.maximum(_LEAF / lattice.half, 1)))).astype(int)
    if lattice.is_plane:
        leaf[1] = 1
    shape = np.array([end - begin, *lattice.n_blocks[1:]])
    sides = [leaf]
    while (sides[0] < shape).any():
        sides.insert(0, np.where(nodes.counts > 1, 2 * sides[0], 1))
    middle = cap.corners.mean(axis=1)
    reach = np.linalg.norm(cap.corners - middle[:, None], axis=2).max(axis=1)
    pieces = Pieces(cap.corners, cap.multiplicity, middle, reach)
    samples = Samples(begin, lattice.half, lattice.first, lattice.last)
    blocks = np.zeros((1, 3), dtype=np.int64)
    values = np.zeros((1, int(nodes.counts.prod())))
    near = Lists(np.arange(len(cap)), np.array([0, len(cap)]))
    for level, side in enumerate(sides):
        lowest = (blocks + np.array([begin, 0, 0])) * lattice.half - 0.5
        size = side * lattice.half
        is_leaf = level == len(sides) - 1
        far, near = _split_lists(pieces, lowest + size / 2, float(size.max()), near)
        at = Blocks(lowest, size)
        add_far(pieces, at, nodes.tables, far, values, tolerance >= _SINGLE)
        is_done = np.diff(near.start) == 0
        to_x, to_y, to_z = _weights(lattice, side, begin, end, nodes.counts)
        _add_polynomials(
            blocks, side, to_x, to_y, to_z, is_done | is_leaf, nodes.counts, values, sums
        )
        if is_leaf:
            add_near(pieces, blocks, side, samples, near, sums)
        else:
            blocks, values, near = _halve(blocks, values, near, sides[level + 1], shape, nodes)


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
        in_block = (sample % (side[axis] * half) + 0.5) / (side[axis] * half)
        of_sample = interpolation(n, 2 * in_block - 1) if n > 1 else np.ones((len(sample), 1))
        absolute = sample + start * half
        counts = (absolute >= lattice.first[axis]) & (absolute < lattice.last[axis])
        weights.append((of_sample * counts[:, None]).reshape(n_blocks, half, n).sum(axis=1))
    return weights


def _halve(
    blocks: IntArray,
    values: FloatArray,
    near: Lists,
    side: IntArray,
    shape: IntArray,
    nodes: BlockNodes,
) -> tuple[IntArray, FloatArray, Lists]:
    """Return the next level: the halves, inside the lattice, of blocks with near triangles."""
    parents = np.flatnonzero(np.diff(near.start))
    offsets = np.stack(
        np.meshgrid(*[np.arange(len(h)) for h in nodes.halves], indexing="ij"), axis=-1
    ).reshape(-1, 3)
    children = blocks[parents][:, None] + offsets * side
    is_inside = (children < shape).all(axis=2)
    parent = np.repeat(parents, is_inside.sum(axis=1))
    which = np.broadcast_to(offsets, children.shape)[is_inside]
    # Every n-th block goes to the same thread, because neighbouring blocks have a similar cost.
    n_threads = numba.get_num_threads()
    order = np.concatenate([np.arange(k, len(parent), n_threads) for k in range(n_threads)])
    parent, which, children = parent[order], which[order], children[is_inside][order]
    length = np.diff(near.start)[parent]
    start = np.concatenate([[0], np.cumsum(length)])
    at_x, at_y, at_z = nodes.halves
    inherited = _inherit(values, parent, which, at_x, at_y, at_z, nodes.counts)
    return children, inherited, Lists(_copy_lists(near, parent, start), start)


@numba.njit(cache=True, error_model="numpy", parallel=True)
def _copy_lists(near, parent, start):  # type: ignore[no-untyped-def]
    copied = np.empty(start[-1], dtype=np.int64)
    for r in numba.prange(len(parent)):
        first, last = near.start[parent[r]], near.start[parent[r] + 1]
        copied[start[r] : start[r + 1]] = near.pieces[first:last]
    return copied


@numba.njit(cache=True, error_model="numpy", parallel=True)
def _inherit(values, parent, which, at_x, at_y, at_z, n_nodes):  # type: ignore[no-untyped-def]
    inherited = np.empty((len(parent), values.shape[1]))
    for r in numba.prange(len(parent)):
        _inherit_block(values[parent[r]], which[r], at_x, at_y, at_z, n_nodes, inherited[r])
    return inherited


# The bodies of loops are compiled on their own: inside `prange` that takes numba much longer.
@numba.njit(cache=True, error_model="numpy")
def _inherit_block(values, which, at_x, at_y, at_z, n_nodes, inherited):  # type: ignore[no-untyped-def]
    shape = n_nodes[0], n_nodes[1], n_nodes[2]
    new = inherited.reshape(shape)
    _contract(values.reshape(shape), at_x[which[0]], at_y[which[1]], at_z[which[2]], new, False)


@numba.njit(cache=True, error_model="numpy")
def _contract(old, to_x, to_y, to_z, new, is_added):  # type: ignore[no-untyped-def]
    """Apply a matrix along each axis: ``new[i, j, k] = to_x[i, a] to_y[j, b] to_z[k, c] old``."""
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
    if not is_added:
        new[:] = 0.0
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
def _split_lists(pieces, centre, side, lists):  # type: ignore[no-untyped-def]
    """Split the list of each block into the pieces that are far from it and those near it."""
    listed, start = lists.pieces, lists.start
    n = len(centre)
    is_far = np.empty(len(listed), dtype=np.bool_)
    n_far = np.zeros(n + 1, dtype=np.int64)
    for r in numba.prange(n):
        first, last = start[r], start[r + 1]
        n_far[r + 1] = _find_far(pieces, listed[first:last], centre[r], side, is_far[first:last])
    far_start = np.cumsum(n_far)
    near_start = start - far_start
    far_list = np.empty(far_start[-1], dtype=np.int64)
    near_list = np.empty(near_start[-1], dtype=np.int64)
    for r in numba.prange(n):
        first, last = start[r], start[r + 1]
        _split_list(
            listed[first:last],
            is_far[first:last],
            far_list[far_start[r] : far_start[r + 1]],
            near_list[near_start[r] : near_start[r + 1]],
        )
    return Lists(far_list, far_start), Lists(near_list, near_start)


@numba.njit(cache=True, error_model="numpy")
def _find_far(pieces, listed, centre, side, is_far):  # type: ignore[no-untyped-def]
    """Mark the pieces that are far from the centre of a block, and return their number."""
    corners, middle, reach = pieces.corners, pieces.middle, pieces.reach
    count = 0
    for c in range(len(listed)):
        t = listed[c]
        d = middle[t] - centre
        distance = np.sqrt(_dot(d, d))
        far = distance - reach[t] >= FAR * side
        if not far and reach[t] > 0.25 * side and distance >= FAR * side:
            far = _distance(centre, corners[t]) >= FAR * side
        is_far[c] = far
        count += far
    return count


@numba.njit(cache=True, error_model="numpy")
def _split_list(listed, is_far, far_list, near_list):  # type: ignore[no-untyped-def]
    f, m = 0, 0
    for c in range(len(listed)):
        if is_far[c]:
            far_list[f] = listed[c]
            f += 1
        else:
            near_list[m] = listed[c]
            m += 1


@numba.njit(cache=True, error_model="numpy", parallel=True)
def _add_polynomials(  # type: ignore[no-untyped-def]
    blocks, side, at_x, at_y, at_z, is_chosen, n_nodes, values, sums
):
    for r in numba.prange(len(blocks)):
        if is_chosen[r]:
            _add_polynomial(blocks[r], side, at_x, at_y, at_z, n_nodes, values[r], sums)


@numba.njit(cache=True, error_model="numpy")
def _add_polynomial(block, side, at_x, at_y, at_z, n_nodes, values, sums):  # type: ignore[no-untyped-def]
    i, j, k = block[0], block[1], block[2]
    i_to = min(i + side[0], sums.shape[0])
    j_to = min(j + side[1], sums.shape[1])
    k_to = min(k + side[2], sums.shape[2])
    old = values.reshape((n_nodes[0], n_nodes[1], n_nodes[2]))
    _contract(old, at_x[i:i_to], at_y[j:j_to], at_z[k:k_to], sums[i:i_to, j:j_to, k:k_to], True)
