"""Locate the persistence pairs of the filtration, and check them against the curves."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.errors import TopologyError
from tusqh.grid import BackgroundGrid, FloatArray, IntArray
from tusqh.topology.betti_numbers import BettiNumbers

#: Name of a place of the doubled grid, by its number of odd indices.
PLACES = {2: ("vertex", "edge", "cell"), 3: ("vertex", "edge", "face", "cell")}


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


def place_pairs(located: pd.DataFrame, grid: BackgroundGrid) -> pd.DataFrame:
    """Return the pairs that `locate_pairs` located, with their two place columns.

    Parameters
    ----------
    located
        The pairs, read from diagram.csv for instance.
    grid
        The background grid.
    """
    axes = "xyz"[: grid.dim]
    described = [f"_{name}" for name in ("at", *"ijk"[: grid.dim], *axes)]
    pairs = located.drop(columns=[e + name for e in ("birth", "death") for name in described])
    shape = tuple(2 * n + 1 for n in grid.shape)
    for event in ("birth", "death"):
        points = located[[f"{event}_{axis}" for axis in axes]].to_numpy(dtype=float)
        is_there = np.isfinite(points).all(axis=1)
        cells = np.where(is_there[:, None], grid.to_lattice(points), 0.0)
        place = np.ravel_multi_index(tuple(np.rint(2 * cells).astype(np.int64).T), shape)
        pairs[f"{event}_place"] = np.where(is_there, place, -1)
    return pairs


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


def require_agreement(pairs: pd.DataFrame, curves: pd.DataFrame, *, name: str) -> None:
    """Raise a `TopologyError` if pairs and curves, two independent counts, differ at a threshold.

    The Betti numbers and, because in 2D both come from the same union-find, the Euler
    characteristic, which is counted simplex by simplex, are compared.

    Parameters
    ----------
    pairs
        See `tusqh.topology.topology.Topology.pairs`.
    curves
        See `tusqh.topology.topology.Topology.curves`.
    name
        The model, for the message.

    Raises
    ------
    TopologyError
        The two differ, which is a fault of tusqh.
    """
    by_pairs = count_alive(pairs, curves["upper"].to_numpy())
    by_curves = curves[[f"betti_{k}" for k in range(3)]].to_numpy()
    differs = (by_pairs != by_curves).any(axis=1)
    differs |= by_pairs @ [1, -1, 1] != curves["euler"].to_numpy()
    if differs.any():
        row = int(np.flatnonzero(differs)[0])
        raise TopologyError(
            f"at threshold {curves['upper'].iloc[row]} persistence pairs give Betti numbers "
            f"{by_pairs[row].tolist()}, union-find and counting {by_curves[row].tolist()} and the "
            f"Euler characteristic {curves['euler'].iloc[row]}",
            where=name,
            expected="the same numbers",
            remedy="this is a fault of tusqh: please report it with fractions.npz",
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
