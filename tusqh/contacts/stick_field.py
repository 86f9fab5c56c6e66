"""The state of a padded grid in 3D, and the vertices where its materials are pinched.

A vertex, the edges that start there, the faces with that lowest corner and the cell above it share
one flat number.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid import FloatArray, IntArray


class Field(NamedTuple):
    """The state of all cells, edges, faces and vertices of a padded grid.

    Parameters
    ----------
    labels
        Material of every cell, shape (n_v,).
    marked
        Vertices whose faces are refined, shape (n_v,).
    sticks
        Material of the stick at every edge with a marked end, shape (3, n_v).
    sides
        Which cell of a refined face owns the rings at its edges without sticks: 0 for the lower, 1
        for the upper cell, shape (3, n_v).
    steps
        Differences between the numbers of neighbours along every axis, shape (3,).
    """

    labels: NDArray[np.int32]
    marked: NDArray[np.bool_]
    sticks: NDArray[np.int32]
    sides: NDArray[np.uint8]
    steps: IntArray


class Costs(NamedTuple):
    """The costs of overruling the votes of pinched vertices and edges.

    Parameters
    ----------
    vertex_row
        Row of every pinched vertex, -1 for other vertices, shape (n_v,).
    vertex_cost
        Cost of the material of each octant, shape (p, 8).
    edge_row
        Row of every pinched edge, -1 for other edges, shape (3, n_v).
    edge_cost
        Cost of the material of each of the four cells, in the order of `Octants.around`,
        shape (e, 4).
    """

    vertex_row: NDArray[np.int32]
    vertex_cost: FloatArray
    edge_row: NDArray[np.int32]
    edge_cost: FloatArray


@numba.njit(cache=True)
def find_pinched(labels, shape, steps, tables):  # type: ignore[no-untyped-def]
    """Return the vertices at which some material is pinched, ascending.

    Parameters
    ----------
    labels
        Material of the cell above every vertex, shape (n_v,), int32.
    shape
        Number of vertices along each axis.
    steps
        Differences between the numbers of neighbours along every axis, shape (3,).
    tables
        See `tusqh.contacts.octants.Octants`.
    """
    found, n = np.empty(1024, dtype=np.int64), 0
    octant = np.zeros(8, dtype=np.int64)
    for a in range(8):
        for axis in range(3):
            octant[a] -= (1 - (a >> axis & 1)) * steps[axis]
    for i in range(1, shape[0]):
        for j in range(1, shape[1]):
            for k in range(1, shape[2]):
                v = i * steps[0] + j * steps[1] + k
                first, is_one = labels[v], True
                for a in range(8):
                    is_one &= labels[v + octant[a]] == first
                if is_one:
                    continue
                for a in range(8):
                    mask = 0
                    for b in range(8):
                        mask |= (labels[v + octant[b]] == labels[v + octant[a]]) << b
                    if tables.is_pinched[mask]:
                        if n == len(found):
                            found = np.concatenate((found, np.empty_like(found)))
                        found[n] = v
                        n += 1
                        break
    return found[:n].copy()
