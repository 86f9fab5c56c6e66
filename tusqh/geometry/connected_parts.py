"""Connected parts of a soup, and the triangles that disagree with their neighbours.

A *patch* is a set of triangles joined across edges of exactly two triangles.  A patch without a
boundary is a part by itself; patches with a boundary form one part if their bounding boxes touch,
because gaps may separate patches of the same part.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tusqh.geometry.boundary_chain import match_points
from tusqh.geometry.soup import Soup
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.grid.components import label_components

#: If there are more open patches than this, all of them form one part.
_MOST_OPEN_PATCHES = 3000


class ConnectedParts(NamedTuple):
    """The parts of a soup.

    Parameters
    ----------
    part
        Part of every triangle, shape (m,); -1 for triangles with coinciding corners.
    is_reversed
        Whether each triangle disagrees with the majority, by area, of its patch, shape (m,).
    volumes
        Signed volume of every part once its triangles agree, in model units^3, shape (n,).
    areas
        Area of every part, in model units^2, shape (n,).
    is_closed
        Whether each part is without a boundary, shape (n,).
    lower, upper
        Bounding box of every part, shape (n, 3).
    n_disagreeing
        Edges whose triangles disagree on patches that cannot be oriented (Moebius strips).
    """

    part: IntArray
    is_reversed: BoolArray
    volumes: FloatArray
    areas: FloatArray
    is_closed: BoolArray
    lower: FloatArray
    upper: FloatArray
    n_disagreeing: int


def find_parts(soup: Soup) -> ConnectedParts:
    """Return the connected parts of a soup.

    Parameters
    ----------
    soup
        The soup; points with equal coordinates are merged.

    Returns
    -------
    ConnectedParts
        The parts, numbered from 0.
    """
    points, triangles = soup.matched()
    proper = np.flatnonzero((triangles != np.roll(triangles, 1, axis=1)).all(axis=1))
    if len(proper) == 0:
        nowhere = np.full(len(triangles), -1, dtype=np.int64)
        agree = np.zeros(len(triangles), dtype=np.bool_)
        is_closed = np.empty(0, dtype=np.bool_)
        none, no_boxes = np.empty(0), np.empty((0, 3))
        return ConnectedParts(nowhere, agree, none, none, is_closed, no_boxes, no_boxes, 0)
    chosen = triangles[proper]
    edge, is_forward = _edges(chosen, len(points))
    first, second = _neighbours(edge, soup.parts[proper])
    disagrees = is_forward[first] == is_forward[second]
    links = first // 3, second // 3
    corners = points[chosen]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    patch, _ = label_components(*links, len(chosen))
    reversed_, is_twisted = _reversed_triangles(links, disagrees, patch, area / 2)
    is_open = _open_patches(patch, edge, is_forward ^ np.repeat(reversed_, 3))
    part = _join_open(patch, is_open, corners)[patch]
    lower, upper = _boxes(part, corners)
    centred = corners - ((lower + upper) / 2)[part][:, None]
    triple = np.einsum("mi,mi->m", centred[:, 0], np.cross(centred[:, 1], centred[:, 2]))
    part_of_all = np.full(len(triangles), -1, dtype=np.int64)
    part_of_all[proper] = part
    reversed_of_all = np.zeros(len(triangles), dtype=np.bool_)
    reversed_of_all[proper] = reversed_
    return ConnectedParts(
        part=part_of_all,
        is_reversed=reversed_of_all,
        volumes=_sums(part, np.where(reversed_, -triple, triple) / 6),
        areas=_sums(part, area / 2),
        is_closed=_sums(part, is_open[patch]) == 0,
        lower=lower,
        upper=upper,
        n_disagreeing=int((disagrees & is_twisted[patch[links[0]]]).sum()),
    )


def are_apart(points: FloatArray, triangles: IntArray, group: IntArray) -> bool:
    """Return whether no edge of a surface lies between triangles of two groups.

    That is so if the groups alone have no more open edges than all of them together.

    Parameters
    ----------
    points
        Coordinates, shape (n, 3); points with equal coordinates are merged.
    triangles
        Corners of every triangle, shape (m, 3).
    group
        Group of every triangle, shape (m,).

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> triangles = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> both = np.concatenate([triangles, triangles])
    >>> are_apart(points, both, np.repeat([0, 1], 4)), are_apart(points, both, np.arange(8) % 2)
    (True, False)
    """
    if len(triangles) == 0:
        return True
    points, number = match_points(points)
    edge, is_forward = _edges(number[triangles], len(points))
    key = np.repeat(group, 3) * (int(edge.max()) + 1) + edge
    alone = np.unique(key, return_inverse=True)[1].ravel()
    sign = np.where(is_forward, 1, -1)
    n_open = [np.abs(np.bincount(k, weights=sign)).sum() for k in (edge, alone)]
    return bool(n_open[0] == n_open[1])


def _sums(group: IntArray, values: FloatArray | BoolArray) -> FloatArray:
    """Return the sum of values over every group."""
    return np.bincount(group, weights=values).astype(np.float64)


def _edges(triangles: IntArray, n_points: int) -> tuple[IntArray, BoolArray]:
    """Return the edge of side 3 t + k, and whether the side starts at the edge's lower point."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    key = np.minimum(start, end) * n_points + np.maximum(start, end)
    return np.unique(key, return_inverse=True)[1].ravel(), np.asarray(start < end)


def _neighbours(edge: IntArray, part_of_file: IntArray) -> tuple[IntArray, IntArray]:
    """Return the pairs of sides that are the only two at an edge, in the file or in one part."""
    count = np.bincount(edge)[edge]
    part = np.where(count == 2, 0, np.repeat(part_of_file, 3))
    order = np.lexsort((part, edge))
    e, p = edge[order], part[order]
    begins = np.flatnonzero(np.r_[True, (e[1:] != e[:-1]) | (p[1:] != p[:-1])][: len(e)])
    lengths = np.diff(np.r_[begins, len(e)])
    pairs = begins[lengths == 2]
    return order[pairs], order[pairs + 1]


def _reversed_triangles(
    links: tuple[IntArray, IntArray], disagrees: BoolArray, patch: IntArray, area: FloatArray
) -> tuple[BoolArray, BoolArray]:
    """Return the triangles opposite to their patch's majority, and the non-orientable patches.

    In the graph every triangle has two nodes, one for each face; its components are the faces of
    the patches, and an orientable patch has two of them.
    """
    n, n_patches = len(patch), int(patch.max(initial=-1)) + 1
    if not disagrees.any():
        return np.zeros(n, dtype=np.bool_), np.zeros(n_patches, dtype=np.bool_)
    a, b = links
    other = np.where(disagrees, b + n, b)
    opposite = np.where(disagrees, b, b + n)
    side, _ = label_components(np.r_[a, a + n], np.r_[other, opposite], 2 * n)
    front, back = side[:n], side[n:]
    is_twisted = np.bincount(patch, weights=front == back, minlength=n_patches) > 0
    is_second = front > back
    second_area = np.bincount(patch, weights=area * is_second, minlength=n_patches)
    swap = second_area > np.bincount(patch, weights=area, minlength=n_patches) / 2
    return (is_second ^ swap[patch]) & ~is_twisted[patch], is_twisted


def _open_patches(patch: IntArray, edge: IntArray, is_forward: BoolArray) -> BoolArray:
    """Return whether a patch has an edge that it traverses more often in one direction."""
    n_edges = int(edge.max(initial=-1)) + 1
    key = np.repeat(patch, 3) * n_edges + edge
    unique, number = np.unique(key, return_inverse=True)
    balance = np.bincount(number.ravel(), weights=np.where(is_forward, 1, -1))
    n_patches = int(patch.max(initial=-1)) + 1
    return np.bincount(unique // max(n_edges, 1), weights=balance != 0, minlength=n_patches) > 0


def _boxes(group: IntArray, corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the bounding box of every group of triangles."""
    n = int(group.max(initial=-1)) + 1
    lower, upper = np.full((n, 3), np.inf), np.full((n, 3), -np.inf)
    np.minimum.at(lower, group, corners.min(axis=1))
    np.maximum.at(upper, group, corners.max(axis=1))
    return lower, upper


def _join_open(patch: IntArray, is_open: BoolArray, corners: FloatArray) -> IntArray:
    """Return the part of every patch."""
    opened = np.flatnonzero(is_open)
    first = second = np.empty(0, dtype=np.int64)
    if len(opened) > _MOST_OPEN_PATCHES:
        first, second = opened[:-1], opened[1:]
    elif len(opened) > 1:
        lower, upper = (box[opened] for box in _boxes(patch, corners))
        meets = np.ones((len(opened), len(opened)), dtype=np.bool_)
        for k in range(3):
            meets &= lower[:, None, k] <= upper[None, :, k]
        meets &= meets.T
        rows, columns = np.nonzero(np.triu(meets, 1))
        first, second = opened[rows], opened[columns]
    return label_components(first, second, len(is_open))[0]
