"""The values of the filtration's nodes, as integer multiples of `RESOLUTION`.

A node is present at level ``k`` if its own multiple is at least ``k``; a node with multiple 0 is
never present.  Interior edges and vertices are clamped to the range of the cells around them
(paper: Transferring Persistent Parameters to Simplices), and fractions to [0, 1], because no
threshold in (0, 1] distinguishes values below 0, or values above 1, from one another.
"""

from __future__ import annotations

from collections.abc import Sequence

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid.arrays import BoolArray, IntArray
from tusqh.grid.doubled import as_layer
from tusqh.sampling.doubled_grid import RESOLUTION, Multiples

#: Fraction of a full cell, in multiples of `RESOLUTION`.
FULL = round(1 / RESOLUTION)

#: Layers of empty places around the doubled grid: one layer of cells, so that all vertices of the
#: grid are interior.
MARGIN = 2


def clamp_multiples(multiples: Multiples) -> Multiples:
    """Return the multiples of all nodes, with one layer of empty cells around them.

    Parameters
    ----------
    multiples
        Fractions on the doubled grid as multiples of `RESOLUTION`, shape ``2 n + 1``, int32.

    Returns
    -------
    nodes
        Multiples in 0..`FULL`, shape ``2 n + 5``, int32.  Places without a node (edges in 2D,
        faces in 3D) keep their values.

    Examples
    --------
    The value of a vertex is clamped to the range of its cells:

    >>> multiples = np.zeros((5, 5), dtype=np.int32)
    >>> multiples[1::2, 1::2] = [[2, 3], [4, 5]]
    >>> multiples[2, 2] = 9
    >>> int(clamp_multiples(multiples)[4, 4])
    5
    """
    nodes = np.zeros([n + 2 * MARGIN for n in multiples.shape], dtype=np.int32)
    np.clip(multiples, 0, FULL, out=nodes[(slice(MARGIN, -MARGIN),) * nodes.ndim])
    layer = as_layer(nodes)
    _clamp(layer)
    return np.asarray(layer if nodes.ndim == 3 else layer[1])


def clamp_at_level(multiples: Multiples, level: int) -> NDArray[np.uint8]:
    """Return which nodes are present at a level, with one layer of empty cells around them.

    Parameters
    ----------
    multiples
        See `clamp_multiples`.
    level
        A multiple in 1..`FULL`.

    Returns
    -------
    nodes
        1 where the result of `clamp_multiples` is at least the level, otherwise 0, at the places of
        nodes, shape ``2 n + 5``, uint8.

    Examples
    --------
    >>> multiples = np.arange(49, dtype=np.int32).reshape(7, 7) * 7 % 13
    >>> at_once = clamp_multiples(multiples) >= 5
    >>> bool((clamp_at_level(multiples, 5) == at_once)[::2, ::2].all())
    True
    """
    return clamp_present(np.asarray(multiples >= level))


def clamp_present(is_present: BoolArray) -> NDArray[np.uint8]:
    """Return which nodes are present, with one layer of empty cells around them.

    Parameters
    ----------
    is_present
        Whether the multiple of each place is at least a level, shape ``2 n + 1``.

    Returns
    -------
    nodes
        See `clamp_at_level`.
    """
    nodes = np.zeros([n + 2 * MARGIN for n in is_present.shape], dtype=np.uint8)
    nodes[(slice(MARGIN, -MARGIN),) * nodes.ndim] = is_present
    layer = as_layer(nodes)
    _clamp(layer)
    return np.asarray(layer if nodes.ndim == 3 else layer[1])


def distinct_levels(parts: Sequence[Multiples]) -> IntArray:
    """Return the distinct multiples in 1..`FULL` of some arrays, ascending.

    Parameters
    ----------
    parts
        Multiples of any shape, int32.

    Examples
    --------
    >>> distinct_levels([np.array([[3, 0], [-1, 2]], dtype=np.int32)]).tolist()
    [2, 3]
    """
    is_there = np.zeros(FULL + 1, dtype=np.bool_)
    for part in parts:
        _mark(np.ascontiguousarray(part).ravel(), is_there)
    return np.flatnonzero(is_there).astype(np.int64)


def complement(nodes: Multiples) -> Multiples:
    """Return the multiples of the complement, in which nodes leave as the threshold falls.

    Parameters
    ----------
    nodes
        See `clamp_multiples`.

    Returns
    -------
    left
        Multiples in 1..``FULL + 1``; they are positive, so every node is present at the end.

    Notes
    -----
    The complement of a full subcomplex retracts onto the full subcomplex of the other nodes, so
    its components are the holes (2D) or voids (3D), and the outside (algorithm 2).
    """
    return np.asarray(FULL + 1 - nodes, dtype=np.int32)


@numba.njit(cache=True)
def _mark(multiples, is_there):  # type: ignore[no-untyped-def]
    """Mark the multiples above 0 that are at most `FULL`, in place."""
    for multiple in multiples:
        if 0 < multiple <= FULL:
            is_there[multiple] = True


@numba.njit(cache=True)
def _clamp(nodes):  # type: ignore[no-untyped-def]
    """Clamp interior edges and vertices of an array in space to the cells around them, in place."""
    n_x, n_y, n_z = nodes.shape
    for i in range(1, n_x - 1):
        for j in range(1, n_y - 1):
            for k in range(1, n_z - 1):
                odd_i, odd_j, odd_k = i % 2, j % 2, k % 2
                if odd_i + odd_j + odd_k > 1:
                    continue
                low, high = FULL, 0
                for x in range(i - 1 + odd_i, i + 2 - odd_i, 2):
                    for y in range(j - 1 + odd_j, j + 2 - odd_j, 2):
                        for z in range(k - 1 + odd_k, k + 2 - odd_k, 2):
                            low, high = min(low, nodes[x, y, z]), max(high, nodes[x, y, z])
                # A clamped edge lies in the range of its cells, so the cells suffice for a vertex.
                nodes[i, j, k] = min(max(nodes[i, j, k], low), high)
