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

from tusqh.grid import BoolArray, IntArray
from tusqh.meshes.boundary import SIDES
from tusqh.meshes.boundary_pieces import (
    HOLE,
    RECESS,
    VOID,
    WALL,
    Edges,
    Shape,
    are_sharp,
    components,
    depths_in_hull,
    find_edges,
    groups_of,
    lowest_place,
    measure_pieces,
    rounded_places,
)
from tusqh.meshes.element_mesh import ElementMesh
from tusqh.meshes.interfaces import facet_areas

#: Number of sides of the boundary that lie on planes of the box, see `tusqh.meshes.boundary`.
_N_PLANES = 6

#: Twice the largest deviation of a piece of a smooth boundary from a plane, and half the largest
#: distance from a plane of the box, in sides of facets.
_NEARLY_FLAT = 0.1

#: Largest depth in the convex hull of facets on it, in sides of facets, of staircases and of smooth
#: boundaries.
_AT_HULL = (1.2, 0.25)


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
    edges = find_edges(corners)
    loop = components(edges.first, edges.second, len(corners))
    is_inner = np.zeros(len(corners), dtype=np.bool_)
    if mesh.dim == 2:
        a, b = mesh.points[corners[:, 0]], mesh.points[corners[:, 1]]
        area = np.bincount(loop, weights=(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2)
        is_inner = (area < 0)[loop]
    attribute = mesh.boundary.attribute
    may_cut = ~is_inner[edges.first]
    is_cut = np.zeros(len(may_cut), dtype=np.bool_)
    if is_smooth:
        is_cut = are_sharp(mesh.points, corners, edges) & may_cut
        whole = components(edges.first[~is_cut], edges.second[~is_cut], len(corners))
        attribute = _planes_of_pieces(mesh, whole)
    is_free = (attribute > _N_PLANES) | is_inner
    is_cut |= ~(is_free[edges.first] & is_free[edges.second])
    piece = components(edges.first[~is_cut], edges.second[~is_cut], len(corners))
    if mesh.dim == 2:
        shapes = _shapes_of_loops(piece, is_inner)
    else:
        shapes = measure_pieces(mesh, piece, edges)
        piece, shapes = _without_outside(mesh, piece, shapes, edges, is_smooth)
    walls = _collect(piece, shapes, edges, is_free)
    return Division(attribute, _sorted_walls(mesh, walls))


def boundary_components(mesh: ElementMesh) -> IntArray:
    """Return the connected component of every boundary facet, shape (b,).

    Parameters
    ----------
    mesh
        The mesh.
    """
    edges = find_edges(mesh.boundary.corners)
    return components(edges.first, edges.second, len(mesh.boundary.corners))


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


def _shapes_of_loops(piece: IntArray, is_inner: BoolArray) -> list[Shape]:
    """Return what every piece of the boundary of quads is."""
    inner = np.zeros(int(piece.max(initial=-1)) + 1, dtype=np.bool_)
    inner[piece] = is_inner
    return [Shape(HOLE, 1) if found else Shape(WALL, 0) for found in inner.tolist()]


def _without_outside(
    mesh: ElementMesh, piece: IntArray, shapes: list[Shape], edges: Edges, is_smooth: bool
) -> tuple[IntArray, list[Shape]]:
    """Divide the pieces along which holes pass but which are not walls of holes, as on a torus.

    The facets at the convex hull of the mesh are left out; the rest may be the wall of a hole.
    """
    number = [k for k, s in enumerate(shapes) if s.kind == WALL and s.n_holes]
    if not number:
        return piece, shapes
    is_mine = np.isin(piece, number)
    side = float(np.sqrt(facet_areas(mesh.points, mesh.boundary.corners).mean()))
    depth = depths_in_hull(mesh.points, np.unique(mesh.boundary.corners))
    limit = _AT_HULL[1 if is_smooth else 0] * side
    is_outer = depth[mesh.boundary.corners].max(axis=1) < limit
    is_cut = piece[edges.first] != piece[edges.second]
    is_cut |= is_mine[edges.first] & (is_outer[edges.first] != is_outer[edges.second])
    finer = components(edges.first[~is_cut], edges.second[~is_cut], len(piece))
    found = measure_pieces(mesh, finer, edges)
    of_finer = np.array([shape.kind == HOLE for shape in found], dtype=np.bool_)
    is_hole = of_finer[finer] & is_mine & ~is_outer
    if not is_hole.any():
        return piece, shapes
    # Each wall of a hole becomes a piece; the rest of the divided piece remains one piece.
    label = np.where(is_hole, len(shapes) + finer, piece)
    used, numbered = np.unique(label, return_inverse=True)
    kinds = []
    for k in used.tolist():
        if k >= len(shapes):
            own = found[k - len(shapes)]
            of_whole = shapes[int(piece[finer == k - len(shapes)][0])].n_holes
            kinds.append(Shape(own.kind, min(own.n_holes, of_whole)))
        else:
            is_rest = k in number and bool((piece[is_hole] == k).any())
            kinds.append(Shape(WALL, 0) if is_rest else shapes[k])
    return np.asarray(numbered, dtype=np.int64), kinds


def _collect(piece: IntArray, shapes: list[Shape], edges: Edges, is_free: BoolArray) -> list[Wall]:
    """Return the walls; the pieces of one hole that meet at a sharp edge are one."""
    kind = np.array([shape.kind for shape in shapes])
    ends = piece[edges.first], piece[edges.second]
    both = is_free[edges.first] & is_free[edges.second] & (ends[0] != ends[1])
    both &= (kind[ends[0]] == HOLE) & (kind[ends[1]] == HOLE)
    merged = components(ends[0][both], ends[1][both], len(shapes))
    found = []
    for rows in groups_of(merged[piece], np.flatnonzero(is_free)):
        n_holes = max(shapes[k].n_holes for k in np.unique(piece[rows]).tolist())
        found.append(Wall(str(kind[piece[rows[0]]]), rows, n_holes))
    return found


def _sorted_walls(mesh: ElementMesh, walls: list[Wall]) -> list[Wall]:
    """Return walls by kind, size and place, so that the numbering of the mesh does not matter."""
    order = (HOLE, VOID, RECESS, WALL)
    corners = mesh.boundary.corners
    areas = facet_areas(mesh.points, corners)
    places = rounded_places(mesh.points, mesh.points[corners].mean(axis=1))
    digits = 9 - int(np.floor(np.log10(max(float(areas.sum()), 1e-300))))
    keys = [
        (
            order.index(wall.kind),
            -round(float(areas[wall.rows].sum()), digits),
            lowest_place(places[wall.rows]),
        )
        for wall in walls
    ]
    return [walls[k] for k in sorted(range(len(walls)), key=keys.__getitem__)]
