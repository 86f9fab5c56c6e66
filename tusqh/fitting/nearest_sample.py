"""Find the nearest sample that faces the same way, by bins of one cell.

The square of the distance is ``|p - x|^2 + TURN |n - m|^2`` with the normals n and m, which keeps
a point from the far side of a thin wall.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from tusqh.grid import BoolArray, FloatArray, IntArray

#: Weight of the difference of the normals.
TURN = 0.49
#: Farthest samples along their plane, in cells, and least cosine of the normals, of all samples and
#: of those of one patch.
_ALONG, _AGREE, _AGREE_IN_PATCH = 0.8, 0.2, -0.3


class Bins(NamedTuple):
    """Samples sorted into bins of one cell.

    Parameters
    ----------
    points, normals
        The samples, bin by bin, shape (s, 3) each.
    label
        Patch of each sample, shape (s,).
    start
        ``start[b]`` is the first sample of bin b, shape (bins + 1,).
    lowest, shape
        Lowest corner of the bins in cells, and their number along each axis, shape (3,).
    """

    points: FloatArray
    normals: FloatArray
    label: IntArray
    start: IntArray
    lowest: IntArray
    shape: IntArray


class OnSamples(NamedTuple):
    """Feet of points on the planes of samples.

    Parameters
    ----------
    points, normals
        The foot of every point on the plane of its sample, and the sample's normal, shape (n, 3).
    is_found
        Whether a sample is near and faces the same way, shape (n,).
    """

    points: FloatArray
    normals: FloatArray
    is_found: BoolArray


def sort_samples(points: FloatArray, normals: FloatArray, label: IntArray | None = None) -> Bins:
    """Return samples in bins.

    Parameters
    ----------
    points, normals
        The samples, in cells, shape (s, 3) each.
    label
        Patch of each sample, shape (s,); None: all 0.
    """
    label = np.zeros(len(points), dtype=np.int64) if label is None else label
    place = np.floor(points).astype(np.int64)
    lowest = place.min(axis=0, initial=0)
    shape = place.max(axis=0, initial=0) - lowest + 1
    number = np.ravel_multi_index(tuple((place - lowest).T), tuple(shape.tolist()))
    order = np.argsort(number, kind="stable")
    start = np.searchsorted(number[order], np.arange(int(shape.prod()) + 1))
    return Bins(
        np.ascontiguousarray(points[order]),
        np.ascontiguousarray(normals[order]),
        label[order],
        start.astype(np.int64),
        lowest,
        shape,
    )


def find_samples(
    bins: Bins,
    points: FloatArray,
    normals: FloatArray,
    cap: float,
    label: IntArray | None = None,
    *,
    turn: float = TURN,
    reach: float = _ALONG,
) -> OnSamples:
    """Return the foot of every point on the plane of its nearest sample.

    Parameters
    ----------
    bins
        The samples.
    points, normals
        Points and the directions in which the boundary faces there, shape (n, 3) each.
    cap
        Largest distance to the plane, in cells.
    label
        Patch whose samples count for each point, -1 for no sample and -2 for all, shape (n,); None:
        all count.
    turn
        Weight of the difference of the normals.
    reach
        Farthest sample along its plane, in cells.
    """
    feet, found = points.copy(), normals.copy()
    is_found = np.zeros(len(points), dtype=np.bool_)
    label = np.full(len(points), -2, dtype=np.int64) if label is None else label
    _find(bins, points, normals, (cap, turn, reach), label, feet, found, is_found)
    return OnSamples(feet, found, is_found)


@numba.njit(cache=True)
def _nearest(bins, p, n, label, reach, turn):  # type: ignore[no-untyped-def]
    """Return the nearest sample within `reach` bins, and the square of its distance."""
    best, which = 1e300, -1
    shape, low = bins.shape, bins.lowest
    i0, j0, k0 = int(np.floor(p[0])), int(np.floor(p[1])), int(np.floor(p[2]))
    i0, j0, k0 = i0 - low[0], j0 - low[1], k0 - low[2]
    for i in range(max(i0 - reach, 0), min(i0 + reach + 1, shape[0])):
        for j in range(max(j0 - reach, 0), min(j0 + reach + 1, shape[1])):
            row = (i * shape[1] + j) * shape[2]
            first = max(k0 - reach, 0)
            last = min(k0 + reach + 1, shape[2])
            if first >= last:
                continue
            for s in range(bins.start[row + first], bins.start[row + last]):
                if label >= 0 and bins.label[s] != label:
                    continue
                square = 0.0
                for a in range(3):
                    square += (bins.points[s, a] - p[a]) ** 2
                    square += turn * (bins.normals[s, a] - n[a]) ** 2
                if square < best:
                    best, which = square, s
    return which, best


@numba.njit(cache=True)
def _foot(bins, p, n, limits, label, foot, normal):  # type: ignore[no-untyped-def]
    """Fill in the foot of one point; return whether it counts."""
    if label == -1:
        return False
    cap, turn, reach = limits
    which, best = _nearest(bins, p, n, label, 1, turn)
    if best > 1.0:
        which, best = _nearest(bins, p, n, label, 2, turn)
    if which < 0:
        return False
    q, m = bins.points[which], bins.normals[which]
    off, agreement = 0.0, 0.0
    for a in range(3):
        off += (p[a] - q[a]) * m[a]
        agreement += n[a] * m[a]
    along = 0.0
    for a in range(3):
        foot[a] = p[a] - off * m[a]
        normal[a] = m[a]
        along += (foot[a] - q[a]) ** 2
    least = _AGREE if label < 0 else _AGREE_IN_PATCH
    return agreement > least and along < reach * reach and abs(off) < cap


@numba.njit(cache=True, parallel=True)
def _find(bins, points, normals, limits, label, feet, found, is_found):  # type: ignore[no-untyped-def]
    for q in numba.prange(len(points)):
        is_found[q] = _foot(bins, points[q], normals[q], limits, label[q], feet[q], found[q])
