r"""Split the elements at balls on the sides of the grid, so that the sides stay plane.

Faces between the grid and the void around it are refined at balls only.  There the inner cell of
the cell outside reaches down to the side, and all elements of the face lie inside and have the
material of the cell inside::

    outside   |  lateral  |   inner
              |  frustum  |   cell
    ----------v-----------s-----------s--    ``v`` is a vertex with a ball
    inside    |   ring   / \  centre /
              |         /    small--

The rings are split as all rings are.  The lateral frusta are split by the one-vertex template too,
but their corners at the vertex stay void.
"""

from __future__ import annotations

import itertools
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.octants import BITS, octants
from tusqh.contacts.stick_field import Field
from tusqh.grid import HEX_CORNERS, BackgroundGrid, BoolArray, FloatArray, IndexArray, IntArray
from tusqh.grid.numbering import FACES
from tusqh.meshes.volume_mesh import CONNECTING, SEPARATING, SIDE_BALL

#: First number of the points of a ball that belong to octants, to kites, to pairs of a half-edge
#: and an octant, and to pairs of a half-edge and a kite; and how many there are.
OF_OCTANT, OF_KITE, BESIDE, CENTRE, N_POINTS = 6, 14, 26, 74, 146
#: On a side, small quads lie so far from the edges and inside; the corners of inner cells of cells
#: outside lie on the side, so far from the edges.
SMALL_ON_SIDE, INSET_ON_SIDE = (0.38, 0.15), 0.37
#: Positions of the points of a ball on a side, from the vertex, in cells: towards inner corners on
#: the side; in kites on the side (along each axis, and inwards); beside the grid edges on the
#: side, and how deep in the faces there, by the cases of `tusqh.contacts.ball_elements`; and
#: outside on the normal, beside it, in faces, in frusta and in cells that only touch an edge.
_TO_SIDE, _KITE = 0.25, (0.195, 0.12)
_ACROSS, _DEPTH = np.array([0.116, 0.16, 0.12]), np.array([0.057, 0.075, 0.057])
_UP, _BESIDE_UP, _BEYOND = 0.44, (0.105, 0.41), 0.4
_LATERAL, _OUTSIDE = (0.72, 0.34), (0.78, 0.06, 0.32)


class Slots(NamedTuple):
    """Which points of a ball split an element at each of its corners.

    Parameters
    ----------
    edges
        Points on the edges along the three directions of the element, shape (8, 3).
    faces
        Points in the faces normal to them, shape (8, 3).
    centre
        Points inside, shape (8,).
    """

    edges: IntArray
    faces: IntArray
    centre: IntArray


def octant_of(corner: IntArray) -> int:
    """Return the octant in which a cell lies, seen from one of its corners.

    Parameters
    ----------
    corner
        The corner, in cells from the lowest one, shape (3,).
    """
    return int((1 - corner) @ (1 << np.arange(3)))


def kite_between(octant: int, axis: int) -> int:
    """Return the kite between an octant and the next one along an axis.

    Parameters
    ----------
    octant
        The octant.
    axis
        The axis.
    """
    pair = sorted((octant, octant ^ 1 << axis))
    return int((octants().kites[:, :2] == pair).all(axis=1).argmax())


@cache
def slots_of_cell() -> Slots:
    """Return the points that split whole cells."""
    found = Slots(np.empty((8, 3), int), np.empty((8, 3), int), np.empty(8, int))
    for i, corner in enumerate(HEX_CORNERS):
        octant = octant_of(corner)
        for axis in range(3):
            found.edges[i, axis] = 2 * axis + 1 - corner[axis]
            found.faces[i, axis] = OF_KITE + kite_between(octant, axis)
        found.centre[i] = OF_OCTANT + octant
    return found


@cache
def slots_of_frustum(face: int, corners: tuple[int, ...]) -> Slots:
    """Return the points that split the frusta at a face of cells.

    Parameters
    ----------
    face
        Number of the face, see `tusqh.grid.numbering.FACES`.
    corners
        Corners of the frustum: of the cell below 8, then of the inner cell.
    """
    found = Slots(np.zeros((8, 3), int), np.zeros((8, 3), int), np.zeros(8, int))
    normal = FACES[3][face][0]
    for i, own in enumerate(corners):
        if own >= 8:
            continue
        octant = octant_of(HEX_CORNERS[own])
        kite = kite_between(octant, normal)
        half_edges = {}
        for r in range(3):
            beside = corners[_beside(i, r)]
            if beside < 8:
                axis = int((HEX_CORNERS[own] != HEX_CORNERS[beside]).argmax())
                half_edges[r] = 2 * axis + 1 - int(HEX_CORNERS[own][axis])
        (inwards,) = {0, 1, 2} - set(half_edges)
        found.edges[i, inwards] = OF_OCTANT + octant
        found.faces[i, inwards] = OF_KITE + kite
        for r, half_edge in half_edges.items():
            (other,) = set(half_edges) - {r}
            found.edges[i, r] = half_edge
            found.faces[i, other] = BESIDE + 8 * half_edge + octant
        found.centre[i] = _centre_slot(octant, normal, tuple(half_edges.values()))
    return found


def _beside(corner: int, direction: int) -> int:
    """Return the corner of a hex beside another along one of its directions."""
    place = HEX_CORNERS[corner] ^ (np.arange(3) == direction)
    return int((place == HEX_CORNERS).all(axis=1).argmax())


@cache
def one_vertex_template() -> IntArray:
    """Return the four hexes of a hex that is split at a corner, shape (8, 4, 8).

    Numbers are those of its corners, of the points on the three edges at the corner (8 to 10), in
    the faces normal to its directions there (11 to 13), and of the point inside (14).  The hex at
    the corner comes first; all keep the directions of the whole.
    """
    return np.array([[_part(corner, r) for r in (None, 0, 1, 2)] for corner in range(8)])


def _part(corner: int, towards: int | None) -> list[int]:
    """Return the hex at a corner, or that towards the face opposite to it in a direction."""
    near, found = HEX_CORNERS[corner], []
    for place in HEX_CORNERS:
        is_near = place == near
        if towards is None:
            is_middle, is_far = ~is_near, np.zeros(3, dtype=bool)
        else:
            is_own = np.arange(3) == towards
            is_middle = (is_own | ~is_near) & is_near[towards]
            is_far = ~is_near & ~is_middle
        n_middle = int(is_middle.sum())
        if n_middle == 0:
            at = np.where(is_far, 1 - near, near)
            found.append(int((at == HEX_CORNERS).all(axis=1).argmax()))
        elif n_middle == 3:
            found.append(14)
        else:
            found.append(
                8 + int(is_middle.argmax()) if n_middle == 1 else 11 + int((~is_middle).argmax())
            )
    return found


class Split(NamedTuple):
    """Elements, the rows they come from, and the vertex whose ball they belong to or -1."""

    elements: IntArray
    rows: IntArray
    vertices: IntArray


def split_at_balls(
    elements: IndexArray,
    slots: Slots,
    balls: IntArray,
    numbers: IndexArray,
    shape: tuple[int, ...],
) -> Split:
    """Return elements split at all corners with a ball, those with even coordinates first.

    Parameters
    ----------
    elements
        Elements of one kind, shape (m, 8).
    slots
        The points that split them.
    balls
        Grid vertices with a ball, ascending, shape (p,).
    numbers
        Numbers of the points of all balls, shape (p, `N_POINTS`).
    shape
        Number of grid vertices along each axis.
    """
    now = Split(elements, np.arange(len(elements)), np.full(len(elements), -1))
    for parity in itertools.product((0, 1), repeat=3):
        is_vertex = (now.elements < np.prod(shape)) & (now.vertices < 0)[:, None]
        vertex = np.where(is_vertex, now.elements, 0)
        is_here = is_vertex & np.isin(vertex, balls)
        for axis, index in enumerate(np.unravel_index(vertex, shape)):
            is_here &= index % 2 == parity[axis]
        here = np.flatnonzero(is_here.any(axis=1))
        corner = is_here[here].argmax(axis=1)
        at = now.elements[here, corner]
        own = numbers[np.searchsorted(balls, at)]
        added = [
            np.take_along_axis(own, slots.edges[corner], axis=1),
            np.take_along_axis(own, slots.faces[corner], axis=1),
            np.take_along_axis(own, slots.centre[corner][:, None], axis=1),
        ]
        points = np.concatenate([now.elements[here], *added], axis=1)
        parts = np.take_along_axis(
            points[:, None], one_vertex_template()[corner].reshape(len(here), 1, 32), axis=2
        )
        vertices = np.full((len(here), 4), -1)
        vertices[:, 0] = at
        rest = ~is_here.any(axis=1)
        now = Split(
            np.concatenate([now.elements[rest], parts.reshape(-1, 8)]),
            np.concatenate([now.rows[rest], np.repeat(now.rows[here], 4)]),
            np.concatenate([now.vertices[rest], vertices.ravel()]),
        )
    return now


def name_side_balls(
    kind: NDArray[np.int8], owner: IndexArray, field: Field, grid: BackgroundGrid
) -> NDArray[np.int8]:
    """Return the kinds of elements; templates around a ball on a side of the grid have their own.

    Parameters
    ----------
    kind, owner
        Kind and flat cell of every element, shape (m,).
    field
        Where the balls are.
    grid
        The grid with two layers of void.
    """
    balls = np.flatnonzero(field.has_ball)
    if len(balls) == 0:
        return kind
    around = balls[:, None] + (BITS - 1) @ field.steps
    around = around[~field.inside[around].all(axis=1)]
    cells = np.unravel_index(around.ravel(), tuple(n + 1 for n in grid.shape))
    is_there = np.isin(owner, np.ravel_multi_index(cells, grid.shape))
    is_template = (kind == SEPARATING) | (kind == CONNECTING)
    return np.where(is_there & is_template, SIDE_BALL, kind).astype(np.int8)


def place_on_sides(
    points: FloatArray, place: IntArray, inside: BoolArray, cases: IntArray, along: FloatArray
) -> None:
    """Move the points of balls on sides that lie on the side or outside, in place.

    Parameters
    ----------
    points
        Points of all balls, in cells, shape (p, `N_POINTS`, 3).
    place
        The vertices, in cells, shape (p, 3).
    inside
        Whether the octants lie in the grid, shape (p, 8).
    cases
        Row of `along` for every half-edge, shape (6, p).
    along
        Positions along and across half-edges, see `tusqh.contacts.ball_elements`.
    """
    axes = np.eye(3)
    directions = axes[np.arange(6) // 2] * (2 * (np.arange(6) % 2) - 1.0)[:, None]
    tables = octants()

    def put(rows: IntArray, slot: int, offset: FloatArray) -> None:
        points[rows, slot] = place[rows] + offset

    for kite, (lower, upper, e, f) in enumerate(tables.kites.tolist()):
        beyond = np.flatnonzero(~inside[:, lower] & ~inside[:, upper])
        put(beyond, OF_KITE + kite, _BEYOND * (directions[e] + directions[f]))
    for octant in range(8):
        outside = np.flatnonzero(~inside[:, octant])
        put(outside, OF_OCTANT + octant, _BEYOND * (2 * BITS[octant] - 1))
    for kite, (lower, upper, e, f) in enumerate(tables.kites.tolist()):
        for within, out in ((lower, upper), (upper, lower)):
            rows = np.flatnonzero(inside[:, within] & ~inside[:, out])
            normal = 3 - e // 2 - f // 2
            outwards = 2 * normal + int(BITS[out][normal])
            up, both = directions[outwards], directions[e] + directions[f]
            put(rows, OF_OCTANT + out, _TO_SIDE * both)
            put(rows, OF_KITE + kite, _KITE[0] * both - _KITE[1] * up)
            put(rows, outwards, _UP * up)
            put(rows, BESIDE + 8 * outwards + out, _BESIDE_UP[0] * both + _BESIDE_UP[1] * up)
            for h, g in ((e, f), (f, e)):
                case = cases[h, rows]
                own = along[case][:, :, None]
                across, depth = _ACROSS[case][:, None], _DEPTH[case][:, None]
                put(rows, BESIDE + 8 * h + out, own[:, 1] * directions[h] + across * directions[g])
                on_face = own[:, 3] * directions[h] + own[:, 4] * directions[g]
                put(rows, CENTRE + 12 * h + kite, on_face - depth * up)
                lateral = kite_between(out, g // 2)
                flat = _LATERAL[0] * own[:, 0] * directions[h] + _LATERAL[1] * up
                put(rows, OF_KITE + lateral, flat)
                centre = _centre_slot(out, g // 2, (h, outwards))
                far = _OUTSIDE[0] * own[:, 0] * directions[h] + _OUTSIDE[2] * up
                put(rows, centre, far + _OUTSIDE[1] * directions[g])


def _centre_slot(octant: int, normal: int, half_edges: tuple[int, ...]) -> int:
    """Return the point inside the frustum of an octant at a kite; both sides have their own."""
    half_edge = sorted(half_edges)[int(BITS[octant][normal])]
    return CENTRE + 12 * half_edge + kite_between(octant, normal)
