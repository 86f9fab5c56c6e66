"""Smooth patches of a surface, and one patch for every boundary facet.

Two samples belong to one patch if they are near, face nearly the same way and lie nearly in each
other's plane.  No edge of the input matters, so creases that are doubled, gapped or only the
crossing of two parts are all alike.  The borders of the facets' patches are the feature edges.
"""

from __future__ import annotations

import numba
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tusqh.fitting.nearest_sample import Bins
from tusqh.fitting.pieces import sizes_of
from tusqh.fitting.skin import Skin, unit
from tusqh.fitting.target import Target
from tusqh.grid import BoolArray, FloatArray, IntArray

#: Samples of a patch are linked over at most this length, in cells.
_LINK = 0.7
#: Smallest patch that counts, in cells squared.
LEAST_AREA = 12.0
#: Cost of an edge between facets of different patches, and of a facet without a patch.
_BORDER, _FREE = 0.25, 2.0
#: Farthest sample of a patch from a facet, in cells, and most patches that are tried for one.
_FAR, _TRIED = 1.6, 6
#: Distance between samples, which does not count as lying beyond the end of a patch, in cells.
_SPACING = 0.2


def find_patches(target: Target, angle: float) -> IntArray:
    """Return the smooth patch of every sample, -1 for small ones, shape (s,).

    Parameters
    ----------
    target
        The target.
    angle
        Largest angle between the normals of neighbours of a patch, in degrees.
    """
    number, area = link_samples(target, angle)
    name = np.where(area >= LEAST_AREA, np.cumsum(area >= LEAST_AREA) - 1, -1)
    return np.asarray(name[number], dtype=np.int64)


def link_samples(target: Target, angle: float) -> tuple[IntArray, FloatArray]:
    """Return the smooth patch of every sample, of any size, and the areas of the patches.

    Parameters
    ----------
    target, angle
        See `find_patches`.

    Returns
    -------
    number
        The patch of every sample, shape (s,).
    area
        The area of every patch, in cells squared, shape (patches,).
    """
    points, normals = target.points, target.normals
    if len(points) == 0:
        return np.zeros(0, dtype=np.int64), np.zeros(0)
    pairs = cKDTree(points).query_pairs(_LINK, output_type="ndarray")
    i, j = pairs.T
    away = points[j] - points[i]
    off = np.abs(np.einsum("pk,pk->p", away, normals[i] + normals[j])) / 2
    is_flat = off < 0.3 * np.linalg.norm(away, axis=1) + 0.02
    agree = np.einsum("pk,pk->p", normals[i], normals[j]) > np.cos(np.radians(angle))
    links = pairs[is_flat & agree]
    graph = coo_array((np.ones(len(links)), tuple(links.T)), shape=(len(points),) * 2)
    number = connected_components(graph, directed=False)[1]
    areas = sizes_of(target.pieces)
    area = np.bincount(number[target.sample], weights=areas, minlength=int(number.max()) + 1)
    return number.astype(np.int64), np.asarray(area, dtype=np.float64)


def label_facets(bins: Bins, skin: Skin, places: FloatArray, is_owned: BoolArray) -> IntArray:
    """Return the patch of every boundary facet, -1 for none, shape (f,).

    The sum of the distances of facets to their patches, and of the length of the borders between
    patches, is small: each facet in turn takes its cheapest patch until nothing changes.

    Parameters
    ----------
    bins
        The samples with their patches.
    skin
        The boundary.
    places
        Places of its vertices, shape (b, 3).
    is_owned
        Facets that may have a patch, shape (f,).
    """
    across = neighbours_of(skin) // 4
    normals = skin.normals(places)[1]
    for _ in range(3):
        normals = unit(normals + normals[across].sum(axis=1))
    centre = places[skin.facets].mean(axis=1)
    tried = np.full((len(centre), _TRIED + 1), -9, dtype=np.int64)
    cost = np.full((len(centre), _TRIED + 1), 1e9)
    _try_patches(bins, centre, normals, tried, cost)
    cost[cost[:, :_TRIED].min(axis=1) > 1e8, 0] = 1e9
    tried[:, _TRIED], cost[:, _TRIED] = -1, _FREE
    cost[~is_owned, _TRIED] = -1e9
    label: IntArray = tried[np.arange(len(centre)), cost.argmin(axis=1)]
    _settle(label, tried, cost, across)
    return label


def neighbours_of(skin: Skin) -> IntArray:
    """Return what lies across each edge of each facet, as ``4 * facet + edge``, shape (f, 4).

    Parameters
    ----------
    skin
        The boundary of a manifold.
    """
    ends = np.stack([skin.facets, np.roll(skin.facets, -1, axis=1)], axis=-1).reshape(-1, 2)
    ends = np.sort(ends, axis=1)
    order = np.argsort(ends[:, 0] * skin.n_vertices + ends[:, 1], kind="stable")
    across = np.empty(len(order), dtype=np.int64)
    across[order[0::2]], across[order[1::2]] = order[1::2], order[0::2]
    return across.reshape(-1, 4)


@numba.njit(cache=True)
def _try_one(bins, p, m, tried, cost):  # type: ignore[no-untyped-def]
    """Fill in the patches near a facet and what each would cost."""
    nearest = np.full(_TRIED, 1e300)
    which = np.full(_TRIED, -1)
    n_tried = 0
    shape, low = bins.shape, bins.lowest
    at = (int(np.floor(p[0])) - low[0], int(np.floor(p[1])) - low[1], int(np.floor(p[2])) - low[2])
    for i in range(max(at[0] - 2, 0), min(at[0] + 3, shape[0])):
        for j in range(max(at[1] - 2, 0), min(at[1] + 3, shape[1])):
            row = (i * shape[1] + j) * shape[2]
            first, last = max(at[2] - 2, 0), min(at[2] + 3, shape[2])
            if first >= last:
                continue
            for s in range(bins.start[row + first], bins.start[row + last]):
                label = bins.label[s]
                if label < 0:
                    continue
                square = 0.0
                for a in range(3):
                    square += (bins.points[s, a] - p[a]) ** 2
                if square > _FAR * _FAR:
                    continue
                k = 0
                while k < n_tried and tried[k] != label:
                    k += 1
                if k == _TRIED:
                    continue
                if k == n_tried:
                    n_tried += 1
                    tried[k] = label
                if square < nearest[k]:
                    nearest[k], which[k] = square, s
    for k in range(n_tried):
        off, agreement = 0.0, 0.0
        for a in range(3):
            off += (p[a] - bins.points[which[k], a]) * bins.normals[which[k], a]
            agreement += m[a] * bins.normals[which[k], a]
        beyond = max(0.0, np.sqrt(max(nearest[k] - off * off, 0.0)) - _SPACING)
        cost[k] = off * off + 2 * beyond * beyond + 3 * max(0.0, 0.2 - agreement)
        if agreement < -0.7:
            cost[k] = 1e9


@numba.njit(cache=True, parallel=True)
def _try_patches(bins, centre, normals, tried, cost):  # type: ignore[no-untyped-def]
    for f in numba.prange(len(centre)):
        _try_one(bins, centre[f], normals[f], tried[f], cost[f])


@numba.njit(cache=True)
def _settle(label, tried, cost, across):  # type: ignore[no-untyped-def]
    """Let each facet take its cheapest patch, until nothing changes."""
    for _ in range(50):
        is_changed = False
        for f in range(len(label)):
            best, chosen = 1e300, label[f]
            for k in range(tried.shape[1]):
                if tried[f, k] == -9:
                    continue
                total = cost[f, k]
                for e in range(4):
                    if label[across[f, e]] != tried[f, k]:
                        total += _BORDER
                if total < best - 1e-12:
                    best, chosen = total, tried[f, k]
            if chosen != label[f]:
                label[f], is_changed = chosen, True
        if not is_changed:
            return
