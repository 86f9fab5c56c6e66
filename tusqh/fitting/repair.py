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
from tusqh.grid import BoolArray, FloatArray

#: Rounds in which vertices are pulled back: rings around the bad ones, and weight.
_PULLS = ((2, 30.0), (3, 100.0), (4, 300.0))
#: Rings around the bad ones in which vertices are then put back.
_RINGS = (1, 2, 3, 5, 8, 12, 20)

FOLD, CROSSING = "a hex would be folded", "the boundary would cross itself"


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


def pull_back(moving: Moving, skin: Skin, calm: FitTerms) -> BoolArray:
    """Pull vertices around faults to a calm place, and return those that were pulled, shape (n,).

    Parameters
    ----------
    moving
        The hexes; change in place.
    skin
        Their boundary.
    calm
        Fit terms of the boundary vertices that lead to the calm places.
    """
    pulled = np.zeros(len(moving.points), dtype=np.bool_)
    for rings, weight in _PULLS:
        faults = Faults(moving, skin).any
        if not faults.any():
            break
        pulled |= moving.spread(faults, rings)
        chosen = pulled[skin.vertices]
        terms = FitTerms(calm.matrix[chosen], calm.place[chosen])
        moving.aim(skin.vertices[chosen], terms, np.full(int(chosen.sum()), weight))
        moving.sweep(6)
    return pulled


def put_back(moving: Moving, skin: Skin, safe: FloatArray) -> BoolArray:
    """Put vertices around faults back to safe places, and return those that were, shape (n,).

    The way back fades out over the rings around the faults.  At the latest it ends with all
    vertices in their safe places.

    Parameters
    ----------
    moving
        The hexes; change in place.
    skin
        Their boundary.
    safe
        Places at which there is no fault, shape (n, 3).
    """
    fitted = moving.points.copy()
    bad = np.zeros(len(fitted), dtype=np.bool_)
    touched = bad.copy()
    for rings in _RINGS:
        faults = Faults(moving, skin).any
        if not faults.any():
            return touched
        bad |= faults
        share = np.zeros(len(fitted))
        ring = bad.copy()
        for k in range(2 * rings + 1):
            share[ring & (share == 0)] = min(1.0, (2 * rings + 1 - k) / (rings + 1))
            ring = moving.spread(ring, 1)
        touched = share > 0
        moving.points[:] = fitted + share[:, None] * (safe - fitted)
    if Faults(moving, skin).any.any():
        moving.points[:] = safe
        touched[:] = True
    return touched


def list_regions(
    moving: Moving, is_in: BoolArray, what: str, why: str, scale: tuple[float, FloatArray]
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
    scale
        Cell size and origin, which lead from cells to model units.
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
        centre = moving.points[members].mean(axis=0) * scale[0] + scale[1]
        rows.append((*centre, len(members), what, why))
    return pd.DataFrame(rows, columns=list(FELL_BACK_COLUMNS))
