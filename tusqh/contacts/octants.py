"""Tables of the neighbourhood of a grid vertex in 3D.

::

    octants       0..7    the cells around the vertex; bit k is set on the upper side of axis k
    half-edges    0..5    the grid edges at the vertex: 2 axis, plus 1 for the upper one
    kites         0..11   the quarters of grid faces at the vertex: two octants, two half-edges
    sectors       0..47   the quarters of kites, one per octant and half-edge of the kite; number
                          4 kite + 2 (which octant) + (which half-edge)

The sectors are the triangles (octant, kite, half-edge) of a small sphere around the vertex.  The
sectors of a refined face belong to the sticks along its edges, those of any other face to its two
cells.  The bits of an integer represent a set of octants, half-edges or sectors.
"""

from __future__ import annotations

import itertools
from functools import cache
from typing import NamedTuple

import numpy as np

from tusqh.grid import IntArray

#: The bits of an octant, shape (8, 3).
BITS: IntArray = np.array([[a >> k & 1 for k in range(3)] for a in range(8)], dtype=np.int64)


class Octants(NamedTuple):
    """The tables; a kernel takes them as one argument.

    Parameters
    ----------
    kites
        Lower octant, upper octant and two half-edges of every kite, shape (12, 4).
    normals
        Normal axis of every kite, shape (12,).
    around
        The octants around every half-edge, cyclic, shape (6, 4).
    of_octant, of_kite
        Sectors of every octant and of every kite, as bits, shapes (8,) and (12,).
    next_to
        The sectors beside those of every byte of a set of sectors, as bits, shape (6, 256).
    parts
        The lowest octant that can be reached across faces from every octant of every set of
        octants, four bits for each octant and 15 for those outside the set, shape (256,).
    is_pinched
        Whether a set of octants or its complement is disconnected, shape (256,).
    euler
        Euler characteristic of the octants of a set and the faces between them, shape (256,).
    filled
        The same with the half-edges all of whose octants are in the set, and the vertex likewise.
    """

    kites: IntArray
    normals: IntArray
    around: IntArray
    of_octant: IntArray
    of_kite: IntArray
    next_to: IntArray
    parts: IntArray
    is_pinched: np.ndarray[tuple[int], np.dtype[np.bool_]]
    euler: IntArray
    filled: IntArray


@cache
def octants() -> Octants:
    """Return the tables.

    Examples
    --------
    >>> tables = octants()
    >>> tables.kites.shape, int(tables.is_pinched.sum())
    ((12, 4), 128)
    """
    kites = _find_kites()
    sectors = [
        (int(q[a]), i, int(q[2 + e])) for i, q in enumerate(kites) for a in (0, 1) for e in (0, 1)
    ]
    of_octant = [sum(1 << s for s, t in enumerate(sectors) if t[0] == a) for a in range(8)]
    of_kite = [sum(1 << s for s, t in enumerate(sectors) if t[1] == i) for i in range(12)]
    beside = [sum(1 << s for s, t in enumerate(sectors) if _n_shared(t, u) == 2) for u in sectors]
    parts = [_find_parts(mask) for mask in range(256)]
    n_parts = np.array([len({*row} - {15}) for row in parts])
    euler = [
        mask.bit_count() - sum(mask >> a & mask >> b & 1 for a, b in kites[:, :2].tolist())
        for mask in range(256)
    ]
    around = _find_around()
    four = [sum(1 << int(a) for a in row) for row in around]
    filled = [
        euler[mask] + sum(mask & edge == edge for edge in four) - (mask == 255)
        for mask in range(256)
    ]
    return Octants(
        kites=kites,
        normals=3 - kites[:, 2] // 2 - kites[:, 3] // 2,
        around=around,
        of_octant=np.array(of_octant, dtype=np.int64),
        of_kite=np.array(of_kite, dtype=np.int64),
        next_to=_join_bytes(beside),
        parts=np.array(
            [sum(part << 4 * a for a, part in enumerate(row)) for row in parts], dtype=np.int64
        ),
        is_pinched=(n_parts > 1) | (n_parts[::-1] > 1),
        euler=np.array(euler, dtype=np.int64),
        filled=np.array(filled, dtype=np.int64),
    )


def _is_at(octant: int, half_edge: int) -> bool:
    """Return whether an octant touches a half-edge."""
    return octant >> half_edge // 2 & 1 == half_edge & 1


def _find_kites() -> IntArray:
    """Return the two octants on both sides of every kite and its two half-edges."""
    found = []
    for axis, octant in itertools.product(range(3), range(8)):
        if not octant >> axis & 1:
            sides = [e for e in range(6) if e // 2 != axis and _is_at(octant, e)]
            found.append([octant, octant | 1 << axis, *sides])
    return np.array(found, dtype=np.int64)


def _find_around() -> IntArray:
    """Return the octants around every half-edge in cyclic order."""
    around = [[a for a in range(8) if _is_at(a, e)] for e in range(6)]
    return np.array([[a, b, d, c] for a, b, c, d in around], dtype=np.int64)


def _n_shared(a: tuple[int, int, int], b: tuple[int, int, int]) -> int:
    """Return how many corners two sectors share."""
    return sum(x == y for x, y in zip(a, b, strict=True))


def _join_bytes(beside: list[int]) -> IntArray:
    """Return the union of bits of the members of every byte of a set, shape (6, 256)."""
    found = np.zeros((6, 256), dtype=np.int64)
    for byte, value, k in itertools.product(range(6), range(256), range(8)):
        if value >> k & 1:
            found[byte, value] |= beside[8 * byte + k]
    return found


def _find_parts(mask: int) -> list[int]:
    """Return the lowest octant in reach, across faces, of every octant of a set; 15 outside."""
    part = [a if mask >> a & 1 else 15 for a in range(8)]
    for _ in range(4):
        for a, k in itertools.product(range(8), range(3)):
            b = a ^ 1 << k
            if part[a] < 15 and part[b] < 15:
                part[a] = part[b] = min(part[a], part[b])
    return part
