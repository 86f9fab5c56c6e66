"""The state of a padded grid in 3D, and the vertices where its materials are pinched.

A vertex, the edges that start there, the faces with that lowest corner and the cell above it share
one flat number.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid import IntArray


class Field(NamedTuple):
    """The state of all cells, edges, faces and vertices of a padded grid.

    Materials are int8, or int32 where there are more than 127.

    Parameters
    ----------
    labels
        Material of every cell, shape (n_v,).
    inside
        Cells of the grid without layers, shape (n_v,).
    between
        Bit k is set at a face normal to axis k between two materials and two cells of the grid;
        others are never refined, so that the sides of the grid stay plane, shape (n_v,).
    ball
        Decided material of every pinched vertex, -1 at other vertices, shape (n_v,).
    is_pinched
        Pinched edges, whose sticks are decided, shape (3, n_v).
    marked
        Vertices whose faces between two materials are refined, shape (n_v,).
    has_ball
        Marked vertices with elements for the ball alone, shape (n_v,).
    sticks
        Material of the stick at every edge with a marked end, -1 at other edges, shape (3, n_v).
    sides
        Which cell of a refined face owns the rings at its edges without sticks: 0 for the lower, 1
        for the upper cell, shape (3, n_v).
    stale
        Marked vertices near which something has changed since their sticks were last improved,
        shape (n_v,).
    verdict
        Whether a vertex is good as it is, 0 or 1; -1 if that is not known, shape (n_v,).
    steps
        Differences between the numbers of neighbours along every axis, shape (3,).
    octant
        Differences between the numbers of a vertex and of the cells in its octants, shape (8,).
    face
        Differences between the numbers of a vertex and of the faces of its kites, shape (12,).
    """

    labels: NDArray[np.signedinteger]
    inside: NDArray[np.bool_]
    between: NDArray[np.uint8]
    ball: NDArray[np.signedinteger]
    is_pinched: NDArray[np.bool_]
    marked: NDArray[np.bool_]
    has_ball: NDArray[np.bool_]
    sticks: NDArray[np.signedinteger]
    sides: NDArray[np.uint8]
    stale: NDArray[np.bool_]
    verdict: NDArray[np.int8]
    steps: IntArray
    octant: IntArray
    face: IntArray


def faces_of_kites(steps: IntArray, kites: IntArray) -> IntArray:
    """Return the differences between the numbers of a vertex and of the faces of its kites.

    Parameters
    ----------
    steps
        Differences between the numbers of neighbours along every axis, shape (3,).
    kites
        See `tusqh.contacts.octants.Octants`.
    """
    half_edges = kites[:, 2:]
    return np.asarray(-((1 - half_edges % 2) * steps[half_edges // 2]).sum(axis=1), dtype=np.int64)


@numba.njit(cache=True)
def find_pinched(labels, shape, steps, tables):  # type: ignore[no-untyped-def]
    """Return the vertices at which some material is pinched, ascending.

    Parameters
    ----------
    labels
        Material of the cell above every vertex, shape (n_v,).
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
