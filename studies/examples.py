"""Mesh the paper's small examples in the plane with exact fractions, and tabulate their shapes.

A table of shapes has one row per shape, with the columns of `SHAPE_COLUMNS`.  Polygons have up to
four corners, edges of the grid two and vertices one; missing corners are empty.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from studies.methods.digital_topology import closed_betti
from studies.methods.exact_fractions import Polygon, exact_fractions
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.contacts.one_material import MATERIAL
from tusqh.grid import QUAD_CORNERS, BackgroundGrid, BoolArray, FloatArray, doubled
from tusqh.meshes.volume_mesh import KINDS, VolumeMesh
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Policy
from tusqh.topology.betti_numbers import BettiNumbers

SHAPE_COLUMNS = ["panel", "shape", *(f"{axis}{k}" for k in range(4) for axis in "xy")]

#: Names of shapes that are not elements; elements are named by their kind.
GEOMETRY = "geometry"
KEPT = "kept cell"
INTERIOR_EDGE = "interior edge"
INTERIOR_VERTEX = "interior vertex"


def shape_rows(panel: str, shape: str, corners: FloatArray) -> pd.DataFrame:
    """Return shapes as rows.

    Parameters
    ----------
    panel, shape
        The panel in which they are drawn, and their kind.
    corners
        Corners, shape (m, k, 2) with k at most 4, in model units.
    """
    flat = np.full((len(corners), 8), np.nan)
    flat[:, : 2 * corners.shape[1]] = corners.reshape(len(corners), 2 * corners.shape[1])
    table = pd.DataFrame(flat, columns=SHAPE_COLUMNS[2:])
    table.insert(0, "shape", shape)
    table.insert(0, "panel", panel)
    return table


def mesh_rows(panel: str, mesh: VolumeMesh) -> pd.DataFrame:
    """Return the elements of a quad mesh as shapes named by their kind.

    Parameters
    ----------
    panel
        Name of the panel.
    mesh
        The mesh.
    """
    return pd.concat(
        [
            shape_rows(panel, kind, mesh.points[mesh.cells[mesh.kind == k]])
            for k, kind in enumerate(KINDS)
            if (mesh.kind == k).any()
        ],
        ignore_index=True,
    )


def cell_rows(panel: str, kept: BoolArray, grid: BackgroundGrid) -> pd.DataFrame:
    """Return the kept cells of a grid in the plane as shapes.

    Parameters
    ----------
    panel
        Name of the panel.
    kept
        Whether each cell is kept, shape n.
    grid
        The background grid.
    """
    corners = np.argwhere(kept)[:, None] + QUAD_CORNERS
    return shape_rows(panel, KEPT, grid.to_points(corners.reshape(-1, 2)).reshape(-1, 4, 2))


def sub_cell_rows(panel: str, fractions: VolumeFractions, threshold: float) -> pd.DataFrame:
    """Return the interior edges and vertices as shapes.

    Parameters
    ----------
    panel
        Name of the panel.
    fractions
        The volume fractions.
    threshold
        The threshold.
    """
    grid = fractions.grid
    is_interior = fractions.values >= threshold
    edges, vertices = (
        doubled.marked_edges(is_interior),
        np.argwhere(is_interior[doubled.vertices(2)]),
    )
    tables = [
        shape_rows(panel, INTERIOR_EDGE, grid.to_points(edges)),
        shape_rows(panel, INTERIOR_VERTEX, grid.to_points(vertices[:, None])),
    ]
    return pd.concat(tables, ignore_index=True)


def mesh_example(
    name: str,
    polygons: list[Polygon],
    grid: BackgroundGrid,
    *,
    threshold: float = 0.5,
    policy: Policy | None = None,
) -> tuple[pd.DataFrame, dict[str, Any]]:
    """Return the shapes and facts of an example before and after anti-aliasing.

    Parameters
    ----------
    name
        The example; its panels are ``<name>: before`` and ``<name>: after``.
    polygons
        Geometry of the example: triangles or quads that do not overlap, counter-clockwise.
    grid
        The background grid.
    threshold
        Volume-fraction threshold, dimensionless.
    policy
        The policy for bridges and features.

    Returns
    -------
    shapes, facts
        One row per shape, and the facts of the example by name.
    """
    fractions = exact_fractions(polygons, grid)
    cells = CellSets(fractions, policy).at(threshold)
    resolved = build_mesh(cells, grid, name=name)
    kept = fractions.cells >= threshold
    before, after = f"{name}: before", f"{name}: after"
    outlines = [np.array(polygon, dtype=np.float64)[None] for polygon in polygons]
    shapes = pd.concat(
        [
            *(shape_rows(panel, GEOMETRY, o) for panel in (before, after) for o in outlines),
            cell_rows(before, kept, grid),
            sub_cell_rows(before, fractions, threshold),
            mesh_rows(after, resolved.mesh),
        ],
        ignore_index=True,
    )
    raw = closed_betti(kept)
    facts = {
        "example": name,
        "threshold": threshold,
        "cells": int(kept.sum()),
        "contacts": cells.n_contacts,
        "components_before": raw.betti_0,
        "holes_before": raw.betti_1,
        "joined_contacts": int((cells.decision.contacts.ball == MATERIAL).sum()),
        "bridges": resolved.cells.n_bridges,
        "removed_components": cells.n_removed,
        **mesh_facts(resolved.mesh, resolved.cells.predicted),
    }
    return shapes, facts


def mesh_facts(mesh: VolumeMesh, predicted: BettiNumbers) -> dict[str, Any]:
    """Return the measured topology of a mesh, and whether it is sound and as predicted.

    Parameters
    ----------
    mesh
        The mesh.
    predicted
        The predicted Betti numbers.
    """
    measured, betti = mesh.measurement, mesh.measurement.by_euler
    return {
        "elements": mesh.n_cells,
        "components": betti.betti_0,
        "holes": betti.betti_1,
        "voids": betti.betti_2,
        "as_predicted": measured.has_topology(predicted),
        "sound": measured.is_sound,
    }
