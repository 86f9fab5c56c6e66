"""Make the mesh of the kept cells of a background."""

from __future__ import annotations

import numpy as np

from tusqh.background.cells import BackgroundCells
from tusqh.background.growing import Parts
from tusqh.background.split_hexes import split_hexes
from tusqh.background.split_quads import split_quads
from tusqh.grid import BoolArray, IntArray
from tusqh.grid.arrays import as_indices
from tusqh.meshes.facets import find_facets
from tusqh.meshes.volume_mesh import CONNECTING, GRID_CELL, INNER_CELL, VolumeMesh


def build_mesh(cells: BackgroundCells, *, name: str) -> tuple[VolumeMesh, BoolArray, BoolArray]:
    """Return the mesh of kept cells, with new vertices at the places of a simple rule.

    Parts of kept cells are kept, except balls and sticks that separate; parts of empty cells are
    left out, except balls and sticks that connect.

    Parameters
    ----------
    cells
        The cells and the decisions of their pinches.
    name
        The model.

    Returns
    -------
    mesh
        The mesh; `grid_cell` is the number of the background cell.
    is_new
        Whether each point of it is new and does not lie on the rim, shape (n,).
    on_rim
        Whether each point lies on the rim of the background, shape (n,).
    """
    background, pinches = cells.background, cells.pinches
    is_pinch = np.zeros(background.n_points, dtype=bool)
    is_pinch[pinches.vertices] = True
    is_split = is_pinch[background.cells].any(axis=1)
    split = np.flatnonzero(is_split)
    whole = np.flatnonzero(~is_split & cells.kept)
    parts = _split(cells, split)
    own = split[parts.parent] if len(split) else parts.parent
    decision = np.concatenate(
        [[0], np.where(cells.vertices_connect, 1, -1), np.where(cells.edges_connect, 1, -1)]
    )[parts.tag]
    stays = np.where(cells.kept[own], decision != -1, decision == 1)
    corners = np.concatenate([background.cells[whole], parts.cells[stays]]).astype(np.int64)
    added = np.where(cells.kept[own[stays]], INNER_CELL, CONNECTING)
    kind = np.concatenate([np.full(len(whole), GRID_CELL), added]).astype(np.int8)
    free = _find_free(parts, background.n_points)
    is_used = np.zeros(len(parts.points), dtype=bool)
    is_used[corners] = True
    number = np.cumsum(is_used) - 1
    mesh = VolumeMesh(
        points=parts.points[is_used],
        cells=as_indices(number[corners]),
        kind=kind,
        grid_cell=as_indices(np.concatenate([whole, own[stays]])),
        name=name,
        unit=background.unit,
    )
    on_rim = ~free
    on_rim[: background.n_points] = background.is_rim_vertex
    return mesh, free[is_used], on_rim[is_used]


def _split(cells: BackgroundCells, split: IntArray) -> Parts:
    """Return the parts of the cells at pinch vertices."""
    background, pinches = cells.background, cells.pinches
    chosen = background.cells[split].astype(np.int64)
    if background.dim == 2:
        return split_quads(background.points, chosen, background.shortest_edge, pinches.vertices)
    return split_hexes(
        background.points,
        chosen,
        background.shortest_edge,
        pinches,
        background.edge_ends[pinches.edges],
        (cells.vertices_connect, cells.edges_connect),
    )


def _find_free(parts: Parts, n_old: int) -> BoolArray:
    """Return the new points inside the background.

    Facets between split cells and others have no pinch vertex and stay whole, so the other
    boundary facets of the parts with a new point lie on the rim.
    """
    free = np.arange(len(parts.points)) >= n_old
    if len(parts.cells):
        free[find_facets(parts.cells).boundary] = False
    return free
