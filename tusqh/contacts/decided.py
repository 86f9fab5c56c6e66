"""The decided contacts of a grid, from which the topology follows before meshing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tusqh.grid import IntArray

Labels = NDArray[np.int32]


@dataclass(frozen=True)
class Contacts:
    """The decided contacts of a grid.

    Parameters
    ----------
    vertex_cells
        Flat cells around every pinched vertex, in cyclic order in 2D and in the order of octants
        in 3D, shape (p, 2**dim).
    ball
        Material of the ball at each vertex, shape (p,).
    sticks
        In 3D, the materials of the sticks at the six half-edges of each vertex, shape (p, 6).
    edge_cells
        In 3D, the flat cells around every pinched edge in cyclic order, shape (e, 4).
    edge_material
        Material of the stick along each edge, shape (e,).
    """

    vertex_cells: IntArray
    ball: Labels
    sticks: Labels
    edge_cells: IntArray
    edge_material: Labels

    def __len__(self) -> int:
        """Return the number of contacts."""
        return len(self.ball) + len(self.edge_material)
