"""From volume fractions and a threshold to a manifold mesh and the topology it must have."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from scipy import ndimage

from tusqh.antialias.clusters import (
    CONNECT,
    NONE,
    SEPARATE,
    Decisions,
    MixedPinches,
    decide_by_fraction,
)
from tusqh.antialias.components import remove_small_components
from tusqh.antialias.pinches import find_pinches
from tusqh.antialias.templates_2d import emit_quads
from tusqh.errors import MeshError
from tusqh.grid import BackgroundGrid, BoolArray
from tusqh.mesh.betti import betti_by_euler
from tusqh.mesh.checks import find_non_manifold_points
from tusqh.mesh.facets import find_facets
from tusqh.mesh.volume_mesh import VolumeMesh
from tusqh.sampling.fractions import VolumeFractions
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.effective import effective_betti

#: More rounds of closing than ever seen (3) mean that the scheme itself is broken.
MAX_CLOSING_ROUNDS = 8


@dataclass(frozen=True)
class CellSet:
    """The cells kept at a threshold, with all decisions made and small components gone.

    Parameters
    ----------
    kept
        Kept cells after removal, shape n.
    decisions
        Decisions at the pinches of the cells before removal.
    removed
        One row per removed component, see `remove_small_components`.
    predicted
        Betti numbers that the mesh of these cells must have.
    """

    kept: BoolArray
    decisions: Decisions
    removed: pd.DataFrame
    predicted: BettiNumbers


def keep_cells(
    fractions: VolumeFractions,
    *,
    threshold: float,
    min_cells: int = 1,
    mixed_pinches: MixedPinches = "separate",
) -> CellSet:
    """Return the cells at a threshold, their pinch decisions and the predicted topology.

    Decisions are made once, on all cells.  Removing a component makes no new pinch: the cells
    around a vertex other than a pinch are joined there, so they stay or go together.

    Parameters
    ----------
    fractions
        Volume fractions of cells and sub-cells.
    threshold
        Cells with at least this volume fraction are kept, dimensionless.
    min_cells
        Components with fewer cells are removed; 1 removes nothing.
    mixed_pinches
        What to do with clusters of pinches that disagree.
    """
    kept = fractions.cells >= threshold
    decisions = decide_by_fraction(
        find_pinches(kept), fractions.vertices, threshold=threshold, mixed_pinches=mixed_pinches
    )
    kept, removed = remove_small_components(
        kept, decisions, fractions, threshold=threshold, min_cells=min_cells
    )
    is_pinch = find_pinches(kept)
    decisions = replace(
        decisions, at_vertex=np.where(is_pinch, decisions.at_vertex, NONE).astype(np.int8)
    )
    predicted = effective_betti(
        kept, decisions.at_vertex == CONNECT, decisions.at_vertex == SEPARATE
    )
    return CellSet(kept=kept, decisions=decisions, removed=removed, predicted=predicted)


def resolve(
    kept: BoolArray, decisions: Decisions, grid: BackgroundGrid, *, name: str = "mesh"
) -> tuple[VolumeMesh, int]:
    """Return the manifold mesh of kept cells and the rounds of closing that it took.

    Closing frees grid vertices that are squeezed between two templates: they join with the
    decision of the nearest pinch (algorithm notes 4.4).

    Parameters
    ----------
    kept
        Kept cells, shape n.
    decisions
        What to do at every pinch of them.
    grid
        The background grid, of shape n.
    name
        The model, for messages.

    Raises
    ------
    MeshError
        Closing does not end; an internal error, never a silent result.

    Examples
    --------
    >>> import numpy as np
    >>> from tusqh.antialias.clusters import decide_by_vote
    >>> kept = np.eye(2, dtype=bool)
    >>> pinches = find_pinches(kept)
    >>> grid = BackgroundGrid(shape=(2, 2), cell_size=1.0, origin=(0.0, 0.0))
    >>> mesh, rounds = resolve(kept, decide_by_vote(pinches, pinches), grid)
    >>> mesh.n_cells, rounds
    (6, 0)
    """
    at_vertex = decisions.at_vertex.copy()
    for n_rounds in range(MAX_CLOSING_ROUNDS + 1):
        mesh, grid_vertex = emit_quads(kept, at_vertex, grid, name=name)
        squeezed = grid_vertex[find_non_manifold_points(find_facets(mesh.cells))]
        is_new = (squeezed >= 0) & (at_vertex.ravel()[squeezed] == NONE)
        if len(squeezed) == 0:
            return mesh, n_rounds
        if not is_new.all() or not at_vertex.any():
            break
        _, nearest = ndimage.distance_transform_edt(at_vertex == NONE, return_indices=True)
        at_vertex.ravel()[squeezed] = at_vertex[tuple(nearest)].ravel()[squeezed]
    raise MeshError(
        f"{len(squeezed)} boundary points stay non-manifold after {n_rounds} rounds of closing, "
        f"the first at grid vertex {np.unravel_index(abs(int(squeezed[0])), at_vertex.shape)}",
        where=name,
        expected="a manifold mesh",
        remedy="this is an error in tusqh: please report it with the fractions file",
    )


def describe_mesh(mesh: VolumeMesh, cells: CellSet, grid: BackgroundGrid) -> dict[str, Any]:
    """Return the facts about a mesh that tables quote, as plain numbers for JSON."""
    return {
        "model": mesh.name,
        "dimension": mesh.dim,
        "grid": grid.label,
        "cell_size": grid.cell_size,
        "cells_kept": int(cells.kept.sum()),
        "elements": mesh.n_cells,
        "points": len(mesh.points),
        "pinches": cells.decisions.n_pinches,
        "pinches_connected": int((cells.decisions.at_vertex == CONNECT).sum()),
        "pinch_clusters": cells.decisions.n_clusters,
        "clusters_overruled": cells.decisions.n_overruled_clusters,
        "removed_components": len(cells.removed),
        "betti_predicted": list(cells.predicted),
        "betti_measured": list(betti_by_euler(mesh)),
    }
