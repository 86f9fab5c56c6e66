"""The cells in which the final mesh differs from its base, and what can be done about classes."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from typing import Any

import numpy as np

from tusqh.antialias.cells import CellSets
from tusqh.contacts.material_fractions import MaterialFractions
from tusqh.contacts.mesh import round_thresholds
from tusqh.explorer.arrays import Arrays
from tusqh.grid import IntArray
from tusqh.local_topology.features import Features
from tusqh.local_topology.material_features import MaterialFeatures
from tusqh.local_topology.material_prices import describe_volumes
from tusqh.local_topology.prices import Tried, affordable_rows, try_wishes
from tusqh.meshes.volume_mesh import GRID_CELL, INNER_CELL, VolumeMesh
from tusqh.pipeline.materials.result import MOST_PLACES
from tusqh.pipeline.select import MOST_CELLS
from tusqh.threshold.selection import Selection

#: What the page says instead of offers.
_TOO_LARGE = "The grid is too large for a list of classes; name them on the command line."


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
    if cell_sets.fractions.grid.n_cells > MOST_CELLS or not cell_sets.at(base).kept.any():
        return _pack_cells([]), []
    features, pair_of = Features(cell_sets, base), np.argsort(order)
    offers: list[dict[str, Any]] = []
    cells: list[IntArray] = []
    for tried in try_wishes(features, affordable_rows(features)):
        changed = np.zeros(0, dtype=np.int64)
        if tried.done is not None:
            is_changed = np.zeros(len(tried.done.kept), dtype=bool)
            is_changed[tried.done.steps[0][1]] = True
            changed = np.flatnonzero(features.space.unflatten(is_changed))
        row = tried.wish.row
        offers.append(_describe(tried, int(pair_of[row])) | {"row": row})
        cells.append(changed)
    return _pack_cells(cells), offers


def offer_material_wishes(
    fractions: MaterialFractions, base: Mapping[str, float]
) -> tuple[Arrays, dict[str, Any]]:
    """Return what can be done about the classes of several materials, and the cells it takes.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    base
        Threshold of every material at the base, by name.

    Returns
    -------
    arrays
        See `offer_wishes`.
    facts
        `classes`, those with offers; `classes_note`, about all of them; and the offers (`wishes`).
        An offer has, beside what `offer_wishes` says, the text for the command line (`option`), the
        change of the volumes (`volumes`), and that of `others`, in words; its Betti numbers are
        those of the material, and `pair` is its place in `classes`.
    """
    facts: dict[str, Any] = {"classes": [], "wishes": [], "classes_note": _TOO_LARGE}
    thresholds = round_thresholds(fractions.names, base)
    labels = fractions.label_cells(thresholds)
    names = [fractions.names[k] for k in np.unique(labels).tolist() if k != fractions.void]
    if fractions.grid.n_cells * len(names) > MOST_PLACES or not names:
        return _pack_cells([]), facts
    features = MaterialFeatures(fractions, thresholds, names)
    rows = affordable_rows(features)
    facts["classes"] = [_describe_class(features, row) for row in rows]
    facts["classes_note"] = (
        f"{len(rows)} of {len(features.classes)} classes, and what can be done about each at the "
        "base, by itself."
    )
    start, cells = features.start(), []
    place = {row: k for k, row in enumerate(rows)}
    for tried in try_wishes(features, rows):
        about, offer = (
            features.classes.iloc[tried.wish.row],
            _describe(tried, place[tried.wish.row]),
        )
        changed = np.zeros(0, dtype=np.int64)
        if tried.done is not None:
            k = int(about["number"])
            changed = np.flatnonzero(tried.done.labels != start.labels)
            offer |= {
                "betti": list(tried.done.of(k)),
                "volumes": describe_volumes(features, start, tried.done),
                "others": features.others(start.betti, tried.done.betti, k),
            }
        option = shlex.quote(f"{about['material']}:{about['row']}")
        facts["wishes"].append(offer | {"option": option})
        cells.append(changed)
    return _pack_cells(cells), facts


def _describe(tried: Tried[Any], pair: int) -> dict[str, Any]:
    """Return an offer as plain values."""
    return {
        "pair": pair,
        "do": tried.wish.do,
        "why": tried.why,
        "adds": tried.adds,
        "betti": [] if tried.done is None else list(tried.done.betti),
    }


def _describe_class(features: MaterialFeatures, row: int) -> dict[str, Any]:
    """Return a class of a material as plain values."""
    about = features.classes.iloc[row]
    return {
        "material": str(about["material"]),
        "class": str(about["class"]),
        "row": int(about["row"]),
        "birth": float(about["birth"]),
        "death": float(about["death"]),
        "is_there": bool(about["is_there"]),
        "point": features.points[row].tolist(),
    }


def _pack_cells(cells: list[IntArray]) -> Arrays:
    """Return lists of cells as one, with the start of each."""
    return {
        "cells_from": np.cumsum([0, *map(len, cells)]).astype(np.uint32),
        "cells": np.concatenate([np.zeros(0, dtype=np.int64), *cells]).astype(np.uint32),
    }
