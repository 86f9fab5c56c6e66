"""Check that a mesh can be a background: conforming, valid, and with one fan at every vertex."""

from __future__ import annotations

import numpy as np

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.errors import MeshError
from tusqh.geometry.kinds import Geometry
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.grid.components import label_components
from tusqh.meshes.hanging_nodes import find_hanging_nodes
from tusqh.meshes.numbering import count_different_points, number_rows

#: Scaled Jacobian below which a cell is flat.
LEAST_JACOBIAN = 1e-3
#: Ratio of the extents of geometry and background from which the units are doubted.
_FACTOR = 100.0


def require_background(background: BackgroundMesh) -> None:
    """Raise an error if a mesh cannot be a background.

    Parameters
    ----------
    background
        The mesh.

    Raises
    ------
    MeshError
        A cell uses a vertex twice, or is repeated, inverted or flat; points are repeated; a facet
        belongs to three cells; vertices hang; two cells share two facets; or the cells at an edge
        or vertex are not one fan.
    """
    _require_corners(background)
    _require_points(background)
    _require_conforming(background)
    _require_valid(background)
    _require_fans(background)


def require_overlap(background: BackgroundMesh, geometry: Geometry) -> None:
    """Raise an error if a background and a geometry do not fit each other.

    Parameters
    ----------
    background
        The background.
    geometry
        The geometry.

    Raises
    ------
    MeshError
        They have another dimension, do not overlap, or one is more than 100 times as large as the
        other, as in another unit of length.
    """
    low, high = (np.asarray(corner) for corner in geometry.bounding_box())
    if len(low) != background.dim:
        raise _error(
            background,
            f"is a mesh in {background.dim}D, and the geometry is in {len(low)}D",
            "quads for outlines, hexes for surfaces and images",
            "give a background of the geometry's dimension",
        )
    own_low, own_high = background.points.min(axis=0), background.points.max(axis=0)
    sizes = f"it reaches from {_place(own_low)} to {_place(own_high)}, the geometry from "
    sizes += f"{_place(low)} to {_place(high)}"
    ratio = float(np.max(own_high - own_low) / max(float(np.max(high - low)), 1e-300))
    if not 1 / _FACTOR <= ratio <= _FACTOR:
        raise _error(
            background,
            f"is {ratio:.3g} times as large as the geometry: {sizes}",
            "a background of a similar extent",
            "check the units of both: `--unit`, `--scale` and `--convert-to` change the geometry",
        )
    if (own_low > high).any() or (own_high < low).any():
        raise _error(
            background,
            f"misses the geometry: {sizes}",
            "a background that overlaps the geometry",
            "move one of them, or check their units",
        )


def _require_corners(background: BackgroundMesh) -> None:
    cells = background.cells
    ordered = np.sort(cells, axis=1)
    bad = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
    _refuse_cells(background, bad, "cells use a vertex twice", "quads and hexes with all corners")
    number, n_different = number_rows(cells, np.arange(cells.shape[1])[None])
    if n_different < len(cells):
        first = np.unique(number, return_index=True)[1]
        again = np.setdiff1d(np.arange(len(cells)), first)
        _refuse_cells(background, again, "cells are repeated", "every cell once")


def _require_points(background: BackgroundMesh) -> None:
    n_repeated = background.n_points - count_different_points(background.points)
    if n_repeated:
        _, first, count = np.unique(
            background.points, axis=0, return_index=True, return_counts=True
        )
        at = background.points[first[count > 1][0]]
        raise _error(
            background,
            f"{n_repeated} points are repeated, the first at {_place(at)}",
            "cells that touch share their vertices",
            "merge the points, as `Coherence Mesh` of Gmsh or `clean` of pyvista does",
        )


def _require_valid(background: BackgroundMesh) -> None:
    scaled = background.jacobians.scaled
    inverted = np.flatnonzero(background.jacobians.determinant < 0)
    remedy = "repair the background; a mesh generator's quality view shows these cells"
    _refuse_cells(
        background, inverted, "cells are inverted", "positive Jacobians at all corners", remedy
    )
    flat = np.flatnonzero(~(scaled >= LEAST_JACOBIAN))
    expected = f"scaled Jacobians of at least {LEAST_JACOBIAN:g}"
    _refuse_cells(background, flat, "cells are flat", expected, remedy)


def _require_conforming(background: BackgroundMesh) -> None:
    facets = background.facets
    what = "sides" if background.dim == 2 else "faces"
    overfull = np.flatnonzero(facets.n_cells_of[background.facet_of].max(axis=1) > 2)
    _refuse_cells(
        background, overfull, f"cells have {what} that more than two cells share", "at most two"
    )
    hanging = find_hanging_nodes(background.points, facets.boundary)
    if len(hanging):
        raise _error(
            background,
            f"{len(hanging)} vertices hang on {what} or edges of other cells, the first at "
            f"{_place(background.points[hanging[0]])}",
            "a conforming mesh",
            "refine without hanging vertices, for instance by 27 hexes per hex",
        )
    pairs = np.sort(background.facet_cells[~background.is_rim_facet], axis=1)
    _, first, count = np.unique(pairs, axis=0, return_index=True, return_counts=True)
    twice = pairs[first[count > 1], 0]
    _refuse_cells(
        background,
        twice,
        f"cells share two {what} with the same neighbour",
        f"two cells share at most one {what[:-1]}",
        "split these cells, so that each has another neighbour there",
    )


def _require_fans(background: BackgroundMesh) -> None:
    """Refuse edges and vertices whose cells are not one fan, a ball or half a ball."""
    remedy = "separate the cells that touch there only, or connect them through a facet"
    if background.dim == 3:
        bad = np.flatnonzero(_is_broken(background.edge_of, background.edges_of_facets, background))
        if len(bad):
            at = background.points[background.edge_ends[bad[0]]].mean(axis=0)
            raise _error(
                background,
                f"at {len(bad)} edges the hexes are not one fan, the first at {_place(at)}",
                "hexes that are connected through faces around every edge",
                remedy,
            )
    bad = _find_broken_vertices(background)
    if len(bad):
        raise _error(
            background,
            f"at {len(bad)} vertices the cells are not one fan, the first at "
            f"{_place(background.points[bad[0]])}",
            "cells that are connected through facets around every vertex",
            remedy,
        )


def _is_broken(parts: IntArray, of_facets: IntArray, background: BackgroundMesh) -> BoolArray:
    """Return whether the cells at each part of codimension 2 are not one fan."""
    n = int(parts.max()) + 1
    inside = ~background.is_rim_facet
    n_cells = np.bincount(parts.ravel(), minlength=n)
    n_joined = np.bincount(of_facets[inside].ravel(), minlength=n)
    n_rim = np.bincount(of_facets[~inside].ravel(), minlength=n)
    is_open = (n_rim != 2) | (n_joined != n_cells - 1)
    return np.asarray(np.where(n_rim == 0, n_joined != n_cells, is_open))


def _find_broken_vertices(background: BackgroundMesh) -> IntArray:
    """Return the vertices whose cells are not one fan.

    In space the cells at a vertex cut a small sphere around it into triangles; these must be one
    sphere or one disc, whose Euler characteristics are 2 and 1.
    """
    cells, n = background.cells, background.n_points
    of_facets = background.vertices_of_facets
    if background.dim == 2:
        return np.flatnonzero(_is_broken(cells, of_facets, background))
    n_triangles = np.bincount(cells.ravel(), minlength=n)
    n_sides = np.bincount(of_facets.ravel(), minlength=n)
    n_corners = np.bincount(background.edge_ends.ravel(), minlength=n)
    euler = n_corners - n_sides + n_triangles
    wanted = np.where(background.is_rim_vertex, 1, 2)
    return np.flatnonzero((euler != wanted) | (_count_fans(background) != 1))


def _count_fans(background: BackgroundMesh) -> IntArray:
    """Return the number of sets of hexes at each vertex that are joined through faces."""
    corner = np.arange(background.cells.size, dtype=np.int64).reshape(background.cells.shape)
    local = background.facets.local
    inside = ~background.is_rim_facet
    of_cell = corner[:, local].reshape(-1, local.shape[1])
    facet = background.facet_of.ravel()
    order = np.argsort(facet[inside[facet]], kind="stable")
    rows = np.flatnonzero(inside[facet])[order].reshape(-1, 2)
    ends = background.facets.corners[rows]
    # The two cells list the corners of their face in different orders.
    sort = np.argsort(ends, axis=2, kind="stable")
    pairs = np.take_along_axis(of_cell[rows], sort, axis=2)
    label, n_fans = label_components(
        pairs[:, 0].ravel(), pairs[:, 1].ravel(), background.cells.size
    )
    vertex = np.empty(n_fans, dtype=np.int64)
    vertex[label] = background.cells.ravel()
    return np.bincount(vertex, minlength=background.n_points)


def _refuse_cells(
    background: BackgroundMesh, bad: IntArray, what: str, expected: str, remedy: str = ""
) -> None:
    """Raise an error that counts bad cells and names the first, if there are any."""
    if len(bad):
        first = int(bad[0])
        raise _error(
            background,
            f"{len(bad)} {what}, the first is cell {first} near {background.centre_of(first)}",
            expected,
            remedy or "correct the background mesh",
        )


def _place(point: FloatArray) -> str:
    return "(" + ", ".join(f"{x:.6g}" for x in point) + ")"


def _error(background: BackgroundMesh, found: str, expected: str, remedy: str) -> MeshError:
    return MeshError(found, where=background.name, expected=expected, remedy=remedy)
