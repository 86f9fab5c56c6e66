"""Decide all contacts of labelled cells, and emit the mesh, in both dimensions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tusqh.contacts.decided import Labels
from tusqh.contacts.emit_spatial import emit_spatial
from tusqh.contacts.planar import PlanarDecision, decide_balls, emit_planar
from tusqh.contacts.spatial import SpatialDecision, decide_sticks
from tusqh.contacts.surround import inner_cells, surround
from tusqh.contacts.votes import Fractions
from tusqh.grid import BackgroundGrid, IntArray
from tusqh.meshes.volume_mesh import VolumeMesh

Decision = PlanarDecision | SpatialDecision


def decide_contacts(fractions: Fractions, labels: Labels, thresholds: IntArray) -> Decision:
    """Return the decision of every contact between the cells of a grid.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    labels
        Material of every cell, shape n.
    thresholds
        Threshold of every material, in multiples of 2**-20, shape (m,).
    """
    padded = surround(labels, fractions.void)
    if labels.ndim == 3:
        return decide_sticks(fractions, padded, thresholds)
    return PlanarDecision(padded, decide_balls(fractions, padded, thresholds))


def emit_decision(
    decision: Decision, grid: BackgroundGrid, name: str, *, left_out: int | None = None
) -> tuple[VolumeMesh, IntArray]:
    """Return the mesh of decided cells, and the material of every element.

    Parameters
    ----------
    decision
        The decisions of all contacts.
    grid
        The background grid, of shape n.
    name
        The model, for messages.
    left_out
        A material without elements, such as the void; None: all have elements.

    Returns
    -------
    mesh
        The mesh; elements in the layers of void have the grid cell -1.
    material
        Material of every element, shape (m,).
    """
    if isinstance(decision, PlanarDecision):
        emitted = emit_planar(decision, grid.padded(), name, left_out=left_out)
    else:
        emitted = emit_spatial(decision, grid.padded().padded(), name, left_out=left_out)
    material = emitted.material.astype(np.int64)
    return _renumber(emitted.mesh, decision.labels.shape), material


def _renumber(mesh: VolumeMesh, shape: tuple[int, ...]) -> VolumeMesh:
    """Return a mesh of a padded grid with cell numbers of the grid itself, -1 for other cells."""
    number = np.full(shape, -1, dtype=mesh.grid_cell.dtype)
    within = number[inner_cells(len(shape))]
    within[...] = np.arange(within.size, dtype=number.dtype).reshape(within.shape)
    return replace(mesh, grid_cell=number.ravel()[mesh.grid_cell])
