"""Move the middles of boundary edges onto a geometry, for quadratic elements."""

from __future__ import annotations

import numpy as np

from tusqh.geometry.kinds import Geometry
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.grid import BoolArray, FloatArray
from tusqh.meshes.quadratic import Mover
from tusqh.sampling.nearest_triangle import find_nearest, make_tree

#: Cosine of the angle between triangles beyond which their common edge is sharp.
_SHARP = np.cos(np.radians(30.0))


def mover_onto(geometry: Geometry) -> Mover | None:
    """Return what moves middle nodes onto a geometry; None for images, which have no surface.

    A point moves to the nearest point of the geometry; one on a sharp edge of the mesh, to the
    nearest point on a sharp edge of the geometry, if there is one that is near.

    Parameters
    ----------
    geometry
        An outline, a soup or an image.

    Examples
    --------
    >>> flat = Soup(np.eye(3), np.array([[0, 1, 2]]), np.array([0]))
    >>> move = mover_onto(flat)
    >>> places = move(np.array([[0.4, 0.4, 0.4]]), np.array([False]), np.array([1.0]))
    >>> places.round(6).tolist()
    [[0.333333, 0.333333, 0.333333]]
    """
    if isinstance(geometry, Outline):
        flat = np.zeros((len(geometry.points), 3))
        flat[:, :2] = geometry.points
        surface, edges = _as_triangles(flat[geometry.segments]), np.zeros((0, 3, 3))
    elif isinstance(geometry, Soup):
        surface, edges = geometry.points[geometry.triangles], sharp_edges(geometry)
    else:
        return None
    # Map coordinates are millions of metres; near 0 the nearest point loses no digits.
    origin = surface.mean(axis=(0, 1))
    trees = make_tree(surface - origin), make_tree(edges - origin)

    def move(points: FloatArray, is_sharp: BoolArray, far: FloatArray) -> FloatArray:
        dim = points.shape[1]
        places = np.zeros((len(points), 3))
        places[:, :dim] = points
        places -= origin
        moved = points.copy()
        for tree, rows in (
            (trees[0], np.arange(len(points))),
            (trees[1], np.flatnonzero(is_sharp)),
        ):
            found = find_nearest(tree, places[rows])
            is_near = found.distance < far[rows]
            moved[rows[is_near]] = (found.points + origin)[is_near, :dim]
        return moved

    return move


def sharp_edges(soup: Soup) -> FloatArray:
    """Return the edges of a soup between triangles at an angle, as flat triangles, shape (e, 3, 3).

    Parameters
    ----------
    soup
        The triangles; only edges of exactly two count.
    """
    points, triangles = soup.matched()
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    edges = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    keys = np.sort(edges, axis=1) @ np.array([len(points), 1])
    order = np.argsort(keys, kind="stable")
    first, counts = np.unique(keys[order], return_index=True, return_counts=True)[1:]
    pair = first[counts == 2]
    one, other = order[pair], order[pair + 1]
    is_sharp = np.abs(np.einsum("ek,ek->e", normals[one // 3], normals[other // 3])) < _SHARP
    return _as_triangles(points[edges[one[is_sharp]]])


def _as_triangles(segments: FloatArray) -> FloatArray:
    """Return segments as triangles without area."""
    return np.concatenate([segments, segments[:, 1:]], axis=1)
