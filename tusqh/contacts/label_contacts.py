"""Find the contacts of labelled cells and their votes, without the elements that realise them."""

from __future__ import annotations

import numpy as np

from tusqh.contacts.decided import Contacts, Labels
from tusqh.contacts.octants import octants
from tusqh.contacts.planar import PlanarDecision, decide_balls, find_diagonals
from tusqh.contacts.predict import predict_betti
from tusqh.contacts.spatial import to_cells
from tusqh.contacts.spatial_votes import SpatialVotes
from tusqh.contacts.stick_field import find_pinched
from tusqh.contacts.surround import surround
from tusqh.contacts.votes import Fractions
from tusqh.grid import IntArray
from tusqh.topology.betti_numbers import BettiNumbers


def predict_labels(
    fractions: Fractions, labels: Labels, thresholds: IntArray
) -> list[BettiNumbers]:
    """Return the Betti numbers of every material, the void included.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    labels
        Material of every cell, shape n.
    thresholds
        Threshold of every material, in multiples of 2**-20, shape (m,).
    """
    padded = np.ascontiguousarray(surround(labels, fractions.void), dtype=np.int32)
    return predict_betti(padded, find_votes(fractions, padded, thresholds), len(thresholds))


def find_votes(fractions: Fractions, padded: Labels, thresholds: IntArray) -> Contacts:
    """Return the contacts of labelled cells, each with the material for which it votes.

    These are the contacts of `tusqh.contacts.decide.decide_contacts`, which also chooses the
    elements that realise them.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    padded
        Material of every cell, with the layers of void around them, see
        `tusqh.contacts.surround.surround`.
    thresholds
        Threshold of every material, in multiples of 2**-20, shape (m,).
    """
    if padded.ndim == 2:
        return PlanarDecision(padded, decide_balls(fractions, padded, thresholds)).contacts
    votes, tables = SpatialVotes(fractions, padded, thresholds), octants()
    vertices = find_pinched(votes.labels, votes.shape, votes.steps, tables)
    sticks = np.full((len(vertices), 6), -1, dtype=np.int32)
    edge_cells = [np.empty((0, 4), dtype=np.int64)]
    edge_material = [np.empty(0, dtype=np.int32)]
    for axis in range(3):
        step = votes.steps[axis]
        edges = np.unique(np.concatenate([vertices, vertices - step]))
        around, winner = votes.of_edges(axis, edges)
        is_pinched = find_diagonals(around.T)
        edges, winner = edges[is_pinched], winner[is_pinched]
        edge_cells.append(edges[:, None] + votes.octant[tables.around[2 * axis + 1]])
        edge_material.append(winner)
        for side, starts in enumerate((vertices - step, vertices)):
            if len(edges):
                at = np.minimum(np.searchsorted(edges, starts), len(edges) - 1)
                is_edge = edges[at] == starts
                sticks[is_edge, 2 * axis + side] = winner[at[is_edge]]
    return Contacts(
        vertex_cells=to_cells(vertices[:, None] + votes.octant, votes.shape),
        ball=votes.of_vertices(vertices).astype(np.int32),
        sticks=sticks,
        edge_cells=to_cells(np.concatenate(edge_cells), votes.shape),
        edge_material=np.concatenate(edge_material).astype(np.int32),
    )
