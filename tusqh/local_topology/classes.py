"""List the classes of the persistence diagram with the places where they begin and end.

A class that is never destroyed above 0, such as the hole of a ring, has no place of its own in the
diagram, and among cells that are equally full any order of their creation is right.  Therefore the
filtration is refined: empty cells are filled in the order of their distance to the others, the
nearest first, and full cells appear by their distance to the others, the farthest first.  This
changes no persistence, and every class that can end has a place where it ends: the middle of the
narrowest section of a hole, the innermost cell of a void.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.antialias.components import COMPONENT, HOLE, VOID
from tusqh.grid import BackgroundGrid, BoolArray, FloatArray, IntArray, doubled
from tusqh.sampling.doubled_grid import RESOLUTION, Multiples
from tusqh.sampling.fractions import VolumeFractions
from tusqh.topology.clamping import FULL, MARGIN, clamp_multiples
from tusqh.topology.topology import Topology

#: Name of a class by its dimension.
CLASSES = (COMPONENT, HOLE, VOID)

_KEYS = ["dimension", "birth", "death"]


def list_classes(fractions: VolumeFractions, pairs: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of the diagram with a place for the beginning and the end of each class.

    Parameters
    ----------
    fractions
        Volume fractions.
    pairs
        See `tusqh.topology.topology.Topology.pairs`.

    Returns
    -------
    classes
        One row per row of the diagram, in its order: `class`, `dimension`, `birth`, `death`,
        `persistence`, `birth_place` and `death_place` (flat indices into the doubled grid, -1 if
        the class never ends), and the point at which a wish looks for the class, `x`, `y` and in 3D
        `z` (model units): where a component begins, and where a hole or void ends.

    Examples
    --------
    A ring around a hole of 3 by 3 cells, whose middle is filled last:

    >>> cells = np.ones((5, 5))
    >>> cells[1:-1, 1:-1] = 0
    >>> values = np.zeros((11, 11))
    >>> values[1::2, 1::2] = cells
    >>> grid = BackgroundGrid(shape=(5, 5), cell_size=1.0, origin=(0.0, 0.0))
    >>> fractions = VolumeFractions.from_values(grid, 4, values)
    >>> found = list_classes(fractions, Topology(fractions.multiples).pairs)
    >>> found.loc[1, "class"], found.loc[1, ["death", "x", "y"]].astype(float).tolist()
    ('hole', [0.0, 2.5, 2.5])
    """
    refined = _pairs_of(fractions.multiples)
    places = _align(pairs, refined)
    found = pairs[["dimension", "birth", "death", "persistence"]].reset_index(drop=True)
    found.insert(0, "class", [CLASSES[d] for d in found["dimension"]])
    for event, place in zip(("birth", "death"), places, strict=True):
        found[f"{event}_place"] = place
    begins = (found["dimension"] == 0) | (found["death_place"] < 0)
    at = np.where(begins, found["birth_place"], found["death_place"])
    points = points_of(at, fractions.grid)
    return found.assign(**{name: points[:, k] for k, name in enumerate("xyz"[: points.shape[1]])})


def points_of(places: IntArray, grid: BackgroundGrid) -> FloatArray:
    """Return the points of flat places of the doubled grid, shape (r, dim), in model units.

    Parameters
    ----------
    places
        Flat indices into the doubled grid, shape (r,).
    grid
        The background grid.
    """
    index = np.stack(np.unravel_index(places, [2 * n + 1 for n in grid.shape]), axis=1)
    return grid.to_points(index / 2.0)


def refine(multiples: Multiples) -> Multiples:
    """Return levels in the order of the multiples, which tell equally empty or full cells apart.

    Parameters
    ----------
    multiples
        Fractions on the doubled grid as multiples of `RESOLUTION`, shape ``2 n + 1``, int32.

    Returns
    -------
    levels
        Shape ``2 n + 1``, int32; at least 1 for cells.  An edge or vertex that is empty or full
        gets the lowest or highest level, which clamping moves to that of a cell around it.
    """
    inside = doubled.cells(multiples.ndim)
    is_empty, is_full = multiples[inside] <= 0, multiples[inside] >= FULL
    far = _rank(is_empty, _squared_depth(is_empty, border=True))
    deep = _rank(is_full, _squared_depth(is_full, border=False))
    n_far, n_deep = int(far.max(initial=0)), int(deep.max(initial=0))
    between = np.unique(multiples[(multiples > 0) & (multiples < FULL)])
    room = FULL - n_far - n_deep - 1
    rank = np.searchsorted(between, multiples)
    if len(between) > room:  # Neighbouring levels are merged, which only makes ties.
        rank = rank * room // len(between)
    levels = np.where(multiples <= 0, 0, np.where(multiples >= FULL, FULL, n_far + 1 + rank))
    cells = levels[inside]
    cells[is_empty] = n_far + 1 - far[is_empty]
    cells[is_full] = FULL - n_deep + deep[is_full]
    levels[inside] = cells
    return np.asarray(levels, dtype=np.int32)


def _squared_depth(chosen: BoolArray, *, border: bool) -> IntArray:
    """Return the squared distance to the cells that are not chosen, in cells."""
    from scipy import ndimage

    padded = np.pad(chosen, 1, constant_values=border)
    if padded.all():
        return np.ones(chosen.shape, dtype=np.int64)
    depth = ndimage.distance_transform_edt(padded)
    inner = depth[(slice(1, -1),) * chosen.ndim]
    return np.asarray(np.rint(inner**2), dtype=np.int64)


def _rank(chosen: BoolArray, values: IntArray) -> IntArray:
    """Return the rank of the values of chosen cells, from 1."""
    rank = np.zeros(values.shape, dtype=np.int64)
    rank[chosen] = 1 + np.unique(values[chosen], return_inverse=True)[1]
    return rank


def _pairs_of(multiples: Multiples) -> pd.DataFrame:
    """Return the pairs of the refined filtration with the fractions at which they begin and end."""
    pairs = Topology(refine(multiples)).pairs
    inner = (slice(MARGIN, -MARGIN),) * multiples.ndim
    values = np.append(clamp_multiples(multiples)[inner].ravel(), 0)
    found = pairs[["dimension", "birth_place", "death_place"]].copy()
    for event in ("birth", "death"):
        found[event] = values[found[f"{event}_place"].to_numpy()] * RESOLUTION
    found = found[found["birth"] > found["death"]]
    order = [*_KEYS, "death_place", "birth_place"]
    return found.sort_values(order, ignore_index=True)


def _align(pairs: pd.DataFrame, refined: pd.DataFrame) -> tuple[IntArray, IntArray]:
    """Return the refined places of the rows of a diagram; of equal rows, the same places first."""
    groups = {key: list(g.index) for key, g in refined.groupby(_KEYS, sort=False)}
    births, deaths = (refined[f"{e}_place"].to_numpy() for e in ("birth", "death"))
    chosen = np.full(len(pairs), -1, dtype=np.int64)
    rows = pairs[[*_KEYS, "birth_place", "death_place"]].itertuples(index=False)
    waiting = []
    for row, (dimension, birth, death, birth_place, death_place) in enumerate(rows):
        left = groups[dimension, birth, death]
        same = [k for k in left if births[k] == birth_place or deaths[k] == death_place >= 0]
        if same:
            chosen[row] = same[0]
            left.remove(same[0])
        else:
            waiting.append((row, left))
    for row, left in waiting:
        chosen[row] = left.pop(0)
    return births[chosen], deaths[chosen]
