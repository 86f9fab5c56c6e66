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
from tusqh.local_topology.joints import find_joints
from tusqh.sampling.doubled_grid import RESOLUTION, Multiples
from tusqh.sampling.fractions import VolumeFractions
from tusqh.topology.clamping import FULL, clamp_multiples
from tusqh.topology.pairs import tabulate_dimension
from tusqh.topology.topology import Topology

#: Name of a class by its dimension.
CLASSES = (COMPONENT, HOLE, VOID)

_KEYS = ["dimension", "birth", "death"]


def list_classes(fractions: VolumeFractions, topology: Topology) -> pd.DataFrame:
    """Return the rows of the diagram with a place for the beginning and the end of each class.

    Parameters
    ----------
    fractions
        Volume fractions.
    topology
        Their topology.

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
    >>> found = list_classes(fractions, Topology(fractions.multiples))
    >>> found.loc[1, "class"], found.loc[1, ["death", "x", "y"]].astype(float).tolist()
    ('hole', [0.0, 2.5, 2.5])
    """
    found = topology.pairs[["dimension", "birth", "death", "persistence"]].copy()
    found.insert(0, "class", [CLASSES[d] for d in found["dimension"]])
    places = _find_places(fractions.multiples, topology)
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


def _find_places(multiples: Multiples, topology: Topology) -> tuple[IntArray, IntArray]:
    """Return the places where classes begin and end; only those of ties are looked for again."""
    pairs, dim = topology.pairs, multiples.ndim
    births, deaths = (pairs[f"{event}_place"].to_numpy().copy() for event in ("birth", "death"))
    dimension, inside = pairs["dimension"].to_numpy(), doubled.cells(dim)
    is_full, is_endless = pairs["birth"].to_numpy() >= 1.0, pairs["death"].to_numpy() <= 0.0
    deep = far = np.zeros([n // 2 for n in multiples.shape], dtype=np.int64)
    if is_full.any():
        deep = _squared_depth(multiples[inside] >= FULL, border=False)
        oldest = np.flatnonzero(is_full & (dimension == 0))
        births[oldest] = _find_innermost(deep, births[oldest])
    apart = np.flatnonzero(is_endless & (dimension == 0))
    if len(apart) > 1:
        deaths[apart[1:]] = find_joints(multiples, births[apart])
    if (is_endless & (dimension > 0)).any():
        far = _squared_depth(multiples[inside] <= 0, border=True)
        last = np.flatnonzero(is_endless & ~is_full & (dimension == dim - 1))
        deaths[last] = _find_innermost(far, topology.innermost_places(births[last]))
    for d in range(1, dim):
        # The innermost cells of regions are known already, so these need no other order.
        rows = np.flatnonzero((dimension == d) & (is_full | (is_endless & (d < dim - 1))))
        if len(rows):
            nodes = clamp_multiples(_refine(multiples, deep, far))
            refined = _pairs_of(nodes, topology, d)
            births[rows], deaths[rows] = _align(pairs.iloc[rows], refined)
    return births, deaths


def _find_innermost(deep: IntArray, places: IntArray) -> IntArray:
    """Return the deepest full cells that are joined across faces to cells at places, as places."""
    from scipy import ndimage

    shape = tuple(2 * n + 1 for n in deep.shape)
    at = tuple(i // 2 for i in np.unravel_index(places, shape))
    pieces, n = ndimage.label(deep > 0)
    best = np.array(ndimage.maximum_position(deep, pieces, np.arange(1, n + 1))).reshape(n, -1)
    inner = 2 * best[pieces[at] - 1] + 1
    return np.asarray(np.ravel_multi_index(tuple(inner.T), shape), dtype=np.int64)


def _refine(multiples: Multiples, deep: IntArray, far: IntArray) -> Multiples:
    """Return levels in the order of the multiples, which tell equally empty or full cells apart.

    Full cells come in descending order of `deep`, then all others, then empty ones in ascending
    order of `far`, which may be 0 everywhere; then empty cells stay empty.  An edge or vertex that
    is empty or full gets the lowest or highest level, which clamping moves to that of a cell
    around it.
    """
    inside, deep, far = doubled.cells(multiples.ndim), _rank(deep), _rank(far)
    n_far, n_deep = int(far.max(initial=0)), int(deep.max(initial=0))
    room = FULL - n_far - n_deep - 1
    is_level = np.zeros(FULL + 1, dtype=bool)
    is_level[np.clip(multiples, 0, FULL)] = True
    rank = np.cumsum(is_level[1:FULL]) - 1
    n_levels = int(rank[-1]) + 1
    if n_levels > room:  # Neighbouring levels are merged, which only makes ties.
        rank = rank * room // n_levels
    table = np.concatenate([[0], n_far + 1 + rank, [FULL]]).astype(np.int32)
    levels = table[np.clip(multiples, 0, FULL)]
    cells = levels[inside]
    cells[far > 0] = (n_far + 1 - far)[far > 0]
    cells[deep > 0] = (FULL - n_deep + deep)[deep > 0]
    levels[inside] = cells
    return np.asarray(levels, dtype=np.int32)


def _squared_depth(chosen: BoolArray, *, border: bool) -> IntArray:
    """Return the squared distance of chosen cells to the others, in cells; 0 for the others.

    Cells outside the grid count as chosen or not (`border`).
    """
    from scipy import ndimage

    padded = np.pad(chosen, 1, constant_values=border)
    if padded.all():
        return np.ones(chosen.shape, dtype=np.int64)
    depth = ndimage.distance_transform_edt(padded)
    inner = depth[(slice(1, -1),) * chosen.ndim]
    return np.asarray(np.rint(inner**2), dtype=np.int64)


def _rank(values: IntArray) -> IntArray:
    """Return the rank of positive values among the distinct ones, from 1; 0 stays."""
    is_there = np.zeros(int(values.max(initial=0)) + 1, dtype=np.int64)
    is_there[values] = 1
    is_there[0] = 0
    return np.asarray(np.cumsum(is_there)[values], dtype=np.int64)


def _pairs_of(nodes: Multiples, topology: Topology, dimension: int) -> pd.DataFrame:
    """Return the pairs of the refined filtration with the fractions at which they begin and end."""
    pairs = tabulate_dimension(nodes, dimension)
    values = topology.values_at_places()
    found = pairs[["dimension", "birth_place", "death_place"]].copy()
    for event in ("birth", "death"):
        at = found[f"{event}_place"].to_numpy()
        found[event] = np.where(at < 0, 0, values.ravel()[at]) * RESOLUTION
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
