"""Enumerate the pinches of the plane and of space, and resolve them by templates.

Paper: Anti-aliasing, figures of all pinches, of pinches in series and of connecting edges.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pandas as pd

from studies.examples import (
    GEOMETRY,
    INTERIOR_VERTEX,
    mesh_facts,
    mesh_rows,
    shape_rows,
    sub_cell_rows,
)
from studies.methods.exact_fractions import Polygon, exact_fractions
from studies.methods.raw_mesh import raw_mesh
from tusqh.antialias.cells import CellSet, CellSets
from tusqh.antialias.pinches import find_pinch_edges, find_pinches, pinch_table
from tusqh.antialias.resolve import build_mesh
from tusqh.contacts.one_material import MATERIAL
from tusqh.grid import BackgroundGrid, BoolArray, doubled
from tusqh.meshes.volume_mesh import KINDS, VolumeMesh
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Policy

STAGES = ("raw", "separated", "connected")

#: The thresholds of the paper's figure of connecting edges.
THRESHOLDS = (1.0, 0.75, 0.5, 0.25)

#: Columns of the elements of the catalogue; the missing corners of quads are empty.
_CORNERS = [f"{axis}{k}" for k in range(8) for axis in "xyz"]


def list_configurations(dim: int) -> list[BoolArray]:
    """Return one neighbourhood of ``2**dim`` cells for each kind of pinch, by number of cells.

    Neighbourhoods that are equal up to rotation and reflection belong to the same kind.

    Parameters
    ----------
    dim
        Dimension, 2 or 3.

    Examples
    --------
    >>> len(list_configurations(2)), len(list_configurations(3))
    (1, 11)
    """
    smallest = set()
    flips = list(itertools.product((slice(None), slice(None, None, -1)), repeat=dim))
    for code in np.flatnonzero(pinch_table(dim)):
        cells = _cells_of(int(code), dim)
        smallest.add(
            min(
                _code_of(cells.transpose(axes)[flip])
                for axes in itertools.permutations(range(dim))
                for flip in flips
            )
        )
    configurations = [_cells_of(code, dim) for code in smallest]
    return sorted(configurations, key=lambda c: (c.sum(), _code_of(c)))


def tabulate_catalogue() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the facts and elements of each raw configuration and of both its decisions.

    Raw cells are not manifold (`sound` is false), and are joined where the prediction separates
    them.

    Returns
    -------
    facts, elements
        One row per configuration and decision, and one row per element.
    """
    facts, elements = [], []
    for dim in (2, 3):
        grid = BackgroundGrid(shape=(2,) * dim, cell_size=1.0, origin=(0.0,) * dim)
        for number, kept in enumerate(list_configurations(dim), start=1):
            for stage in STAGES:
                cells = decide_by_votes(kept, stage == "connected", grid)
                mesh = raw_mesh(kept) if stage == "raw" else build_mesh(cells, grid).mesh
                name = {"dimension": dim, "case": number, "stage": stage}
                facts.append(
                    {
                        **name,
                        "cells": int(kept.sum()),
                        "pinch_edges": _count_pinch_edges(kept),
                        "overruled": cells.n_overruled,
                        **mesh_facts(mesh, cells.predicted),
                        "min_scaled_jacobian": _smallest_jacobian(mesh),
                    }
                )
                elements.append(_element_rows(name, mesh))
    return pd.DataFrame(facts), pd.concat(elements, ignore_index=True)


def decide_by_votes(kept: BoolArray, votes: BoolArray | bool, grid: BackgroundGrid) -> CellSet:
    """Return kept cells whose contacts are decided by given votes, without bridges.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    votes
        Whether each place of the doubled grid votes to connect, shape ``2 n + 1``, or one value
        for all places.
    grid
        The background grid.
    """
    values = np.zeros(tuple(2 * n + 1 for n in kept.shape))
    values[...] = votes
    values[doubled.cells(kept.ndim)] = kept
    fractions = VolumeFractions.from_values(grid, 4, values)
    return CellSets(fractions, Policy(bridges="none")).at(0.5)


def _count_pinch_edges(kept: BoolArray) -> int:
    if kept.ndim == 2:
        return 0
    return sum(int(find_pinch_edges(kept, axis).sum()) for axis in range(3))


def _smallest_jacobian(mesh: VolumeMesh) -> float:
    return round(mesh.measurement.smallest_scaled_jacobian, 6)


def _element_rows(name: dict[str, Any], mesh: VolumeMesh) -> pd.DataFrame:
    n_corners = mesh.cells.shape[1]
    corners = np.full((mesh.n_cells, 8, 3), np.nan)
    corners[:, :n_corners, : mesh.dim] = mesh.points[mesh.cells]
    table = pd.DataFrame(corners.reshape(mesh.n_cells, 24), columns=_CORNERS)
    table.insert(0, "kind", [KINDS[k] for k in mesh.kind])
    for place, (key, value) in enumerate(name.items()):
        table.insert(place, key, value)
    return table


#: Two staircases of pinches, with cells without pinches between them.
_STAIRS = np.array(
    [[1, 0, 1, 0, 0, 0, 1, 0, 1], [0, 1, 0, 1, 0, 1, 0, 1, 0], [1, 0, 1, 0, 0, 0, 1, 0, 1]],
    dtype=bool,
).T


def resolve_series() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return facts and shapes of pinches in series, each of which follows its own vote.

    The panels show the raw cells; all votes to separate; all votes to connect; one staircase each
    way; and alternating votes.

    Returns
    -------
    facts, shapes
        One row per panel, and one row per shape.
    """
    grid = BackgroundGrid(shape=_STAIRS.shape, cell_size=1.0, origin=(0.0, 0.0))
    pinches = find_pinches(_STAIRS)
    x, y = np.indices(pinches.shape)
    everywhere = np.ones_like(pinches)
    trials = {
        "raw": ~everywhere,
        "separated": ~everywhere,
        "connected": everywhere,
        "one staircase each way": x < pinches.shape[0] / 2,
        "alternating": (x + y) % 2 == 0,
    }
    facts, shapes = [], []
    for panel, votes in trials.items():
        on_doubled = np.zeros(tuple(2 * n + 1 for n in _STAIRS.shape), dtype=bool)
        on_doubled[doubled.vertices(2)] = votes
        cells = decide_by_votes(_STAIRS, on_doubled, grid)
        mesh = raw_mesh(_STAIRS) if panel == "raw" else build_mesh(cells, grid, name=panel).mesh
        facts.append(
            {
                "panel": panel,
                "contacts": cells.n_contacts,
                "votes_to_connect": int((pinches & votes).sum()),
                "joined_contacts": int((cells.decision.contacts.ball == MATERIAL).sum()),
                **mesh_facts(mesh, cells.predicted),
            }
        )
        interior = grid.to_points(np.argwhere(pinches & votes))[:, None]
        shapes += [mesh_rows(panel, mesh), shape_rows(panel, INTERIOR_VERTEX, interior)]
    return pd.DataFrame(facts), pd.concat(shapes, ignore_index=True)


def connect_edges() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return facts and shapes of blocks joined by thin bars, at the paper's four thresholds.

    A bar of width ``w`` along a line of the grid fills the fraction ``w`` of its edges' fictitious
    cells and half as much of the adjacent cells, so for thresholds between the two only its edges
    join the blocks.

    Returns
    -------
    facts, shapes
        One row per threshold, and one row per shape.
    """
    grid = BackgroundGrid(shape=(18, 6), cell_size=1.0, origin=(0.0, 0.0))
    polygons: list[Polygon] = [_box(5 * k + 0.0, 1, 5 * k + 3.0, 5) for k in range(4)]
    polygons += [
        _box(5 * k + 3.0, y - w / 2, 5 * k + 5.0, y + w / 2)
        for k, (y, w) in enumerate(((3, 0.8), (2, 0.55), (4, 0.3)))
    ]
    fractions = exact_fractions(polygons, grid)
    bare = CellSets(fractions, Policy(bridges="none"))
    facts, shapes = [], []
    for threshold in THRESHOLDS:
        panel = f"threshold {threshold:g}"
        cells = CellSets(fractions).at(threshold)
        resolved = build_mesh(cells, grid)
        facts.append(
            {
                "panel": panel,
                "threshold": threshold,
                "cells": int(cells.kept.sum()),
                "raw_components": bare.at(threshold).predicted.betti_0,
                "bridges": resolved.cells.n_bridges,
                **mesh_facts(resolved.mesh, resolved.cells.predicted),
            }
        )
        shapes += [shape_rows(panel, GEOMETRY, np.array(p)[None]) for p in polygons]
        shapes += [mesh_rows(panel, resolved.mesh), sub_cell_rows(panel, fractions, threshold)]
    return pd.DataFrame(facts), pd.concat(shapes, ignore_index=True)


def _box(x0: float, y0: float, x1: float, y1: float) -> Polygon:
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def _cells_of(code: int, dim: int) -> BoolArray:
    """Return the cells of a neighbourhood code, indexed [i, j] or [i, j, k]."""
    bits = np.array([code >> bit & 1 for bit in range(2**dim)], dtype=bool)
    return bits.reshape((2,) * dim).T


def _code_of(cells: BoolArray) -> int:
    bits = cells.T.ravel()
    return int(sum(1 << bit for bit in range(bits.size) if bits[bit]))
