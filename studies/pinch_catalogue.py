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
from tusqh.antialias.cells import CellSets
from tusqh.antialias.clusters import CONNECT, SEPARATE, Decisions, decide_by_vote
from tusqh.antialias.pinches import find_pinch_edges, find_pinches, pinch_table
from tusqh.antialias.resolve import build_mesh, resolve
from tusqh.grid import BackgroundGrid, BoolArray
from tusqh.meshes.volume_mesh import KINDS, VolumeMesh
from tusqh.settings.policy import MixedPinches
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.effective import effective_betti

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
            pinches = find_pinches(kept)
            for stage in STAGES:
                votes = np.full(pinches.shape, stage == "connected")
                decisions = decide_by_vote(pinches, votes)
                rounds = 0
                if stage == "raw":
                    mesh = raw_mesh(kept)
                else:
                    mesh, rounds = resolve(kept, decisions, grid, name="pinch")
                name = {"dimension": dim, "case": number, "stage": stage}
                facts.append(
                    {
                        **name,
                        "cells": int(kept.sum()),
                        "pinch_edges": _count_pinch_edges(kept),
                        "closing_rounds": rounds,
                        **mesh_facts(mesh, _effective(kept, decisions)),
                        "min_scaled_jacobian": _smallest_jacobian(mesh),
                    }
                )
                elements.append(_element_rows(name, mesh))
    return pd.DataFrame(facts), pd.concat(elements, ignore_index=True)


def _effective(kept: BoolArray, decisions: Decisions) -> BettiNumbers:
    at_vertex = decisions.at_vertex
    return effective_betti(kept, at_vertex == CONNECT, at_vertex == SEPARATE)


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


#: Two staircases of pinches, hence two clusters, with cells without pinches between them.
_STAIRS = np.array(
    [[1, 0, 1, 0, 0, 0, 1, 0, 1], [0, 1, 0, 1, 0, 1, 0, 1, 0], [1, 0, 1, 0, 0, 0, 1, 0, 1]],
    dtype=bool,
).T


def resolve_series() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return facts and shapes of pinches in series, which form two clusters.

    The panels show the raw cells; all votes to separate; all votes to connect; one cluster each way
    (`both`); and, in the last two panels, alternating votes, which the policy for mixed clusters
    decides.

    Returns
    -------
    facts, shapes
        One row per panel, and one row per shape.
    """
    grid = BackgroundGrid(shape=_STAIRS.shape, cell_size=1.0, origin=(0.0, 0.0))
    pinches = find_pinches(_STAIRS)
    x, y = np.indices(pinches.shape)
    left, every_other = x < pinches.shape[0] / 2, (x + y) % 2 == 0
    everywhere = np.ones_like(pinches)
    trials: list[tuple[str, BoolArray, MixedPinches]] = [
        ("raw", ~everywhere, "separate"),
        ("separated", ~everywhere, "separate"),
        ("connected", everywhere, "separate"),
        ("both", left, "separate"),
        ("mixed: separate", every_other, "separate"),
        ("mixed: connect", every_other, "connect"),
    ]
    facts, shapes = [], []
    for panel, votes, policy in trials:
        decisions = decide_by_vote(pinches, votes, mixed_pinches=policy)
        is_raw = panel == "raw"
        mesh = raw_mesh(_STAIRS) if is_raw else resolve(_STAIRS, decisions, grid, name=panel)[0]
        facts.append(
            {
                "panel": panel,
                "pinches": decisions.n_pinches,
                "votes_to_connect": int((pinches & votes).sum()),
                "clusters": decisions.n_clusters,
                "clusters_overruled": decisions.clusters_overruled,
                "pinches_connected": int((decisions.at_vertex == CONNECT).sum()),
                **mesh_facts(mesh, _effective(_STAIRS, decisions)),
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
                "raw_components": _effective(cells.kept, cells.decisions).betti_0,
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
