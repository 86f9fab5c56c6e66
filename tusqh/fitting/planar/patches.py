"""Smooth patches of an outline, and the patch to which each boundary side of a mesh belongs.

The ends of patches are corners of the outline.  Whether segments are connected in the file does not
matter: doubled, gapped and crossing ones give the same patches.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tusqh.fitting.target import Target
from tusqh.grid import BoolArray, FloatArray, IntArray

#: Samples at most this far apart may belong to one patch, in cells.
_LINK = 0.7

#: Cosine of the largest angle between their normals: 35 degrees.
_SMOOTH = 0.82

#: Length of the shortest patch, in cells.
_SHORTEST = 1.5

#: Length that both patches at a corner need, in cells.
_LONG = 3.0

#: How far from a boundary side its patch may be, in cells, and the nearest samples that are asked.
_REACH, _N_NEAR = 1.6, 24

#: Cost of a side without a patch, and of two sides in a row that differ.
_WITHOUT, _CHANGE = 2.0, 0.25

#: Largest deviation of a sample from a side of the box, in cells, and of its normal.
_ON_SIDE = 1e-9


class Patches(NamedTuple):
    """Patches of the samples of a target.

    Parameters
    ----------
    number
        Patch of every sample, -1 for those in none, shape (s,).
    is_long
        Whether each patch is long enough for corners, shape (patches,).
    axis, place
        Normal axis and coordinate of patches on a side of the target's box, otherwise -1 and NaN,
        shape (patches,).
    """

    number: IntArray
    is_long: BoolArray
    axis: IntArray
    place: FloatArray


def find_patches(target: Target) -> Patches:
    """Return the smooth patches of the samples of a target in the plane.

    Parameters
    ----------
    target
        The target.
    """
    points, normals = target.points, target.normals
    n = len(points)
    axis, place = _on_sides(target)
    if n == 0:
        return Patches(axis, np.zeros(0, dtype=np.bool_), axis, place)
    a, b = cKDTree(points).query_pairs(_LINK, output_type="ndarray").T
    apart = points[b] - points[a]
    distance = np.linalg.norm(apart, axis=1)
    is_linked = (normals[a] * normals[b]).sum(axis=1) >= _SMOOTH
    is_linked &= (axis[a] == axis[b]) & ((axis[a] < 0) | (place[a] == place[b]))
    for side in (a, b):
        is_linked &= np.abs((apart * normals[side]).sum(axis=1)) < 0.3 * distance + 0.02
    a, b = a[is_linked], b[is_linked]
    n_patches, number = connected_components(coo_array((np.ones(len(a)), (a, b)), (n, n)), False)
    lengths = np.linalg.norm(target.pieces[:, 1] - target.pieces[:, 0], axis=1)
    length = np.bincount(number[target.sample], lengths, minlength=n_patches)
    some = np.empty(n_patches, dtype=np.int64)
    some[number] = np.arange(n)
    is_side = axis[some] >= 0
    kept = is_side | (length >= _SHORTEST)
    new = np.where(kept, np.cumsum(kept) - 1, -1)
    is_long = is_side | (length >= _LONG)
    return Patches(new[number].astype(np.int64), is_long[kept], axis[some][kept], place[some][kept])


def _on_sides(target: Target) -> tuple[IntArray, FloatArray]:
    """Return the normal axis and the coordinate of samples on sides of the box; -1 and NaN."""
    axis = np.full(len(target.points), -1, dtype=np.int64)
    place = np.full(len(target.points), np.nan)
    if target.sides is None:
        return axis, place
    for k in range(2):
        for end in range(2):
            side = target.sides[end, k]
            is_on = np.abs(target.points[:, k] - side) < _ON_SIDE
            is_on &= (2 * end - 1) * target.normals[:, k] > 1 - _ON_SIDE
            axis[is_on], place[is_on] = k, side
    return axis, place


def label_sides(
    target: Target, patches: Patches, middle: FloatArray, normals: FloatArray, loop: IntArray
) -> IntArray:
    """Return the patch of every boundary side, -1 for none, shape (k,).

    The sum of the costs of all sides and of changes from one side to the next becomes as small as
    changes of single sides can make it.

    Parameters
    ----------
    target
        The target.
    patches
        Its patches.
    middle, normals
        Middle and outward normal of every boundary side, shape (k, 2) each.
    loop
        The sides before and after each one, shape (2, k).
    """
    n = len(middle)
    if not (patches.number >= 0).any():
        return np.full(n, -1, dtype=np.int64)
    for _ in range(3):
        normals = normals + normals[loop[0]] + normals[loop[1]]
        normals = normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    chosen = np.flatnonzero(patches.number >= 0)
    n_near = min(_N_NEAR, len(chosen))
    distance, near = cKDTree(target.points[chosen]).query(
        middle, k=[*range(1, n_near + 1)], distance_upper_bound=_REACH
    )
    row, k = np.nonzero(np.isfinite(distance))
    sample = chosen[near[row, k]]
    apart, normal = middle[row] - target.points[sample], target.normals[sample]
    off = (apart * normal).sum(axis=1)
    along = np.linalg.norm(apart - off[:, None] * normal, axis=1)
    beyond = np.maximum(0.0, along - 0.125)
    against = np.maximum(0.0, 0.2 - (normal * normals[row]).sum(axis=1))
    cost = off**2 + 2 * beyond**2 + 3 * against
    order = np.lexsort((cost, patches.number[sample], row))
    row, patch, cost = row[order], patches.number[sample][order], cost[order]
    is_first = np.ones(len(row), dtype=np.bool_)
    is_first[1:] = (row[1:] != row[:-1]) | (patch[1:] != patch[:-1])
    row, patch, cost = row[is_first], patch[is_first], cost[is_first]
    first = np.searchsorted(row, np.arange(n + 1))
    labels = np.full(n, -1, dtype=np.int64)
    _choose(first, patch, cost, loop[0], loop[1], labels)
    return labels


@numba.njit(cache=True)
def _choose(first, patch, cost, before, after, labels):  # type: ignore[no-untyped-def]
    """Give every side its cheapest patch in turn, until nothing changes."""
    for turn in range(50):
        n_changed = 0
        for side in range(len(labels)):
            best, least = -1, _WITHOUT
            if turn > 0:
                least += _CHANGE * ((labels[before[side]] != -1) + (labels[after[side]] != -1))
            for e in range(first[side], first[side + 1]):
                value = cost[e]
                if turn > 0:
                    value += _CHANGE * (labels[before[side]] != patch[e])
                    value += _CHANGE * (labels[after[side]] != patch[e])
                if value < least:
                    best, least = patch[e], value
            if labels[side] != best:
                labels[side] = best
                n_changed += 1
        if n_changed == 0 and turn > 0:
            return
