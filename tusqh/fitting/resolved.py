"""Which parts of the trusted surface a grid resolves, and which places lie beyond its end.

Where a wall or a gap is thinner than a cell, a mesh of that grid cannot have both of its sides.
Beyond the end of an open surface, as in its holes, there is nothing to which a boundary could be
near.  Both are found from the surface alone, not from the mesh that was fitted to it.
"""

from __future__ import annotations

import numba
import numpy as np
from scipy.ndimage import maximum_filter, minimum_filter
from scipy.spatial import cKDTree

from tusqh.fitting.nearest_sample import Bins, sort_samples
from tusqh.fitting.pieces import in_space, normals_of
from tusqh.fitting.target import Target
from tusqh.grid import BoolArray, FloatArray
from tusqh.sampling.nearest_triangle import NearestPoints

#: Walls and gaps thinner than this are not resolved, and neither is what lies this near them, such
#: as their rims; in cells.
_THIN, _BESIDE = 1.0, 0.5
#: Cosine of the normals of two sides of a wall at most, and of the way between them at least.
_OPPOSED, _ACROSS = -0.3, 0.7
#: A place lies beyond a surface by at least this, in cells and as a share of its distance.
_BEYOND, _SHARE = 0.1, 0.3
#: Farther from the surface than this nothing attracts a boundary, in cells.
_REACH = 1.25
#: How far around the end samples are looked for, and how far beyond it one continues the surface;
#: in cells.
_AROUND, _ONWARDS = 1.0, 0.15
#: Cosine above which a normal faces along the way beyond the end, as behind a crease.
_FACES = 0.3


def find_resolved(target: Target) -> BoolArray:
    """Return which samples lie on walls and beside gaps of at least a cell, shape (s,).

    Parameters
    ----------
    target
        The target.
    """
    points, normals = in_space(target.points), in_space(target.normals)
    is_thin = np.zeros(len(points), dtype=np.bool_)
    if len(points) == 0:
        return ~is_thin
    _find_thin(_bins(target), points, normals, is_thin)
    if not is_thin.any():
        return ~is_thin
    away = cKDTree(points[is_thin]).query(points, distance_upper_bound=_BESIDE)[0]
    return np.asarray(~np.isfinite(away))


def find_beyond(target: Target, places: FloatArray, nearest: NearestPoints) -> BoolArray:
    """Return which places of a boundary lie where no trusted surface is, shape (n,).

    Such a place lies beyond the end of the surface, which does not continue at the nearest point:
    neither straight on, nor around a crease, nor back on the other side of a wall.  Or it is far
    from any trusted piece, and near the points where the volume fraction is 1/2.

    Parameters
    ----------
    target
        The target.
    places
        Places in cells, shape (n, dim).
    nearest
        Their nearest points on the pieces of the target.
    """
    if len(target.points) == 0:
        return np.ones(len(places), dtype=np.bool_)
    normals = normals_of(target.pieces)
    side = (normals * target.normals[target.sample]).sum(axis=1)
    normals = in_space(np.where(side[:, None] < 0, -normals, normals))[nearest.triangle]
    off = in_space(places) - nearest.points
    along = off - (off * normals).sum(axis=1)[:, None] * normals
    length = np.linalg.norm(along, axis=1)
    is_beyond = length > np.maximum(_BEYOND, _SHARE * nearest.distance)
    rows = np.flatnonzero(is_beyond)
    ways = along[rows] / length[rows, None]
    found = np.zeros(len(rows), dtype=np.bool_)
    _find_ends(_bins(target), nearest.points[rows], normals[rows], ways, found)
    is_beyond[rows] = found
    return np.asarray(is_beyond | (nearest.distance > _REACH) & _is_on_level(target, places))


def _is_on_level(target: Target, places: FloatArray) -> BoolArray:
    """Return whether the fraction passes 1/2 within half a cell of places, shape (n,)."""
    node = np.clip(np.rint(2 * places).astype(np.int64), 0, np.array(target.level.shape) - 1)
    least, most = (f(target.level, 3)[tuple(node.T)] for f in (minimum_filter, maximum_filter))
    return np.asarray((least < 0.5) & (most >= 0.5))


def _bins(target: Target) -> Bins:
    """Return the samples in bins of one cell."""
    return sort_samples(in_space(target.points), in_space(target.normals))


@numba.njit(cache=True)
def _span(bins, p, axis):  # type: ignore[no-untyped-def]
    """Return the first bin along an axis beside a place, and the one after the last."""
    at = int(np.floor(p[axis])) - bins.lowest[axis]
    return max(at - 1, 0), min(at + 2, bins.shape[axis])


@numba.njit(cache=True)
def _is_thin(bins, p, n):  # type: ignore[no-untyped-def]
    """Return whether a sample that faces the other way lies across from a place."""
    first, last = _span(bins, p, 2)
    if first >= last:
        return False
    for i in range(*_span(bins, p, 0)):
        for j in range(*_span(bins, p, 1)):
            row = (i * bins.shape[1] + j) * bins.shape[2]
            for s in range(bins.start[row + first], bins.start[row + last]):
                square, along, back, agreement = 0.0, 0.0, 0.0, 0.0
                for a in range(3):
                    off = bins.points[s, a] - p[a]
                    square += off * off
                    along += off * n[a]
                    back += off * bins.normals[s, a]
                    agreement += n[a] * bins.normals[s, a]
                if agreement > _OPPOSED or square > _THIN * _THIN:
                    continue
                least = _ACROSS * np.sqrt(square)
                if abs(along) > least and abs(back) > least:
                    return True
    return False


@numba.njit(cache=True, parallel=True)
def _find_thin(bins, points, normals, is_thin):  # type: ignore[no-untyped-def]
    for q in numba.prange(len(points)):
        is_thin[q] = _is_thin(bins, points[q], normals[q])


@numba.njit(cache=True)
def _is_end(bins, p, n, way):  # type: ignore[no-untyped-def]
    """Return whether no sample around a point of the surface continues it along a way."""
    first, last = _span(bins, p, 2)
    if first >= last:
        return True
    for i in range(*_span(bins, p, 0)):
        for j in range(*_span(bins, p, 1)):
            row = (i * bins.shape[1] + j) * bins.shape[2]
            for s in range(bins.start[row + first], bins.start[row + last]):
                square, onwards, faces, agreement = 0.0, 0.0, 0.0, 0.0
                for a in range(3):
                    off = bins.points[s, a] - p[a]
                    square += off * off
                    onwards += off * way[a]
                    faces += bins.normals[s, a] * way[a]
                    agreement += bins.normals[s, a] * n[a]
                if square > _AROUND * _AROUND:
                    continue
                if onwards > _ONWARDS or abs(faces) > _FACES or agreement < _OPPOSED:
                    return False
    return True


@numba.njit(cache=True, parallel=True)
def _find_ends(bins, points, normals, ways, is_end):  # type: ignore[no-untyped-def]
    for q in numba.prange(len(points)):
        is_end[q] = _is_end(bins, points[q], normals[q], ways[q])
