"""Verify a mesh: compare the prediction at a threshold with the measurement."""

from __future__ import annotations

from typing import Any

from tusqh.antialias.cells import CellSet
from tusqh.antialias.scheme import PINCH_TEMPLATES, Scheme
from tusqh.local_topology.move import LocalCells
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.settings.goal import Scope

#: Required columns of results/tables/verification.csv.
VERIFICATION_COLUMNS = (
    ["model", "material", "dimension", "grid", "threshold", "scope", "cells_kept", "elements"]
    + ["contacts", "overruled"]
    + [f"betti_{k}_{how}" for how in ("predicted", "measured") for k in range(3)]
    + ["manifold", "conforming", "min_scaled_jacobian", "holds"]
)


def scope_of(cells: CellSet) -> Scope:
    """Return whether all cells are those of one threshold, or near to those of a base.

    Parameters
    ----------
    cells
        The cells of a mesh.
    """
    return "local" if isinstance(cells, LocalCells) else "global"


def verify_mesh(
    mesh: VolumeMesh, cells: CellSet, *, grid: str, scheme: Scheme = PINCH_TEMPLATES
) -> dict[str, Any]:
    """Return a row of the verification table, with the prediction and the measurement of a mesh.

    Parameters
    ----------
    mesh
        The finished mesh.
    cells
        The cells of which it was made, with the prediction.
    grid
        The grid's shape, such as 60x79.
    scheme
        The meshing scheme, which bounds the scaled Jacobians of the elements.

    Returns
    -------
    verification
        One value for each of `VERIFICATION_COLUMNS`.  `holds` means that the mesh passes every
        check, that its scaled Jacobians are within the bound, and that both methods measure the
        predicted Betti numbers.  This holds trivially for a threshold that keeps no cell.  With
        the local scope the threshold is that of the contacts; other cells are those of the base.
    """
    measured = mesh.measurement
    smallest = measured.smallest_scaled_jacobian
    return {
        "model": mesh.name,
        "material": "all",
        "dimension": mesh.dim,
        "grid": grid,
        "threshold": cells.threshold,
        "scope": scope_of(cells),
        "cells_kept": int(cells.kept.sum()),
        "elements": mesh.n_cells,
        "contacts": cells.n_contacts,
        "overruled": cells.n_overruled,
        **{f"betti_{k}_predicted": n for k, n in enumerate(cells.predicted)},
        **{f"betti_{k}_measured": n for k, n in enumerate(measured.by_euler)},
        "manifold": measured.is_manifold,
        "conforming": measured.is_conforming,
        "min_scaled_jacobian": round(smallest, 9),
        "holds": measured.is_sound
        and measured.has_topology(cells.predicted)
        and scheme.allows(smallest, mesh),
    }
