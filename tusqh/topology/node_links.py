"""Tabulate the links of the filtration's nodes in space.

The link of a node is a triangulated sphere: 26 nodes around a cell, 6 around an edge (4 cells and
2 vertices) and 14 around a vertex (8 cells and 6 edges).  Every neighbour has a *direction*, the
signs of its offset on the doubled grid, numbered from 0 to 26 with the last axis fastest::

    number = 9 (sign_x + 1) + 3 (sign_y + 1) + (sign_z + 1)

The neighbour of a cell across a face is two places away, and every other neighbour is one place
away along each axis.  Sets of directions are the bits of an integer.
"""

from __future__ import annotations

import itertools
from functools import cache
from typing import NamedTuple

import numpy as np

from tusqh.grid.arrays import IntArray
from tusqh.grid.doubled import Offset

#: Number of directions, one of which is the node itself.
N_DIRECTIONS = 27


class NodeLinks(NamedTuple):
    """The links of nodes of every parity; bit 0 of a parity is that of the first axis.

    Parameters
    ----------
    offsets
        Offset on the doubled grid to the neighbour in each direction, shape (8, 27, 3).
    members
        The set of directions in which there are neighbours, shape (8,).
    adjacent
        The set of neighbours that are adjacent to each neighbour, shape (8, 27).
    seen_from
        Direction of the second of two adjacent neighbours as seen from the first, shape
        (8, 27, 27); -1 if they are not adjacent.
    triangles
        Directions of the corners of the link's triangles, shape (8, 48, 3); -1 after the last.
    """

    offsets: IntArray
    members: IntArray
    adjacent: IntArray
    seen_from: IntArray
    triangles: IntArray


@cache
def tabulate_links() -> NodeLinks:
    """Return the links of nodes of every parity; faces have no node, and their links are empty.

    Examples
    --------
    The links of a vertex, an edge along x and a cell have 24, 8 and 48 triangles:

    >>> links = tabulate_links()
    >>> [int((links.triangles[parity] >= 0).all(axis=1).sum()) for parity in (0, 1, 7)]
    [24, 8, 48]
    """
    links = NodeLinks(
        offsets=np.zeros((8, N_DIRECTIONS, 3), dtype=np.int64),
        members=np.zeros(8, dtype=np.int64),
        adjacent=np.zeros((8, N_DIRECTIONS), dtype=np.int64),
        seen_from=np.full((8, N_DIRECTIONS, N_DIRECTIONS), -1, dtype=np.int64),
        triangles=np.full((8, 48, 3), -1, dtype=np.int64),
    )
    for number in range(8):
        parity = (number & 1, number >> 1 & 1, number >> 2)
        around = _neighbours(parity)
        for a, offset in around.items():
            links.offsets[number, a] = offset
            links.members[number] |= 1 << a
        for a, b in itertools.permutations(around, 2):
            seen = _direction_between(around[a], around[b], parity)
            if seen >= 0:
                links.adjacent[number, a] |= 1 << b
                links.seen_from[number, a, b] = seen
        triples = [
            triple
            for triple in itertools.combinations(around, 3)
            if all(links.seen_from[number, a, b] >= 0 for a, b in itertools.combinations(triple, 2))
        ]
        for row, triple in enumerate(triples):
            links.triangles[number, row] = triple
    return links


@cache
def _neighbours(parity: Offset) -> dict[int, Offset]:
    """Return the offsets to the neighbours of a node, by their directions."""
    found: dict[int, Offset] = {}
    if sum(parity) == 2:  # Faces have no node.
        return found
    for signs in itertools.product((-1, 0, 1), repeat=3):
        reach = 2 if sum(map(abs, signs)) == 1 and sum(parity) == 3 else 1
        offset = tuple(reach * sign for sign in signs)
        there = tuple((p + o) % 2 for p, o in zip(parity, offset, strict=True))
        # A cell, edge or vertex is incident if it touches the place: an offset along an axis
        # leads from a body to its boundary, or from a plane to the bodies on both sides of it.
        leads_up = all(p == 0 for p, s in zip(parity, signs, strict=True) if s)
        leads_down = all(p == 1 for p, s in zip(parity, signs, strict=True) if s)
        if any(signs) and sum(there) != 2 and (leads_up or leads_down):
            found[_number(signs)] = offset
    return found


def _direction_between(a: Offset, b: Offset, parity: Offset) -> int:
    """Return the direction from one neighbour of a node to another, -1 if they are not adjacent."""
    between = tuple(y - x for x, y in zip(a, b, strict=True))
    at = tuple((p + x) % 2 for p, x in zip(parity, a, strict=True))
    signs = tuple((x > 0) - (x < 0) for x in between)
    number = _number(signs)
    return number if _neighbours(at).get(number) == between else -1


def _number(signs: Offset) -> int:
    return 9 * (signs[0] + 1) + 3 * (signs[1] + 1) + signs[2] + 1
