"""Undo fitting around hexes with folds and around facets that cross, until neither is left."""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.fitting.crossings import find_crossings
from tusqh.fitting.fitted import FELL_BACK_COLUMNS
from tusqh.fitting.moving import Moving
from tusqh.fitting.planes import FitTerms
from tusqh.fitting.skin import Skin
from tusqh.fitting.validity import find_unproven
from tusqh.grid import BackgroundGrid, BoolArray, FloatArray
from tusqh.meshes.jacobians import smallest_jacobians

#: Rounds in which vertices are pulled back: rings around the bad ones, and weight.
_PULLS = ((0, 100.0), (0, 300.0), (0, 300.0), (1, 300.0), (1, 1000.0), (1, 1000.0), (2, 1000.0))
#: Share of the way back in one round, and how much less it is one ring farther away.
_SHARE, _FADE = 0.34, 0.2
#: Rounds in which vertices are put back, first those with a small share.
_BACKS, _GENTLE, _LITTLE = 28, 4, 0.04

#: Scaled Jacobian below which a hex goes back to its safe place if it is better there.
POOR = 0.21

FOLD, CROSSING = "a hex would be folded or flat", "the boundary would cross itself"


class Faults:
    """Vertices at which a mesh is not as it must be.

    Parameters
    ----------
    moving
        The hexes.
    skin
        Their boundary.
    """

    def __init__(self, moving: Moving, skin: Skin) -> None:
        points, n = moving.points, len(moving.points)
        facets = skin.vertices[skin.facets]
        self.folded, self.crossed = np.zeros(n, dtype=np.bool_), np.zeros(n, dtype=np.bool_)
        self.folded[moving.cells[find_unproven(points, moving.cells)]] = True
        self.crossed[facets[find_crossings(points, facets)]] = True

    @property
    def any(self) -> BoolArray:
        """Vertices at which anything is wrong, shape (n,)."""
        return self.folded | self.crossed


def pull_back(moving: Moving, skin: Skin, calm: FloatArray) -> BoolArray:
    """Pull boundary vertices around faults towards calm places, shape (n,): those pulled.

    A vertex goes a third of the way farther in each round in which a fault is near.

    Parameters
    ----------
    moving
        The hexes; change in place.
    skin
        Their boundary.
    calm
        Places of the boundary vertices at which no facets cross, shape (b, 3).

    Returns
    -------
    pulled
        Whether each vertex of the mesh was pulled.
    """
    vertices = skin.vertices
    begin, share = moving.points[vertices], np.zeros(len(vertices))
    hold = np.zeros((len(vertices), 6))
    hold[:, :3] = 1.0
    for rings, weight in _PULLS:
        faults = Faults(moving, skin).any
        if not faults.any():
            break
        near = moving.spread(faults, rings)[vertices]
        share[near] = np.minimum(1.0, share[near] + _SHARE)
        chosen = share > 0
        places = begin + share[:, None] * (calm - begin)
        terms = FitTerms(hold[chosen], places[chosen])
        moving.aim(vertices[chosen], terms, np.full(int(chosen.sum()), weight))
        moving.sweep(4)
    pulled = np.zeros(len(moving.points), dtype=np.bool_)
    pulled[vertices[share > 0]] = True
    return pulled


def put_back(moving: Moving, skin: Skin, safe: FloatArray) -> BoolArray:
    """Put vertices around faults and poor hexes back to safe places, shape (n,): those put back.

    The way back fades out over the rings around the faults.  At the latest it ends with all
    vertices in their safe places.

    Parameters
    ----------
    moving
        The hexes; change in place.
    skin
        Their boundary.
    safe
        Places without a fault, shape (n, 3).

    Returns
    -------
    touched
        Whether each vertex of the mesh was put back, by any share.
    """
    fitted, share = moving.points.copy(), np.zeros(len(moving.points))
    was_poor = smallest_jacobians(safe, moving.cells).scaled < POOR
    for round_ in range(_BACKS):
        faults = Faults(moving, skin).any
        faults[moving.cells[(moving.quality.scaled < POOR) & ~was_poor]] = True
        if not faults.any():
            return share > 0
        near = moving.spread(faults, max(0, round_ - _GENTLE) // 4)
        step = _LITTLE if round_ < _GENTLE else _SHARE
        share[near] = np.minimum(1.0, share[near] + step)
        for _ in range(int(1 / _FADE)):
            share = np.maximum(share, _largest_around(moving, share) - _FADE)
        moving.points[:] = fitted + share[:, None] * (safe - fitted)
    if Faults(moving, skin).any.any():
        moving.points[:] = safe
        share[:] = 1.0
    return share > 0


def _largest_around(moving: Moving, values: FloatArray) -> FloatArray:
    """Return the largest value at any vertex of the hexes around each vertex, shape (n,)."""
    largest = values.copy()
    np.maximum.at(largest, moving.cells, values[moving.cells].max(axis=1)[:, None])
    return largest


def list_regions(
    moving: Moving, is_in: BoolArray, what: str, why: str, grid: BackgroundGrid
) -> pd.DataFrame:
    """Return one row for each connected region of vertices, see `Fitted.fell_back`.

    Parameters
    ----------
    moving
        The hexes.
    is_in
        The vertices, shape (n,).
    what, why
        What happened, and why.
    grid
        The grid, whose cells are the unit of length of the hexes.
    """
    cells = moving.cells[is_in[moving.cells].any(axis=1)]
    n = len(is_in)
    pairs = cells[:, np.stack(np.triu_indices(8, 1), axis=1)].reshape(-1, 2)
    pairs = pairs[is_in[pairs].all(axis=1)]
    graph = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(n, n))
    number = connected_components(graph, directed=False)[1]
    rows = []
    for region in np.unique(number[is_in]):
        members = np.flatnonzero(is_in & (number == region))
        centre = grid.to_points(moving.points[members].mean(axis=0)[None])[0]
        rows.append((*centre, len(members), what, why))
    return pd.DataFrame(rows, columns=list(FELL_BACK_COLUMNS))
