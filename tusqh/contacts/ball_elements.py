r"""Emit the elements of balls: rings at the vertex are split, so that nothing else reaches it.

Some votes of a vertex cannot be followed by sticks, which meet at the vertex itself.  There all
faces are refined, and each of the 24 rings at the vertex is split by the one-vertex template of
Schneiders.  This section runs along a ring, from the vertex ``v`` with a ball to ``w`` without::

    iA----------------iA'        The *corner* belongs to the ball, the *rest* has the material of
    | \     side     / |         the ring.  One side lies beside the centre of the cell below the
    |  pA------fA---/--|         face and has its material; the side above is like it.  If w has a
    |   |corner|  rest |         ball too, the rest is split again at w.
    v---+------ph------w
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from tusqh.contacts.decided import Labels
from tusqh.contacts.emitter import Emitter
from tusqh.contacts.octants import BITS, octants
from tusqh.contacts.side_balls import (
    BESIDE,
    CENTRE,
    N_POINTS,
    OF_KITE,
    OF_OCTANT,
    Slots,
    Split,
    kite_between,
    octant_of,
    place_on_sides,
    split_at_balls,
)
from tusqh.contacts.stick_field import Field
from tusqh.grid import BoolArray, FloatArray, IndexArray, IntArray

#: Positions of the points of a ball, from the vertex, in cells, found by optimisation; on cubic
#: cells the scaled Jacobian of the elements is at least 0.59.  Points on the edges to inner cells
#: and in faces, along each axis.
_TO_CELL, _IN_FACE = 0.15, 0.25
#: Points on the grid edge, beside it in the two cells (along and across the edge), and beside it
#: in the face (likewise), for an edge with a ball at one end, at both seen from the first end, and
#: at both seen from the second end; the coordinate of the first end is even.
_ALONG = np.array(
    [
        [0.50, 0.50, 0.06, 0.48, 0.11],
        [0.44, 0.53, 0.09, 0.51, 0.14],
        [0.27, 0.31, 0.07, 0.34, 0.11],
    ]
)


class RingEnd(NamedTuple):
    """One end of rings along the edges of faces normal to an axis.

    Parameters
    ----------
    quad
        Grid vertex, inner corner below the face, small corner and inner corner above, shape (m, 4).
    half_edge, kite
        Direction of the rings and place of the faces, seen from the grid vertices.
    below, above
        The octants below and above the faces.
    """

    quad: IntArray
    half_edge: int
    kite: int
    below: int
    above: int


def ring_end(quad: IntArray, corner: IntArray, along: int, axis: int) -> RingEnd:
    """Return an end of rings.

    Parameters
    ----------
    quad
        See `RingEnd`.
    corner
        The corner of the lower cell where the rings end, in cells, shape (3,).
    along, axis
        Axis along which the rings run, and the normal of the faces.
    """
    below = octant_of(corner) & ~(1 << axis)
    half_edge = 2 * along + 1 - int(corner[along])
    return RingEnd(quad, half_edge, kite_between(below, axis), below, below | 1 << axis)


class Balls:
    """The points of all balls, and the split of the rings at them.

    Parameters
    ----------
    emitter
        Numbers the points.
    field
        Where the balls are.
    """

    def __init__(self, emitter: Emitter, field: Field) -> None:
        self.has_ball, self.inside = field.has_ball, field.inside
        self._shape = emitter.vertex_shape
        vertices = np.flatnonzero(field.has_ball)
        self._field = field
        self._vertices = vertices
        place = emitter.place_of_vertices(vertices)
        points = np.repeat(place[:, None].astype(float), N_POINTS, axis=1)
        points[:, OF_OCTANT:OF_KITE] += _TO_CELL * (2 * BITS - 1)
        kites = octants().kites
        points[:, OF_KITE:BESIDE] += _IN_FACE * (_direction(kites[:, 2]) + _direction(kites[:, 3]))
        cases = np.zeros((6, len(vertices)), dtype=np.int64)
        for half_edge in range(6):
            axis = half_edge // 2
            step = (2 * (half_edge & 1) - 1) * field.steps[axis]
            cases[half_edge] = np.where(field.has_ball[vertices + step], 1 + place[:, axis] % 2, 0)
            _place_along(points, half_edge, _ALONG[cases[half_edge]])
        octant = (BITS - 1) @ field.steps
        inside = field.inside[vertices[:, None] + octant]
        place_on_sides(points, place, inside, cases, _ALONG)
        layers = np.repeat(vertices // field.steps[0], N_POINTS)
        self._numbers = emitter.add_points(points.reshape(-1, 3), layers).reshape(-1, N_POINTS)

    def material_at(self, vertices: IntArray) -> Labels:
        """Return the materials of the balls at some grid vertices, shape (r,).

        A ball at a vertex that is not pinched may have any of the materials there.

        Parameters
        ----------
        vertices
            Flat grid vertices, shape (r,).
        """
        ball = self._field.ball[vertices]
        return np.where(ball < 0, self._field.labels[vertices], ball)

    def touches(self, elements: IndexArray) -> BoolArray:
        """Return which elements have a corner at a ball, shape (m,).

        Parameters
        ----------
        elements
            Numbers of the elements' points, shape (m, 8).
        """
        found = np.zeros(len(elements), dtype=np.bool_)
        if len(self._numbers):
            _mark_touching(elements, self.has_ball, found)
        return found

    def is_even(self, vertices: IntArray, axis: int) -> BoolArray:
        """Return whether coordinates of grid vertices along an axis are even, shape (r,).

        Parameters
        ----------
        vertices
            Flat grid vertices, shape (r,).
        axis
            The axis.
        """
        return np.asarray(np.unravel_index(vertices, self._shape)[axis] % 2 == 0)

    def split_others(self, elements: IntArray, slots: Slots) -> Split:
        """Return elements other than rings, split at all balls, see `split_at_balls`.

        Parameters
        ----------
        elements
            Elements of one kind, shape (m, 8).
        slots
            The points that split them.
        """
        return split_at_balls(elements, slots, self._vertices, self._numbers, self._shape)

    def split(self, first: RingEnd, second: RingEnd) -> list[tuple[str, IntArray, IntArray]]:
        """Return the elements of rings with a ball at the first end, and perhaps at the second.

        Parameters
        ----------
        first, second
            The two ends; if both have balls, the coordinate of the first is even.

        Returns
        -------
        parts
            What the elements are (``"first"`` and ``"second"`` for the corners of the two balls,
            ``"below"``, ``"above"`` and ``"ring"``), their rows, shape (r,), and their points,
            shape (r, 8), with the first end at the bottom.
        """
        v, a, s, b = first.quad.T
        w, a_2, s_2, b_2 = second.quad.T
        rows = np.arange(len(v))
        p_h, p_a, p_b, kite, f_a, f_b, centre = self._points(first, rows)
        near = [p_h, f_a, centre, f_b]
        parts = [
            ("first", rows, [v, p_a, kite, p_b, *near]),
            ("below", rows, [p_a, kite, centre, f_a, a, s, s_2, a_2]),
            ("above", rows, [p_b, f_b, centre, kite, b, b_2, s_2, s]),
        ]
        both = self.has_ball[w]
        one = np.flatnonzero(~both)
        parts.append(("ring", one, [c[one] for c in (*near, w, a_2, s_2, b_2)]))
        two = np.flatnonzero(both)
        p_h, p_a, p_b, kite, g_a, g_b, middle = self._points(second, two)
        near = [c[two] for c in near]
        far = [p_h, g_a, middle, g_b]
        w, a_2, s_2, b_2 = (c[two] for c in (w, a_2, s_2, b_2))
        parts += [
            ("ring", two, [*near, *far]),
            ("second", two, [*far, w, p_a, kite, p_b]),
            ("below", two, [g_a, middle, kite, p_a, near[1], near[2], s_2, a_2]),
            ("above", two, [g_b, p_b, kite, middle, near[3], b_2, s_2, near[2]]),
        ]
        return [(name, rows, np.stack(points, axis=1)) for name, rows, points in parts]

    def _points(self, end: RingEnd, rows: IntArray) -> list[IntArray]:
        """Return the points of the balls at an end of some rings, see `split`."""
        numbers = self._numbers[np.searchsorted(self._vertices, end.quad[rows, 0])]
        beside = BESIDE + 8 * end.half_edge
        columns = [
            end.half_edge,
            OF_OCTANT + end.below,
            OF_OCTANT + end.above,
            OF_KITE + end.kite,
            beside + end.below,
            beside + end.above,
            CENTRE + 12 * end.half_edge + end.kite,
        ]
        return [numbers[:, c] for c in columns]


@numba.njit(cache=True)
def _mark_touching(elements, has_ball, found):  # type: ignore[no-untyped-def]
    """Mark the elements with a corner at a ball; only grid vertices have balls."""
    for row in range(len(elements)):
        for point in elements[row]:
            if point < len(has_ball) and has_ball[point]:
                found[row] = True


def _direction(half_edge: int | IntArray) -> FloatArray:
    """Return the unit vectors of half-edges, shape (..., 3)."""
    axis, end = np.divmod(half_edge, 2)
    return np.asarray(np.eye(3)[axis] * (2 * np.asarray(end)[..., None] - 1))


def _place_along(points: FloatArray, half_edge: int, along: FloatArray) -> None:
    """Move the points that belong to a half-edge, in place.

    Parameters
    ----------
    points
        Points of all balls, shape (p, `N_POINTS`, 3).
    half_edge
        The half-edge.
    along
        Row of `_ALONG` for every ball, shape (p, 5).
    """
    on_edge, cell_along, cell_across, face_along, face_across = along.T[:, :, None, None]
    axis, direction = half_edge // 2, _direction(half_edge)
    points[:, half_edge] += on_edge[:, 0] * direction
    across = (2 * BITS - 1.0) * (np.arange(3) != axis)
    beside = slice(BESIDE + 8 * half_edge, BESIDE + 8 * (half_edge + 1))
    points[:, beside] += cell_along * direction + cell_across * across
    kites = octants().kites[:, 2:]
    other = np.where(kites[:, 0] == half_edge, kites[:, 1], kites[:, 0])
    centre = slice(CENTRE + 12 * half_edge, CENTRE + 12 * (half_edge + 1))
    points[:, centre] += face_along * direction + face_across * _direction(other)
