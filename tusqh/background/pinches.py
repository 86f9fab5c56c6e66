"""Find the vertices and edges at which the kept cells of a background are not a manifold."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.grid import BoolArray, IntArray
from tusqh.meshes.facets import HEX_FACETS, QUAD_FACETS

#: Most cells at a vertex.
_MOST = 4096


class Pinches(NamedTuple):
    """Pinches, in ascending order.

    Parameters
    ----------
    vertices
        Vertices whose kept cells, or whose empty ones with the outside, are not connected through
        facets at the vertex, shape (p,).
    edges
        Edges of hexes whose kept cells form more than one run around them, shape (q,); their ends
        are pinch vertices.
    """

    vertices: IntArray
    edges: IntArray


def find_pinches(background: BackgroundMesh, kept: BoolArray) -> Pinches:
    """Return the pinches of kept cells.

    Parameters
    ----------
    background
        The background.
    kept
        Whether each cell is kept, shape (m,).

    Examples
    --------
    >>> from tusqh.background.makers import make_box
    >>> square = make_box((0.0, 0.0), (2.0, 2.0), (2, 2))
    >>> find_pinches(square, np.array([True, False, False, True])).vertices.tolist()
    [4]
    """
    return Pinches(_find_vertices(background, kept), _find_edges(background, kept))


def _find_edges(background: BackgroundMesh, kept: BoolArray) -> IntArray:
    """Return the pinch edges: runs are kept cells less the faces that join two of them."""
    if background.dim == 2:
        return np.zeros(0, dtype=np.int64)
    n = background.n_edges
    n_kept = np.bincount(background.edge_of[kept].ravel(), minlength=n)
    both = background.facet_cells
    joins = kept[both].all(axis=1) & ~background.is_rim_facet
    n_joined = np.bincount(background.edges_of_facets[joins].ravel(), minlength=n)
    return np.flatnonzero(n_kept - n_joined > 1).astype(np.int64)


def _find_vertices(background: BackgroundMesh, kept: BoolArray) -> IntArray:
    """Return the pinch vertices among those with kept cells and empty ones, or on the rim."""
    is_mixed = np.zeros(background.n_points, dtype=bool)
    is_mixed[background.cells[kept]] = True
    has_empty = background.is_rim_vertex.copy()
    has_empty[background.cells[~kept]] = True
    mixed = np.flatnonzero(is_mixed & has_empty)
    # Each corner of a cell lies on as many facets as the cell has dimensions.
    local = QUAD_FACETS if background.dim == 2 else HEX_FACETS
    n_corners = background.cells.shape[1]
    at_corner = np.array([np.flatnonzero((local == c).any(axis=1)) for c in range(n_corners)])
    start, entries = background.corners_at
    is_pinch = np.zeros(len(mixed), dtype=np.bool_)
    _mark(
        mixed,
        start,
        entries,
        n_corners,
        at_corner,
        background.facet_of,
        background.facet_cells,
        kept,
        background.is_rim_vertex,
        is_pinch,
    )
    return mixed[is_pinch].astype(np.int64)


@numba.njit(cache=True)
def _root(parent, a):  # type: ignore[no-untyped-def]
    while parent[a] != a:
        parent[a] = parent[parent[a]]
        a = parent[a]
    return a


@numba.njit(cache=True)
def _mark(  # type: ignore[no-untyped-def]
    mixed, start, entries, n_corners, at_corner, facet_of, facet_cells, kept, on_rim, is_pinch
):
    """Mark vertices at which kept cells, or empty ones with the outside, fall apart."""
    parent = np.empty(_MOST, dtype=np.int64)
    for m in range(len(mixed)):
        v = mixed[m]
        around = entries[start[v] : start[v + 1]]
        n = len(around)
        n_kept, n_empty = 0, 1 if on_rim[v] else 0
        for a in range(n + 1):  # The last one is the outside.
            parent[a] = a
        for a in range(n):
            is_kept = kept[around[a] // n_corners]
            n_kept += is_kept
            n_empty += not is_kept
        for a in range(n):
            cell, corner = around[a] // n_corners, around[a] % n_corners
            for side in at_corner[corner]:
                both = facet_cells[facet_of[cell, side]]
                other = both[0] if both[1] == cell else both[1]
                b = n
                if other >= 0:
                    b = 0
                    while around[b] // n_corners != other:
                        b += 1
                is_other_kept = other >= 0 and kept[other]
                if b <= a or is_other_kept != kept[cell]:
                    continue
                one, two = _root(parent, a), _root(parent, b)
                if one != two:
                    parent[one] = two
                    n_kept -= is_other_kept
                    n_empty -= not is_other_kept
        is_pinch[m] = n_kept > 1 or n_empty > 1
