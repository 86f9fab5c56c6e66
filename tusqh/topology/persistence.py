"""Find the persistence pairs of the filtration, locate them, and check them against the curves.

gudhi pairs the classes of dimension 0 and 1.  In 3D the voids come from union-find, so that no
tetrahedron is stored; above `DIAGRAM_CELLS` cells so do the components.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from tusqh.errors import TopologyError
from tusqh.grid import BackgroundGrid, FloatArray, IntArray
from tusqh.sampling.doubled_grid import RESOLUTION, Multiples
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.filtration import Filtration, build_filtration

#: Largest 3D grid whose holes are paired; 64^3 cells take about 40 s and 2.6 GB.
DIAGRAM_CELLS = 64**3

#: Name of a place of the doubled grid, by its number of odd indices.
PLACES = {2: ("vertex", "edge", "cell"), 3: ("vertex", "edge", "face", "cell")}

_PAIR_ORDER = ["dimension", "persistence", "birth", "birth_place"]


def paired_dimensions(shape: tuple[int, ...], *, n_cells: int = DIAGRAM_CELLS) -> tuple[int, ...]:
    """Return the dimensions whose pairs are computed for a doubled grid of the given shape.

    Parameters
    ----------
    shape
        Shape of the doubled grid, ``2 n + 1`` along each axis.
    n_cells
        Largest number of cells of a 3D grid whose holes are paired.

    Returns
    -------
    dimensions
        0 and 1 in 2D; in 3D 0 and 2, and 1 on grids of at most `n_cells` cells.
    """
    if len(shape) == 2:
        return (0, 1)
    return (0, 1, 2) if math.prod(n // 2 for n in shape) <= n_cells else (0, 2)


def locate_pairs(pairs: pd.DataFrame, grid: BackgroundGrid) -> pd.DataFrame:
    """Return the pairs with the places that create and destroy each class.

    The two place columns are replaced by ``birth_at`` (cell, edge or vertex), ``birth_i``,
    ``birth_j``, ... (index of the cell, or of the lowest vertex of the edge) and ``birth_x``,
    ``birth_y``, ... (its centre, in model units), and by the same columns for ``death``, which are
    empty if nothing destroys the class.

    Parameters
    ----------
    pairs
        See `tusqh.topology.topology.Topology.pairs`.
    grid
        The background grid.
    """
    pairs = pairs.reset_index(drop=True)
    located = pairs.drop(columns=["birth_place", "death_place"])
    shape = tuple(2 * n + 1 for n in grid.shape)
    for event in ("birth", "death"):
        place = pairs[f"{event}_place"].to_numpy()
        is_there = place >= 0
        doubled = np.stack(np.unravel_index(np.where(is_there, place, 0), shape), axis=1)
        kind = np.array(PLACES[grid.dim], dtype=object)[(doubled % 2).sum(axis=1)]
        points = grid.to_points(doubled / 2.0)
        kind[~is_there] = None
        located[f"{event}_at"] = kind
        for axis in range(grid.dim):
            index = pd.Series(doubled[:, axis] // 2, dtype="Int64")
            index[~is_there] = pd.NA
            located[f"{event}_{'ijk'[axis]}"] = index
        for axis in range(grid.dim):
            located[f"{event}_{'xyz'[axis]}"] = np.where(is_there, points[:, axis], np.nan)
    return located


def count_alive(pairs: pd.DataFrame, thresholds: FloatArray) -> IntArray:
    """Return the Betti numbers that pairs imply at thresholds, shape (n, 3).

    Parameters
    ----------
    pairs
        Persistence pairs with columns `dimension`, `birth` and `death`.
    thresholds
        Volume fractions, dimensionless, shape (n,).

    Examples
    --------
    >>> pairs = pd.DataFrame({"dimension": [0, 0], "birth": [1.0, 0.75], "death": [0.0, 0.5]})
    >>> count_alive(pairs, np.array([0.6, 0.5])).tolist()
    [[2, 0, 0], [1, 0, 0]]
    """
    columns = []
    for dimension in range(3):
        events = pairs.loc[pairs["dimension"] == dimension, ["birth", "death"]].to_numpy()
        born, dead = np.sort(events, axis=0).T
        columns.append(np.searchsorted(dead, thresholds) - np.searchsorted(born, thresholds))
    return np.stack(columns, axis=1).astype(np.int64)


def require_agreement(
    pairs: pd.DataFrame, curves: pd.DataFrame, dimensions: tuple[int, ...], *, name: str
) -> None:
    """Raise a `TopologyError` if pairs and curves, two independent counts, differ at a threshold.

    Parameters
    ----------
    pairs
        See `tusqh.topology.topology.Topology.pairs`.
    curves
        See `tusqh.topology.topology.Topology.curves`.
    dimensions
        Dimensions to compare, see `paired_dimensions`.
    name
        The model, for the message.

    Raises
    ------
    TopologyError
        The two differ, which is a fault of tusqh or gudhi.
    """
    by_pairs = count_alive(pairs, curves["upper"].to_numpy())[:, dimensions]
    by_curves = curves[[f"betti_{k}" for k in dimensions]].to_numpy()
    differs = (by_pairs != by_curves).any(axis=1)
    if differs.any():
        row = int(np.flatnonzero(differs)[0])
        raise TopologyError(
            f"at threshold {curves['upper'].iloc[row]} persistence pairs give Betti numbers "
            f"{by_pairs[row].tolist()}, union-find and counting {by_curves[row].tolist()}",
            where=name,
            expected="the same numbers",
            remedy="this is a fault of tusqh or gudhi: please report it with fractions.npz",
        )


def betti_at(curves: pd.DataFrame, threshold: float) -> BettiNumbers:
    """Return the Betti numbers of the plateau that contains a threshold in (0, 1].

    Parameters
    ----------
    curves
        See `tusqh.topology.topology.Topology.curves`.
    threshold
        Volume fraction, dimensionless.
    """
    row = curves[(curves["lower"] < threshold) & (threshold <= curves["upper"])].iloc[0]
    return BettiNumbers(int(row["betti_0"]), int(row["betti_1"]), int(row["betti_2"]))


def pair_by_gudhi(multiples: Multiples) -> pd.DataFrame:
    """Return the pairs of dimension 0 and 1, including those with equal birth and death.

    Triangles suffice for these dimensions, so no tetrahedron is stored.

    Parameters
    ----------
    multiples
        Fractions on the doubled grid as multiples of `RESOLUTION`, shape ``2 n + 1``.

    Returns
    -------
    pairs
        See `tusqh.topology.topology.Topology.pairs`.
    """
    import gudhi

    filtration = build_filtration(np.clip(multiples * RESOLUTION, 0.0, 1.0))
    tree = gudhi.SimplexTree()
    for k, simplices in enumerate(filtration.simplices[:3]):
        if len(simplices):
            tree.insert_batch(simplices.T.astype(np.int32), -filtration.simplex_values(k))
    # gudhi leaves out the highest dimension of the complex unless `persistence_dim_max` is set.
    is_flat = len(filtration.simplices[2]) == 0
    tree.compute_persistence(
        homology_coeff_field=2,
        min_persistence=-1.0,
        persistence_dim_max=is_flat,
    )
    finite, essential = tree.lower_star_persistence_generators()
    tables = []
    for dimension in range(2):
        nodes = finite[dimension] if dimension < len(finite) else np.empty((0, 2), dtype=np.int64)
        alone = essential[dimension] if dimension < len(essential) else np.empty(0, dtype=np.int64)
        born = np.concatenate([nodes[:, 0], alone]).astype(np.int64)
        died = np.concatenate([nodes[:, 1], np.full(len(alone), -1)]).astype(np.int64)
        tables.append(_to_table(dimension, born, died, filtration, multiples.shape))
    pairs = pd.concat(tables).sort_values(_PAIR_ORDER, ascending=[True, False, False, True])
    return pairs.reset_index(drop=True)


def _to_table(
    dimension: int, born: IntArray, died: IntArray, filtration: Filtration, shape: tuple[int, ...]
) -> pd.DataFrame:
    place = np.ravel_multi_index(tuple(filtration.positions.T), shape).astype(np.int64)
    place, value = np.append(place, -1), np.append(filtration.values, 0.0)  # Node -1: never.
    return pd.DataFrame(
        {
            "dimension": dimension,
            "birth": value[born],
            "death": value[died],
            "persistence": value[born] - value[died],
            "essential": died < 0,
            "birth_place": place[born],
            "death_place": place[died],
        }
    )
