"""The kept cells of a background at a threshold, with the decision of every pinch."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.background.curves import BackgroundTopology
from tusqh.background.node_values import NodeValues
from tusqh.background.pinches import Pinches, find_pinches
from tusqh.grid import BoolArray
from tusqh.sampling.fractions import to_level
from tusqh.topology.betti_numbers import BettiNumbers


@dataclass(frozen=True)
class BackgroundCells:
    """Kept cells whose pinch vertices and edges each follow their own vote.

    Parameters
    ----------
    background
        The background.
    kept
        Whether each cell is kept, shape (m,).
    pinches
        The pinch vertices and edges.
    vertices_connect, edges_connect
        Whether each of them connects; on the rim none does.
    predicted
        Betti numbers of the mesh: those of the listed complex.
    """

    background: BackgroundMesh
    kept: BoolArray
    pinches: Pinches
    vertices_connect: BoolArray
    edges_connect: BoolArray
    predicted: BettiNumbers

    @property
    def n_contacts(self) -> int:
        """Number of pinch vertices and edges."""
        return len(self.pinches.vertices) + len(self.pinches.edges)


class BackgroundCellSets:
    """The cells of every threshold.

    Parameters
    ----------
    background
        The background.
    values
        Fractions of its nodes.

    Examples
    --------
    Two quads meet in a vertex whose own fraction connects them up to the threshold 1/4.

    >>> from tusqh.background.makers import make_box
    >>> full, quarter = 2**20, 2**18
    >>> vertices = np.zeros(25, dtype=np.int32)
    >>> vertices[12] = quarter
    >>> cells = np.zeros(16, dtype=np.int32)
    >>> cells[[5, 10]] = full
    >>> values = NodeValues(cells, np.zeros(0, dtype=np.int32), vertices)
    >>> sets = BackgroundCellSets(make_box((0, 0), (4, 4), (4, 4)), values)
    >>> [(str(sets.at(t).predicted), sets.at(t).n_contacts) for t in (0.5, 0.25)]
    [('(2, 0, 0)', 1), ('(1, 0, 0)', 1)]
    """

    def __init__(self, background: BackgroundMesh, values: NodeValues) -> None:
        self.background = background
        self.values = values

    @cached_property
    def topology(self) -> BackgroundTopology:
        """The topology of the filtration."""
        return BackgroundTopology(self.background, self.values)

    def at(self, threshold: float) -> BackgroundCells:
        """Return the cells of a threshold in (0, 1].

        Parameters
        ----------
        threshold
            Volume fraction, dimensionless.
        """
        level, clamped = to_level(threshold), self.topology.values
        kept = np.asarray(clamped.cells >= level)
        pinches = find_pinches(self.background, kept)
        return BackgroundCells(
            self.background,
            kept,
            pinches,
            np.asarray(clamped.vertices[pinches.vertices] >= level),
            np.asarray(clamped.edges[pinches.edges] >= level),
            self.topology.betti_at(threshold),
        )
