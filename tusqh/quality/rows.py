"""One model as a row: of the verification at a threshold, of the summary over all models."""

from __future__ import annotations

from typing import Any

import pandas as pd

from tusqh.antialias.cells import CellSet
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.checks import check_mesh
from tusqh.meshes.jacobians import corner_jacobians
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.quality.verdict import SCALED_JACOBIAN, overall

#: Required columns of results/tables/verification.csv.
VERIFICATION_COLUMNS = (
    ["model", "dimension", "grid", "threshold", "cells_kept", "elements"]
    + ["pinch_clusters", "clusters_overruled"]
    + [f"betti_{k}_{how}" for how in ("predicted", "measured") for k in range(3)]
    + ["manifold", "conforming", "min_scaled_jacobian", "holds"]
)

_CONFORMITY = {
    "corner indices out of range",
    "unused points",
    "repeated points",
    "repeated elements",
    "facets shared by more than two elements",
    "hanging nodes",
}


def verification_row(mesh: VolumeMesh, cells: CellSet, *, grid: str) -> dict[str, Any]:
    """Return one row of the verification table: what was predicted and what the mesh has.

    `holds` means: sound by every check, scaled Jacobians within the bound, and the predicted
    Betti numbers measured by both methods.  A threshold that keeps no cell holds trivially.

    Parameters
    ----------
    mesh
        The finished mesh.
    cells
        The cells it was made of, with the prediction.
    grid
        The grid's shape, as 60x79.
    """
    checks = {check.name: bool(check.holds) for check in check_mesh(mesh)}
    measured = betti_by_euler(mesh)
    scaled = corner_jacobians(mesh.points, mesh.cells)[1]
    smallest = float(scaled.min(initial=1.0))
    holds = (
        all(checks.values())
        and measured == betti_by_boundary(mesh) == cells.predicted
        and smallest >= SCALED_JACOBIAN[mesh.dim] - 1e-8
    )
    values = [
        *(mesh.name, mesh.dim, grid, cells.threshold, int(cells.kept.sum()), mesh.n_cells),
        *(cells.decisions.n_clusters, cells.decisions.n_overruled_clusters),
        *cells.predicted,
        *measured,
        checks.get("non-manifold boundary points", False),
        all(ok for name, ok in checks.items() if name in _CONFORMITY),
        round(smallest, 9),
        holds,
    ]
    return dict(zip(VERIFICATION_COLUMNS, values, strict=True))


def summary_row(
    mesh_facts: dict[str, Any], verdict: pd.DataFrame, mass: pd.DataFrame, defects: pd.DataFrame
) -> dict[str, Any]:
    """Return one row of the summary over all models.

    Parameters
    ----------
    mesh_facts
        The facts that the mesh step wrote, see `workflow/scripts/mesh.py`.
    verdict
        The checks of the mesh.
    mass
        The table of the simulation's snapshots.
    defects
        The defects of the geometry; where a surface is balanced its signed volume is exact.
    """
    count = dict(zip(defects["defect"], defects["count"], strict=True))
    winding_over_exact = float("nan")
    if count.get("unbalanced_edges") == 0:
        exact = float(defects.loc[defects["defect"] == "signed_volume", "measure"].iloc[0])
        winding_over_exact = mesh_facts["winding_volume"] / abs(exact)
    found = dict(zip(verdict["name"], verdict["found"], strict=True))
    return {
        "model": mesh_facts["model"],
        "grid": mesh_facts["grid"],
        "cells": mesh_facts["cells_kept"],
        "elements": mesh_facts["elements"],
        "threshold": mesh_facts["threshold"],
        "margin": mesh_facts["margin"],
        "betti_predicted": str(tuple(mesh_facts["betti_predicted"])),
        "betti_measured": str(tuple(mesh_facts["betti_measured"])),
        "pinches": mesh_facts["pinches"],
        "pinch_clusters": mesh_facts["pinch_clusters"],
        "clusters_overruled": mesh_facts["clusters_overruled"],
        "bridges": mesh_facts["bridges"],
        "removed_components": mesh_facts["removed_components"],
        "filled_holes": mesh_facts["filled_holes"],
        "volume_over_winding": mesh_facts["volume"] / mesh_facts["winding_volume"],
        "winding_over_exact": winding_over_exact,
        "min_scaled_jacobian": float(found.get("smallest scaled Jacobian", "nan")),
        "amount_relative_error": float(mass["amount_relative_error"].abs().max()),
        "verdict": overall(verdict),
    }
