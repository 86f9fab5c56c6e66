"""Measure how well fitted meshes hold the creases and corners of solids at random rotations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial import cKDTree

import tusqh
from studies.methods.creased_solids import SOLIDS, CreasedSolid
from tusqh.fitting import Target, fit_mesh
from tusqh.fitting.fitted import Fitted
from tusqh.fitting.of_geometry import target_of
from tusqh.fitting.target import to_cells
from tusqh.grid import FloatArray
from tusqh.sampling.nearest_triangle import find_nearest, make_tree

#: Distance within which a crease or a corner counts as captured, in cells.
NEAR = 0.1
#: Distance between points on creases, in cells.
_STEP = 0.2


def measure_creases(names: Sequence[str], seeds: Sequence[int]) -> pd.DataFrame:
    """Return how well the creases of solids are held, one row for each solid and rotation.

    Parameters
    ----------
    names
        Names of solids, see `studies.methods.creased_solids.SOLIDS`.
    seeds
        Seeds of their rotations.

    Returns
    -------
    table
        `solid`, `seed`, `cells`, `elements`, and what `compare` returns.
    """
    rows = []
    for name in names:
        make, cells = SOLIDS[name]
        for seed in seeds:
            solid = make().turned(seed)
            surface = solid.points, solid.triangles
            result = tusqh.mesh(surface, cells=cells, placement="corner", threshold=0.5)
            assert isinstance(result, tusqh.Result)
            target = target_of(result.geometry, result.fractions)
            fitted = fit_mesh(result.mesh, target, cell_size=target.grid.cell_size)
            row = {"solid": name, "seed": seed, "cells": cells, "elements": fitted.mesh.n_cells}
            rows.append(row | compare(solid, fitted, target))
    return pd.DataFrame(rows)


def compare(solid: CreasedSolid, fitted: Fitted, target: Target) -> dict[str, Any]:
    """Return how far the feature edges of a mesh and the true creases are apart, in cells.

    Parameters
    ----------
    solid
        The solid with its creases.
    fitted
        Its fitted mesh.
    target
        The target of the fit.

    Returns
    -------
    found
        `captured`: share of the creases within `NEAR` of a feature edge; `farthest`: largest
        distance of a crease from one; `path_mean`, `path_max`: distances of the points and middles
        of feature edges from the creases; `corners`: share of the corners that have a point where
        feature edges meet within `NEAR`; `corner_max`; `min_scaled_jacobian`.
    """
    creases = to_cells(solid.creases.reshape(-1, 3), target.grid).reshape(-1, 2, 3)
    corners = to_cells(solid.corners, target.grid)
    points, edges = to_cells(fitted.mesh.points, target.grid), fitted.edges
    away = find_nearest(make_tree(points[edges][:, [0, 1, 1]]), _along(creases)).distance
    on_path = np.concatenate([points[np.unique(edges)], points[edges].mean(axis=1)])
    off = find_nearest(make_tree(creases[:, [0, 1, 1]]), on_path).distance
    meets = np.bincount(edges.ravel(), minlength=len(points)) >= 3
    missed = np.zeros(0)
    if len(corners):
        missed = np.full(len(corners), np.inf)
        if meets.any():
            missed = cKDTree(points[meets]).query(corners)[0]
    return {
        "captured": float((away <= NEAR).mean()),
        "farthest": float(away.max()),
        "path_mean": float(off.mean()) if len(off) else np.nan,
        "path_max": float(off.max()) if len(off) else np.nan,
        "corners": float((missed <= NEAR).mean()) if len(corners) else np.nan,
        "corner_max": float(missed.max()) if len(corners) else np.nan,
        "min_scaled_jacobian": float(fitted.mesh.jacobians.scaled.min()),
    }


def _along(segments: FloatArray) -> FloatArray:
    """Return points along segments, in the middle of equal parts of at most `_STEP`."""
    found = []
    for start, end in segments:
        n = max(int(np.ceil(np.linalg.norm(end - start) / _STEP)), 1)
        found.append(start + (np.arange(n)[:, None] + 0.5) / n * (end - start))
    return np.concatenate(found)
