"""Turn the cells of a threshold into a manifold mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tusqh.antialias.cells import CellSet
from tusqh.contacts.decide import emit_decision
from tusqh.contacts.one_material import VOID
from tusqh.grid import BackgroundGrid
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.sampling.reference import Sampled


@dataclass(frozen=True)
class Resolved:
    """A finished mesh.

    Parameters
    ----------
    mesh
        The mesh.
    cells
        The cells of which it was made.
    """

    mesh: VolumeMesh
    cells: CellSet


def build_mesh(cells: CellSet, grid: BackgroundGrid, *, name: str = "mesh") -> Resolved:
    """Return the manifold mesh of a cell set.

    Parameters
    ----------
    cells
        Kept cells, decisions and bridges.
    grid
        The background grid.
    name
        The model, for messages.

    Examples
    --------
    >>> import numpy as np
    >>> from tusqh.antialias.cells import CellSets
    >>> from tusqh.sampling.fractions import VolumeFractions
    >>> values = np.zeros((5, 5))
    >>> values[1, 1] = values[3, 3] = 1.0
    >>> grid = BackgroundGrid(shape=(2, 2), cell_size=1.0, origin=(0.0, 0.0))
    >>> fractions = VolumeFractions.from_values(grid, 4, values)
    >>> mesh = build_mesh(CellSets(fractions).at(0.5), grid).mesh
    >>> mesh.n_cells, str(mesh.measurement.by_euler)
    (10, '(2, 0, 0)')
    """
    mesh, _ = emit_decision(cells.decision, grid, name, left_out=VOID)
    cells.forget_decision()
    return Resolved(mesh, cells)


def describe_mesh(resolved: Resolved, fractions: Sampled) -> dict[str, Any]:
    """Return the facts about a mesh for tables, as plain numbers for JSON.

    Parameters
    ----------
    resolved
        The mesh and its cells.
    fractions
        The volume fractions from which it was made.
    """
    mesh, cells, grid = resolved.mesh, resolved.cells, fractions.grid
    return {
        "model": mesh.name,
        "dimension": mesh.dim,
        "grid": grid.label,
        "cell_size": grid.cell_size,
        **({"sides": list(grid.sides)} if grid.frame.sides else {}),
        **({"axes": grid.frame.to_dict()["axes"]} if grid.frame.axes else {}),
        "cells_kept": int(cells.kept.sum()),
        "elements": mesh.n_cells,
        "points": mesh.n_points,
        "contacts": cells.n_contacts,
        "overruled": cells.n_overruled,
        "bridges": cells.n_bridges,
        "removed_components": cells.n_removed,
        "filled_holes": cells.n_filled,
        "volume": mesh.measurement.volume,
        "winding_volume": fractions.volume(),
        "betti_predicted": list(cells.predicted),
        "betti_measured": list(mesh.measurement.by_euler),
    }
