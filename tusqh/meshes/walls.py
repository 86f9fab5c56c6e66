"""Divide the boundary of a mesh into walls: of each hole, of each void, and the rest.

The boundary without the planes of the mesh's box falls into connected pieces; on meshes whose
boundary is smooth, sharp convex edges cut it too.  A piece is closed by a cone over each of its
border loops.  If that encloses space outside the material, the piece is the wall of a void (no
loops), of a recess (one loop) or of a hole (two loops or more).  Pieces of holes that share a loop
are one wall.  In the plane, every inner loop of the boundary is the wall of a hole.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.meshes.boundary import SIDES
from tusqh.meshes.element_mesh import ElementMesh
from tusqh.meshes.interfaces import facet_areas

#: Kinds of walls.
HOLE, VOID, RECESS, WALL = "hole", "void", "recess", "wall"

#: Number of sides of the boundary that lie on planes of the box, see `tusqh.meshes.boundary`.
_N_PLANES = 6

#: Twice the largest deviation of a piece of a smooth boundary from a plane, and half the largest
#: distance from a plane of the box, in sides of facets.
_NEARLY_FLAT = 0.1

#: Cosine of the angle between normals beyond which an edge is sharp.
_SHARP = np.cos(np.radians(40.0))


class Wall(NamedTuple):
    """A connected piece of the boundary.

    Parameters
    ----------
    kind
        ``"hole"``, ``"void"``, ``"recess"`` or ``"wall"``.
    rows
        Its facets, as rows of the boundary, ascending, shape (r,).
    n_holes
        Number of holes of the material that pass along it.
    """

    kind: str
    rows: IntArray
    n_holes: int


class Division(NamedTuple):
    """The boundary of a mesh, divided.

    Parameters
    ----------
    attribute
        Side of every facet as in `tusqh.meshes.boundary.Boundary`; on a smooth boundary, flat
        pieces at a plane of the box are on that plane, shape (b,).
    walls
        The rest of the boundary.
    """

    attribute: IntArray
    walls: list[Wall]


class _Edges(NamedTuple):
    """Edges at which two facets of the boundary meet."""

    first: IntArray
    second: IntArray
    points: IntArray  # In the direction in which `first` runs around its corners.


def divide_boundary(mesh: ElementMesh, *, is_smooth: bool = False) -> Division:
    """Return the planes of the box and the walls, by kind and from the largest to the smallest.

    Parameters
    ----------
    mesh
        The mesh, whose boundary is a manifold.
    is_smooth
        Whether the boundary was fitted, so that its sharp edges are edges of the geometry.

    Examples
    --------
    >>> from tusqh.meshes.volume_mesh import VolumeMesh
    >>> points = np.array([[x, y] for x in range(4) for y in range(4)], dtype=float)
    >>> corners = [[i * 4 + j, i * 4 + j + 4, i * 4 + j + 5, i * 4 + j + 1]
    ...            for i in range(3) for j in range(3) if (i, j) != (1, 1)]
    >>> frame = VolumeMesh.from_arrays(points, corners)
    >>> [(wall.kind, len(wall.rows), wall.n_holes) for wall in divide_boundary(frame).walls]
    [('hole', 4, 1)]
    """
    corners = mesh.boundary.corners
    edges = _edges(corners)
    loop = _components(edges.first, edges.second, len(corners))
    is_inner = np.zeros(len(corners), dtype=np.bool_)
    if mesh.dim == 2:
        a, b = mesh.points[corners[:, 0]], mesh.points[corners[:, 1]]
        area = np.bincount(loop, weights=(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2)
        is_inner = (area < 0)[loop]
    attribute = mesh.boundary.attribute
    may_cut = ~is_inner[edges.first]
    is_cut = np.zeros(len(may_cut), dtype=np.bool_)
    if is_smooth:
        is_cut = _is_sharp(mesh.points, corners, edges) & may_cut
        whole = _components(edges.first[~is_cut], edges.second[~is_cut], len(corners))
        attribute = _planes_of_pieces(mesh, whole)
    is_free = (attribute > _N_PLANES) | is_inner
    is_cut |= ~(is_free[edges.first] & is_free[edges.second])
    piece = _components(edges.first[~is_cut], edges.second[~is_cut], len(corners))
    if mesh.dim == 2:
        shapes = _shapes_of_loops(piece, is_inner)
    else:
        shapes = _measure_pieces(mesh, piece, edges)
    walls = _collect(piece, shapes, edges, is_free)
    return Division(attribute, _sorted_walls(walls, facet_areas(mesh.points, corners)))


def boundary_components(mesh: ElementMesh) -> IntArray:
    """Return the connected component of every boundary facet, shape (b,).

    Parameters
    ----------
    mesh
        The mesh.
    """
    edges = _edges(mesh.boundary.corners)
    return _components(edges.first, edges.second, len(mesh.boundary.corners))


def _planes_of_pieces(mesh: ElementMesh, piece: IntArray) -> IntArray:
    """Return the side of every facet, where a flat piece at a plane of the box is on that plane."""
    boundary = mesh.boundary
    places = mesh.points[boundary.corners]
    size = np.sqrt(facet_areas(mesh.points, boundary.corners).mean())
    tolerance = _NEARLY_FLAT * (size if mesh.dim == 3 else size**2)
    attribute = np.where(boundary.attribute <= _N_PLANES, len(SIDES), boundary.attribute)
    n_pieces = int(piece.max(initial=-1)) + 1
    count = np.bincount(piece, minlength=n_pieces)
    for axis in range(mesh.dim):
        for side, sign in enumerate((-1, 1)):
            away = sign * places[..., axis]
            below = (away.max(initial=-np.inf) - away).mean(axis=1)
            mean = np.bincount(piece, weights=below, minlength=n_pieces) / count
            square = np.bincount(piece, weights=below**2, minlength=n_pieces) / count
            is_flat = square - mean**2 < (tolerance / 2) ** 2
            is_plane = is_flat & (mean < 2 * tolerance)
            attribute[is_plane[piece]] = 2 * axis + side + 1
    return attribute


def _shapes_of_loops(piece: IntArray, is_inner: BoolArray) -> list[_Shape]:
    """Return what every piece of the boundary of quads is."""
    inner = np.zeros(int(piece.max(initial=-1)) + 1, dtype=np.bool_)
    inner[piece] = is_inner
    return [_Shape(HOLE, 1) if found else _Shape(WALL, 0) for found in inner.tolist()]


def _collect(
    piece: IntArray, shapes: list[_Shape], edges: _Edges, is_free: BoolArray
) -> list[Wall]:
    """Return the walls; the pieces of one hole that meet at a sharp edge are one."""
    kind = np.array([shape.kind for shape in shapes])
    ends = piece[edges.first], piece[edges.second]
    both = is_free[edges.first] & is_free[edges.second] & (ends[0] != ends[1])
    both &= (kind[ends[0]] == HOLE) & (kind[ends[1]] == HOLE)
    merged = _components(ends[0][both], ends[1][both], len(shapes))
    found = []
    for rows in groups_of(merged[piece], np.flatnonzero(is_free)):
        n_holes = max(shapes[k].n_holes for k in np.unique(piece[rows]).tolist())
        found.append(Wall(str(kind[piece[rows[0]]]), rows, n_holes))
    return found


def _sorted_walls(walls: list[Wall], areas: FloatArray) -> list[Wall]:
    order = (HOLE, VOID, RECESS, WALL)
    digits = 9 - int(np.floor(np.log10(max(float(areas.sum()), 1e-300))))
    keys = [
        (order.index(wall.kind), -round(float(areas[wall.rows].sum()), digits), int(wall.rows[0]))
        for wall in walls
    ]
    return [walls[k] for k in sorted(range(len(walls)), key=keys.__getitem__)]


class _Shape(NamedTuple):
    """What a piece of the boundary of hexes is."""

    kind: str
    n_holes: int


def _measure_pieces(mesh: ElementMesh, piece: IntArray, edges: _Edges) -> list[_Shape]:
    """Return what every piece is, by its loops, its genus and what it encloses."""
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
    loop_of_vertex = _components(at[:, 0], at[:, 1], len(vertices))
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


def _shape(volume: float, n_loops: int, genus: int) -> _Shape:
    if n_loops == 0:
        return _Shape(WALL if volume > 0 else VOID, genus)
    if volume > 0:
        return _Shape(WALL, genus)
    n_holes = n_loops - 1 + genus
    return _Shape(HOLE if n_holes else RECESS, n_holes)


def _euler(
    corners: IntArray,
    piece: IntArray,
    edges: _Edges,
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


def _is_sharp(points: FloatArray, corners: IntArray, edges: _Edges) -> BoolArray:
    """Return whether the boundary is sharp and convex at an edge."""
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


def _edges(corners: IntArray) -> _Edges:
    """Return the pairs of boundary facets that share an edge (in the plane, a point)."""
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
    return _Edges(first // size, second // size, directed[first].astype(np.int64))


def _components(first: IntArray, second: IntArray, n: int) -> IntArray:
    """Return the component of every node of a graph, numbered in the order of the nodes."""
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
