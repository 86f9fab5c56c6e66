"""Pieces of the boundary of a mesh: what they enclose, their loops, and how they are joined."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.meshes.element_mesh import ElementMesh

#: Kinds of walls.
HOLE, VOID, RECESS, WALL = "hole", "void", "recess", "wall"

#: Cosine of the angle between normals beyond which an edge is sharp.
_SHARP = np.cos(np.radians(40.0))

#: Number of directions of a convex hull.
_DIRECTIONS = 1000


class Edges(NamedTuple):
    """Edges (in the plane, points) at which two facets of the boundary meet.

    Parameters
    ----------
    first, second
        The facets, shape (e,) each.
    points
        Ends, in the direction in which the first facet runs around its corners, shape (e, 2).
    """

    first: IntArray
    second: IntArray
    points: IntArray


class Shape(NamedTuple):
    """What a piece of the boundary is.

    Parameters
    ----------
    kind
        ``"hole"``, ``"void"``, ``"recess"`` or ``"wall"``.
    n_holes
        Number of holes that pass along it.
    """

    kind: str
    n_holes: int


def measure_pieces(mesh: ElementMesh, piece: IntArray, edges: Edges) -> list[Shape]:
    """Return what every piece of the boundary of hexes is, by its loops, genus and volume.

    Parameters
    ----------
    mesh
        The hexes.
    piece
        Number of the piece of every boundary facet, shape (b,).
    edges
        The edges of the boundary.
    """
    corners = mesh.boundary.corners.astype(np.int64)
    points = mesh.points - mesh.points[corners].mean(axis=(0, 1))
    n_pieces, n_points = int(piece.max(initial=-1)) + 1, len(points)
    is_border = piece[edges.first] != piece[edges.second]
    # Each border edge belongs to two pieces, which run along it in opposite directions.
    ends = edges.points[is_border]
    owner = np.concatenate([piece[edges.first[is_border]], piece[edges.second[is_border]]])
    ends = np.concatenate([ends, ends[:, ::-1]])
    keys = owner[:, None] * n_points + ends
    vertices, at = np.unique(keys, return_inverse=True)
    at = at.reshape(-1, 2)
    loop_of_vertex = components(at[:, 0], at[:, 1], len(vertices))
    loop = loop_of_vertex[at[:, 0]]
    n_loops = np.bincount(np.unique(owner * (len(vertices) + 1) + loop) // (len(vertices) + 1),
                          minlength=n_pieces)  # fmt: skip
    volume = np.bincount(piece, weights=_cones(points, corners), minlength=n_pieces)
    total = np.bincount(loop, minlength=1)
    middle = np.stack(
        [np.bincount(loop, weights=points[ends[:, 0], axis]) for axis in range(3)], axis=1
    ) if len(loop) else np.zeros((1, 3))  # fmt: skip
    middle /= np.maximum(total, 1)[:, None]
    a, b = points[ends[:, 0]], points[ends[:, 1]]
    caps = np.einsum("ek,ek->e", middle[loop], np.cross(b, a)) / 6 if len(loop) else np.zeros(0)
    volume += np.bincount(owner, weights=caps, minlength=n_pieces)
    euler = _euler(corners, piece, edges, is_border, n_points, n_pieces)
    genus = np.maximum(2 - n_loops - euler, 0) // 2
    return [_shape(*row) for row in zip(volume, n_loops.tolist(), genus.tolist(), strict=True)]


def _shape(volume: float, n_loops: int, genus: int) -> Shape:
    if n_loops == 0:
        return Shape(WALL if volume > 0 else VOID, genus)
    if volume > 0:
        return Shape(WALL, genus)
    n_holes = n_loops - 1 + genus
    return Shape(HOLE if n_holes else RECESS, n_holes)


def _euler(
    corners: IntArray,
    piece: IntArray,
    edges: Edges,
    is_border: BoolArray,
    n_points: int,
    n_pieces: int,
) -> IntArray:
    """Return the Euler characteristic of every piece, with its border."""
    used = np.unique(piece[:, None] * n_points + corners) // n_points
    n_edges = np.bincount(piece[edges.first], minlength=n_pieces)
    n_edges += np.bincount(piece[edges.second[is_border]], minlength=n_pieces)
    n_facets = np.bincount(piece, minlength=n_pieces)
    return np.asarray(np.bincount(used, minlength=n_pieces) - n_edges + n_facets)


def _cones(points: FloatArray, corners: IntArray) -> FloatArray:
    """Return the volume of the cone from the origin over every face, which may be bent."""
    a, b, c, d = points[corners].transpose(1, 0, 2)
    halves = [(a, b, c), (a, c, d), (a, b, d), (b, c, d)]
    return np.asarray(
        sum(np.einsum("fk,fk->f", x, np.cross(y, z)) for x, y, z in halves) / 12, dtype=np.float64
    )


def are_sharp(points: FloatArray, corners: IntArray, edges: Edges) -> BoolArray:
    """Return whether the boundary is sharp and convex at every edge, shape (e,).

    Parameters
    ----------
    points
        Coordinates, shape (n, dim).
    corners
        Corners of the boundary facets, shape (b, 2**(dim - 1)).
    edges
        The edges of the boundary.
    """
    places = points[corners]
    if corners.shape[1] == 2:
        along = places[:, 1] - places[:, 0]
        normals = np.stack([along[:, 1], -along[:, 0]], axis=1)
    else:
        normals = np.cross(places[:, 2] - places[:, 0], places[:, 3] - places[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    centre = places.mean(axis=1)
    one, other = normals[edges.first], normals[edges.second]
    to_other = centre[edges.second] - centre[edges.first]
    is_convex = np.einsum("ek,ek->e", one - other, to_other) < 0
    return np.asarray(is_convex & (np.einsum("ek,ek->e", one, other) < _SHARP))


def find_edges(corners: IntArray) -> Edges:
    """Return the pairs of boundary facets that share an edge (in the plane, a point).

    Parameters
    ----------
    corners
        Corners of the boundary facets, shape (b, 2**(dim - 1)).
    """
    size = corners.shape[1]
    if size == 2:
        parts = corners.reshape(-1, 1)
        directed = np.repeat(parts, 2, axis=1)
    else:
        directed = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
        parts = np.sort(directed, axis=1)
    order = np.lexsort(parts.T[::-1])
    sorted_parts = parts[order]
    same = np.flatnonzero((sorted_parts[1:] == sorted_parts[:-1]).all(axis=1))
    first, second = order[same], order[same + 1]
    return Edges(first // size, second // size, directed[first].astype(np.int64))


def components(first: IntArray, second: IntArray, n: int) -> IntArray:
    """Return the component of every node of a graph, numbered in the order of the nodes.

    Parameters
    ----------
    first, second
        Ends of the edges of the graph, shape (e,) each.
    n
        Number of its nodes.

    Examples
    --------
    >>> components(np.array([2]), np.array([3]), 4).tolist()
    [0, 1, 2, 2]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(first)), (first, second)), shape=(n, n))
    label = connected_components(graph, directed=False)[1]
    _, at, inverse = np.unique(label, return_index=True, return_inverse=True)
    number = np.empty(len(at), dtype=np.int64)
    number[np.argsort(at, kind="stable")] = np.arange(len(at))
    return np.asarray(number[inverse], dtype=np.int64)


def groups_of(label: IntArray, chosen: IntArray) -> list[IntArray]:
    """Return the chosen rows of every label, by label.

    Parameters
    ----------
    label
        Label of every row, shape (n,).
    chosen
        The rows to divide, ascending, shape (r,).

    Examples
    --------
    >>> [rows.tolist() for rows in groups_of(np.array([1, 0, 1, 2]), np.array([0, 1, 2]))]
    [[1], [0, 2]]
    """
    if len(chosen) == 0:
        return []
    order = chosen[np.argsort(label[chosen], kind="stable")]
    return np.split(order, np.flatnonzero(np.diff(label[order])) + 1)


def depths_in_hull(points: FloatArray, chosen: IntArray) -> FloatArray:
    """Return how deep points lie in the convex hull of some of them, shape (n,).

    The hull is that of many directions, so that smooth parts of it are not exact.

    Parameters
    ----------
    points
        The points, shape (n, 3).
    chosen
        The points whose hull it is, shape (r,).

    Examples
    --------
    >>> cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    >>> depth = depths_in_hull(np.vstack([cube, [[0, 0, 0]]]).astype(float), np.arange(8))
    >>> bool(depth[:8].max() < 1e-12), bool(depth[8] > 0.99)
    (True, True)
    """
    k = np.arange(_DIRECTIONS) + 0.5
    height, angle = 1 - 2 * k / _DIRECTIONS, k * np.pi * (3 - np.sqrt(5))
    radius = np.sqrt(1 - height**2)
    rays = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), height])
    rays = np.concatenate([rays, np.eye(3), -np.eye(3)])
    middle = points[chosen].mean(axis=0)
    depth = np.full(len(points), np.inf)
    for ray in rays:
        along = (points - middle) @ ray
        np.minimum(depth, along[chosen].max() - along, out=depth)
    return depth


def rounded_places(points: FloatArray, places: FloatArray) -> IntArray:
    """Return places in millionths of the extent of a mesh, which rounding errors do not change.

    Parameters
    ----------
    points
        Points of the mesh, shape (n, dim).
    places
        The places, shape (r, dim).
    """
    low = points.min(axis=0)
    extent = max(float((points.max(axis=0) - low).max()), 1e-300)
    # The offset keeps planes of grids away from the ends of the intervals.
    return np.asarray(np.floor((places - low) / extent * 1e6 + 0.3183), dtype=np.int64)


def lowest_place(places: IntArray) -> tuple[int, ...]:
    """Return the first of some places, by x, then y, then z.

    Parameters
    ----------
    places
        The places, shape (r, dim).

    Returns
    -------
    tuple of int
        The place, of length dim.
    """
    return tuple(places[np.lexsort(places.T[::-1])[0]].tolist())
