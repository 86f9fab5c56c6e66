"""The link of a cell: the 26 neighbours (8 in the plane) on which its effect on topology depends.

In the paper's complex a cell is joined to the cells across its faces and to the nodes of its edges
and vertices.  These neighbours subdivide the cell's boundary, a sphere (in the plane a circle)::

    v --- f --- v        In the plane: the cells f across the four sides and the four vertices v,
    |           |        joined around the cell.
    f    cell   f        In space: 6 cells across faces, 12 edges and 8 vertices; two of them are
    |           |        joined if one contains the other in the boundary of the cube.
    v --- f --- v
"""

from __future__ import annotations

import itertools
from functools import cache
from typing import NamedTuple

import numpy as np

from tusqh.antialias.pinches import pinch_table
from tusqh.grid import BoolArray, IntArray

#: Largest number of cells around a neighbour.
_MOST = 8


class Link(NamedTuple):
    """The neighbours of a cell; a kernel takes them as one argument.

    The numbers of cells and of places of the doubled grid are relative to those of the cell.

    Parameters
    ----------
    codimension
        Number of axes along which a neighbour lies beside the cell: 1 for a face, 2 for an edge (in
        the plane a vertex), 3 for a vertex, shape (m,).
    cell
        The cell in the direction of each neighbour, shape (m,).
    place
        The place of each neighbour, shape (m,).
    around
        The ``2**codimension`` cells around each neighbour, in the order of their bits as in
        `tusqh.grid.neighbourhoods`, shape (m, 8).
    own
        The number of the cell itself among them, shape (m,).
    joined
        The neighbours to which each one is joined, as bits, shape (m,).
    is_pinched
        Whether the cells of a code touch without sharing a face, or their complement does, by
        codimension and code, shape (4, 256).
    """

    codimension: IntArray
    cell: IntArray
    place: IntArray
    around: IntArray
    own: IntArray
    joined: IntArray
    is_pinched: BoolArray


@cache
def link_in(cell_shape: tuple[int, ...], place_shape: tuple[int, ...]) -> Link:
    """Return the link of a cell in arrays of given shapes.

    Parameters
    ----------
    cell_shape
        Shape of an array of cells.
    place_shape
        Shape of an array on the doubled grid.

    Examples
    --------
    >>> link = link_in((3, 3), (7, 7))
    >>> link.cell.tolist(), [int(bits).bit_count() for bits in link.joined]
    ([-4, -3, -2, -1, 1, 2, 3, 4], [2, 2, 2, 2, 2, 2, 2, 2])
    """
    offsets = _offsets(len(cell_shape))
    cell_step, place_step = _steps(cell_shape), _steps(place_shape)
    around = np.zeros((len(offsets), _MOST), dtype=np.int64)
    own = np.zeros(len(offsets), dtype=np.int64)
    for i, offset in enumerate(offsets):
        axes = np.flatnonzero(offset)
        for code in range(2 ** len(axes)):
            is_upper = code >> np.arange(len(axes)) & 1
            at = is_upper - (offset[axes] < 0)
            around[i, code] = at @ cell_step[axes]
            if not at.any():
                own[i] = code
    return Link(
        codimension=np.abs(offsets).sum(axis=1),
        cell=offsets @ cell_step,
        place=offsets @ place_step,
        around=around,
        own=own,
        joined=_join(offsets),
        is_pinched=_pinch_tables(),
    )


@cache
def _offsets(dim: int) -> IntArray:
    """Return the directions of all neighbours, shape (3**dim - 1, dim)."""
    found = [o for o in itertools.product((-1, 0, 1), repeat=dim) if any(o)]
    return np.array(found, dtype=np.int64)


def _steps(shape: tuple[int, ...]) -> IntArray:
    """Return the differences between the flat indices of neighbours along every axis."""
    return np.append(np.cumprod(shape[:0:-1])[::-1], 1).astype(np.int64)


def _join(offsets: IntArray) -> IntArray:
    """Return the neighbours to which each one is joined, as bits, shape (m,)."""
    joined = [0] * len(offsets)
    for i, j in itertools.permutations(range(len(offsets)), 2):
        axes = np.flatnonzero(offsets[i])
        if (offsets[j][axes] == offsets[i][axes]).all():  # Neighbour i contains neighbour j.
            joined[i] |= 1 << j
            joined[j] |= 1 << i
    return np.array(joined, dtype=np.int64)


@cache
def _pinch_tables() -> BoolArray:
    """Return whether the cells of a code are pinched, by codimension."""
    tables = np.zeros((4, 256), dtype=bool)
    for codimension in (2, 3):
        table = pinch_table(codimension)
        tables[codimension, : len(table)] = table
    return tables
