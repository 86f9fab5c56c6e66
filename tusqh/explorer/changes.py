"""The cells in which the final mesh differs from its base, and what can be done about classes."""

from __future__ import annotations

from typing import Any

import numpy as np

from tusqh.antialias.cells import CellSets
from tusqh.explorer.arrays import Arrays
from tusqh.grid import IntArray
from tusqh.local_topology.features import Features
from tusqh.local_topology.prices import affordable_rows, try_wishes
from tusqh.meshes.volume_mesh import GRID_CELL, INNER_CELL, VolumeMesh
from tusqh.pipeline.select import MOST_CELLS
from tusqh.threshold.selection import Selection


def changed_cells(
    cell_sets: CellSets, selection: Selection, mesh: VolumeMesh
) -> tuple[Arrays, dict[str, Any]]:
    """Return the cells in which a mesh differs from its base, and facts about the mesh.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    selection
        How the mesh was chosen; without a base all of its cells are those of the threshold.
    mesh
        The mesh.

    Returns
    -------
    arrays
        Flat indices of the cells that were `added` and `left_out`.
    facts
        The threshold of most cells (`base`), the numbers of `cells`, of `added` and `left_out`
        ones, and the Betti numbers (`betti`).
    """
    is_body = np.isin(mesh.kind, (GRID_CELL, INNER_CELL))
    kept = np.zeros(cell_sets.fractions.grid.n_cells, dtype=bool)
    kept[mesh.grid_cell[is_body]] = True
    base, in_base = selection.threshold, kept
    if selection.base is not None:
        base = selection.base
        in_base = cell_sets.at(base).kept.ravel()
    arrays = {
        "added": np.flatnonzero(kept & ~in_base).astype(np.uint32),
        "left_out": np.flatnonzero(in_base & ~kept).astype(np.uint32),
    }
    facts = {
        "base": base,
        "is_local": selection.base is not None,
        "cells": int(kept.sum()),
        **{name: len(cells) for name, cells in arrays.items()},
        "betti": list(selection.predicted),
    }
    return dict(arrays), facts


def offer_wishes(
    cell_sets: CellSets, base: float, order: IntArray
) -> tuple[Arrays, list[dict[str, Any]]]:
    """Return what can be done about the classes of the diagram at a base, and the cells it takes.

    On large grids only some classes have offers, see `tusqh.local_topology.prices.affordable_rows`.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    base
        The threshold.
    order
        Rows of the diagram in the order of the page, shape (pairs,).

    Returns
    -------
    arrays
        `cells`: flat indices of the cells that change; those of offer k start at ``cells_from[k]``.
    offers
        One for each class and way: the `row` of the diagram and its place on the page (`pair`),
        what is done (`do`), whether cells are added (`adds`), the Betti numbers afterwards
        (`betti`), and `why` it is impossible, often empty.
    """
    offers: list[dict[str, Any]] = []
    cells: list[IntArray] = []
    if cell_sets.fractions.grid.n_cells <= MOST_CELLS and cell_sets.at(base).kept.any():
        features = Features(cell_sets, base)
        pair_of = np.argsort(order)
        for wish, adds, done, why in try_wishes(features, affordable_rows(features)):
            changed = np.zeros(0, dtype=np.int64)
            if done is not None:
                is_changed = np.zeros(len(done.kept), dtype=bool)
                is_changed[done.steps[0][1]] = True
                changed = np.flatnonzero(features.space.unflatten(is_changed))
            offer = {"row": wish.row, "pair": int(pair_of[wish.row]), "do": wish.do, "why": why}
            betti = [] if done is None else list(done.betti)
            offers.append(offer | {"adds": adds, "betti": betti})
            cells.append(changed)
    starts = np.cumsum([0, *map(len, cells)])
    arrays: Arrays = {
        "cells_from": starts.astype(np.uint32),
        "cells": np.concatenate([np.zeros(0, dtype=np.int64), *cells]).astype(np.uint32),
    }
    return arrays, offers
