"""Turn kept cells and decisions into a manifold mesh, and accept bridges by measuring it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import ndimage

from tusqh.antialias.bridges import REJECTED, Bridge
from tusqh.antialias.cells import CellSet
from tusqh.antialias.clusters import CONNECT, NONE, Decisions
from tusqh.antialias.emit import emit_mesh
from tusqh.antialias.pinches import find_pinches
from tusqh.errors import MeshError
from tusqh.grid import BackgroundGrid, BoolArray, IntArray
from tusqh.meshes.facets import find_facets
from tusqh.meshes.manifold import find_non_manifold_points
from tusqh.meshes.volume_mesh import GRID_CELL, VolumeMesh
from tusqh.sampling.fractions import VolumeFractions
from tusqh.topology.betti_numbers import BettiNumbers

#: Upper limit on the rounds that free vertices; random fields need at most 3.
MAX_ROUNDS = 8


@dataclass(frozen=True)
class Resolved:
    """A finished mesh.

    Parameters
    ----------
    mesh
        The mesh.
    cells
        The cells of which it was made, without the rejected bridges.
    closing_rounds
        Number of rounds that freed vertices, see `resolve`.
    """

    mesh: VolumeMesh
    cells: CellSet
    closing_rounds: int


def build_mesh(cells: CellSet, grid: BackgroundGrid, *, name: str = "mesh") -> Resolved:
    """Return the manifold mesh of a cell set, with all acceptable bridges.

    Bridges are accepted if, in the measured mesh, each of them either joins two components or adds
    a hole, as predicted.  All are tried together; if the measurement disagrees, they are tried one
    by one.

    Parameters
    ----------
    cells
        Kept cells, decisions and bridges.
    grid
        The background grid.
    name
        The model, for messages.

    Raises
    ------
    MeshError
        As in `resolve`, for the mesh without bridges.
    """
    mesh, n_rounds = resolve(cells.kept, cells.decisions, grid, name=name)
    if not cells.bridges:
        return Resolved(mesh, cells, n_rounds)
    without = cells.with_bridges([], cells.bridge_table)
    accepted = _accept(without, cells.bridges, cells, mesh, grid)
    if accepted is not None:
        return accepted
    done = Resolved(mesh, without, n_rounds)
    table = cells.bridge_table.copy()
    for bridge in cells.bridges:
        tried = done.cells.with_bridges([*done.cells.bridges, bridge], table)
        accepted = _accept(done.cells, [bridge], tried, done.mesh, grid)
        if accepted is None:
            table.loc[bridge.row, "status"] = REJECTED
        else:
            done = accepted
    return Resolved(
        done.mesh, done.cells.with_bridges(done.cells.bridges, table), done.closing_rounds
    )


def _accept(
    before: CellSet,
    bridges: Sequence[Bridge],
    after: CellSet,
    mesh: VolumeMesh,
    grid: BackgroundGrid,
) -> Resolved | None:
    """Return the mesh with further bridges if its Betti numbers changed as predicted."""
    try:
        joined, n_rounds = resolve(
            after.kept,
            after.decisions,
            grid,
            bridges=[bridge.vertices for bridge in after.bridges],
            name=mesh.name,
        )
    except MeshError:
        return None
    n_joining = before.predicted.betti_0 - after.predicted.betti_0
    was = mesh.measurement.by_euler
    expected = BettiNumbers(
        was.betti_0 - n_joining, was.betti_1 + len(bridges) - n_joining, was.betti_2
    )
    return Resolved(joined, after, n_rounds) if joined.measurement.by_euler == expected else None


def resolve(
    kept: BoolArray,
    decisions: Decisions,
    grid: BackgroundGrid,
    *,
    bridges: Sequence[IntArray] = (),
    name: str = "mesh",
) -> tuple[VolumeMesh, int]:
    """Return the manifold mesh of kept cells and the number of rounds that freed vertices.

    Grid vertices squeezed between two templates are freed: each takes the decision of its nearest
    pinch (algorithm 4.4).

    Parameters
    ----------
    kept
        Kept cells, shape n.
    decisions
        The decisions at their pinches.
    grid
        The background grid, of shape n.
    bridges
        Paths of grid vertices along which strips join components, shape (m, 2) each.
    name
        The model, for messages.

    Raises
    ------
    MeshError
        Vertices are still squeezed after `MAX_ROUNDS` rounds, which is an internal error.

    Returns
    -------
    mesh
        The mesh.
    n_rounds
        Number of rounds that freed vertices.

    Examples
    --------
    >>> import numpy as np
    >>> from tusqh.antialias.clusters import decide_by_vote
    >>> from tusqh.antialias.pinches import find_pinches
    >>> kept = np.eye(2, dtype=bool)
    >>> pinches = find_pinches(kept)
    >>> grid = BackgroundGrid(shape=(2, 2), cell_size=1.0, origin=(0.0, 0.0))
    >>> mesh, rounds = resolve(kept, decide_by_vote(pinches, pinches), grid)
    >>> mesh.n_cells, rounds
    (6, 0)
    """
    at_vertex = decisions.at_vertex.copy()
    is_freed = np.zeros(at_vertex.shape, dtype=bool)
    is_pinch = find_pinches(kept).ravel()
    for n_rounds in range(MAX_ROUNDS + 1):
        mesh, grid_vertex = emit_mesh(
            kept, at_vertex, grid, bridges=bridges, is_freed=is_freed, name=name
        )
        bad = _find_bad_points(mesh, grid_vertex, is_pinch)
        if len(bad) == 0:
            return mesh, n_rounds
        squeezed = grid_vertex[bad][grid_vertex[bad] >= 0]
        is_new = ~is_freed.ravel()[squeezed]
        if not is_new.any() or not at_vertex.any():
            break
        _, nearest = ndimage.distance_transform_edt(at_vertex == NONE, return_indices=True)
        at_vertex.ravel()[squeezed] = at_vertex[tuple(nearest)].ravel()[squeezed]
        is_freed.ravel()[squeezed] = True
    raise MeshError(
        f"{len(bad)} boundary points are non-manifold after {n_rounds} rounds of freeing, "
        f"the first at {mesh.points[bad[0]].tolist()}",
        where=name,
        expected="a manifold mesh",
        remedy="this is an error in tusqh: please report it with the fractions file",
    )


def _find_bad_points(mesh: VolumeMesh, grid_vertex: IntArray, is_pinch: BoolArray) -> IntArray:
    """Return the boundary points at which the boundary is not a manifold.

    Only pinches and points of templates can be such points, so only their elements are examined.
    """
    suspect = np.zeros(len(mesh.points), dtype=bool)
    suspect[mesh.cells[mesh.kind != GRID_CELL].ravel()] = True
    of_grid = grid_vertex >= 0
    suspect[of_grid] |= is_pinch[grid_vertex[of_grid]]
    near = mesh.cells[suspect[mesh.cells].any(axis=1)]
    bad = find_non_manifold_points(find_facets(near))
    return bad[suspect[bad]]


def describe_mesh(resolved: Resolved, fractions: VolumeFractions) -> dict[str, Any]:
    """Return the facts about a mesh for tables, as plain numbers for JSON.

    Parameters
    ----------
    resolved
        The mesh and its cells.
    fractions
        The volume fractions from which it was made.
    """
    mesh, cells, grid = resolved.mesh, resolved.cells, fractions.grid
    n_removed = cells.n_removed
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
        "clusters_overruled": cells.decisions.clusters_overruled,
        "bridges": cells.n_bridges,
        "removed_components": n_removed,
        "filled_holes": cells.n_filled,
        "volume": mesh.measurement.volume,
        "winding_volume": fractions.volume(),
        "closing_rounds": resolved.closing_rounds,
        "betti_predicted": list(cells.predicted),
        "betti_measured": list(mesh.measurement.by_euler),
    }
