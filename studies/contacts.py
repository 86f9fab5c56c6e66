"""Compare the meshes of a model with its persistence diagram, over the thresholds of the sweep.

Every pinched vertex and edge is a contact that should follow the vote of its sub-cell.  If all do,
the mesh has the Betti numbers that the diagram gives at the threshold.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.contacts.spatial import SpatialDecision
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Policy
from tusqh.topology.persistence import betti_at


def tabulate_contacts(
    fractions: VolumeFractions, curves: pd.DataFrame, thresholds: Sequence[float], *, name: str
) -> pd.DataFrame:
    """Return the contacts of a model's meshes, without bridges and with all features.

    Parameters
    ----------
    fractions
        Volume fractions.
    curves
        Betti numbers of the filtration, see `tusqh.topology.topology.Topology.curves`.
    thresholds
        Volume-fraction thresholds.
    name
        The model.

    Returns
    -------
    contacts
        One row per threshold: `model`, `dimension`, `threshold`; the numbers of contacts
        (`pinches`), of votes that the mesh does not follow (`overruled`) and of vertices with
        elements of their own, where sticks cannot realise the votes (`fallback`); of elements
        (`hexes`; quads in the plane) and of kept cells (`hexes_plain`); and whether both
        measurements of the mesh equal the diagram (`equals_diagram`).
    """
    cell_sets = CellSets(fractions, Policy(bridges="none"))
    rows: list[dict[str, Any]] = []
    for threshold in thresholds:
        cells = cell_sets.at(threshold)
        decision = cells.decision
        n_own = int(decision.field.has_ball.sum()) if isinstance(decision, SpatialDecision) else 0
        mesh = build_mesh(cells, fractions.grid, name=name).mesh
        rows.append(
            {
                "model": name,
                "dimension": fractions.grid.dim,
                "threshold": threshold,
                "pinches": cells.n_contacts,
                "overruled": cells.n_overruled,
                "fallback": n_own,
                "hexes": mesh.n_cells,
                "hexes_plain": int(cells.kept.sum()),
                "equals_diagram": mesh.measurement.has_topology(betti_at(curves, threshold)),
            }
        )
    return pd.DataFrame(rows)
