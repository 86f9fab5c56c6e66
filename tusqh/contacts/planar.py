r"""Resolve contacts in 2D: every pinched vertex gets a ball of the material that wins its vote.

A vertex is pinched if two of its cells that do not share a side have a material that neither of the
other cells has.  The cells around it are split by the 1-5 template.  At a side with a pinched end,
one kite for each pinched end and two quads replace the two trapezoids::

    +-----------------+
    |  A    inner     |        The kite has the corners vertex, inner corner of A, a point of the
    |      a-------   |        side, inner corner of B.  The four kites around a pinched vertex are
    |    / |          |        its ball: a disc, so that any of the materials may have it without
    v---s-----------  +        another pinch, whatever material the other vertices have.
    |    \ |          |
    |      b-------   |
    |  B    inner     |
    +-----------------+
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from tusqh.contacts.decided import Contacts, Labels
from tusqh.contacts.emitter import Emitted, Emitter
from tusqh.contacts.votes import Fractions, count_votes
from tusqh.grid import BackgroundGrid, BoolArray, IntArray
from tusqh.meshes.volume_mesh import BRIDGE, CONNECTING, GRID_CELL, INNER_CELL, SEPARATING

#: Position on the side where a kite ends, in lengths of the side.
_KITE = 0.375

#: Offsets of the cells around a vertex, in cyclic order.
_AROUND = ((0, 0), (1, 0), (1, 1), (0, 1))


@dataclass(frozen=True)
class PlanarDecision:
    """The materials of cells and balls, in a grid with one more layer of void on every side.

    Parameters
    ----------
    labels
        Material of every cell, shape ``n + 2``.
    ball
        Material of the ball at every pinched vertex and every vertex of a bridge, -1 at other
        vertices, shape ``n + 3``.
    bridged
        For each axis, the cells whose upper side along it is part of a bridge: both quads of the
        side have the material of the balls at its ends, shape ``(2, *(n + 2))``; None: no bridges.
    """

    labels: Labels
    ball: Labels
    bridged: BoolArray | None = field(default=None, repr=False)

    #: Every ball follows its vote.
    n_overruled = 0

    @classmethod
    def of(cls, labels: Labels, contacts: Contacts) -> PlanarDecision:
        """Return the decision with the balls of given contacts.

        Parameters
        ----------
        labels
            Material of every cell, with a layer of void around them, shape ``n + 2``.
        contacts
            The contacts of the cells.
        """
        ball = np.full(tuple(n + 1 for n in labels.shape), -1, dtype=np.int32)
        # The third of the cells around a vertex is the one above it, and has its numbers.
        ball[np.unravel_index(contacts.vertex_cells[:, 2], labels.shape)] = contacts.ball
        return cls(labels, ball)

    @cached_property
    def is_pinched(self) -> BoolArray:
        """The pinched vertices, shape ``n + 3``."""
        return find_pinched(self.labels)

    @cached_property
    def contacts(self) -> Contacts:
        """The pinched vertices with their balls."""
        numbers = np.arange(self.labels.size, dtype=np.int32).reshape(self.labels.shape)
        inner = self.is_pinched[1:-1, 1:-1]
        n = int(inner.sum())
        return Contacts(
            vertex_cells=around_vertices(numbers)[:, inner].T.astype(np.int64),
            ball=self.ball[1:-1, 1:-1][inner],
            sticks=np.empty((n, 0), dtype=np.int32),
            edge_cells=np.empty((0, 4), dtype=np.int64),
            edge_material=np.empty(0, dtype=np.int32),
        )


def around_vertices(cells: Labels) -> Labels:
    """Return the values of the four cells around the inner vertices, shape (4, n - 1, m - 1).

    Parameters
    ----------
    cells
        A value per cell, shape (n, m).

    Examples
    --------
    >>> around_vertices(np.array([[1, 2], [3, 4]]))[:, 0, 0].tolist()
    [1, 3, 4, 2]
    """
    n, m = cells.shape
    return np.stack([cells[i : n - 1 + i, j : m - 1 + j] for i, j in _AROUND])


def find_diagonals(four: Labels) -> BoolArray:
    """Return where two opposite cells have a material that the other two do not have.

    Parameters
    ----------
    four
        Materials of four cells in cyclic order, shape (4, ...).

    Examples
    --------
    >>> find_diagonals(np.array([[1, 1], [2, 2], [1, 1], [3, 1]])).tolist()
    [True, False]
    """
    a, b, c, d = four
    return np.asarray(((a == c) & (b != a) & (d != a)) | ((b == d) & (a != b) & (c != b)))


def find_pinched(labels: Labels) -> BoolArray:
    """Return the pinched vertices, shape ``n + 3``.

    Parameters
    ----------
    labels
        Material of every cell, with a layer of void around them, shape ``n + 2``.
    """
    return np.pad(find_diagonals(around_vertices(labels)), 1)


def decide_balls(fractions: Fractions, labels: Labels, thresholds: IntArray) -> Labels:
    """Return the material of every ball, which wins the vote of its vertex.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    labels
        Material of every cell, with a layer of void around them, shape ``n + 2``.
    thresholds
        Threshold of every material, in multiples of 2**-20, shape (m,).

    Returns
    -------
    ball
        Shape ``n + 3``; -1 for vertices that are not pinched.
    """
    four = around_vertices(labels)
    is_pinched = find_diagonals(four)
    ball = np.full(tuple(n + 1 for n in labels.shape), -1, dtype=np.int32)
    i, j = np.nonzero(is_pinched)
    width = 2 * fractions.grid.shape[1] + 1
    winner = count_votes(fractions, 2 * i * width + 2 * j, four[:, i, j].T, thresholds).winner
    ball[1:-1, 1:-1][is_pinched] = winner
    return ball


def emit_planar(
    decision: PlanarDecision, grid: BackgroundGrid, name: str, *, left_out: int | None = None
) -> Emitted:
    """Return the quads of all materials including the void.

    Parameters
    ----------
    decision
        Materials of cells and balls.
    grid
        The grid with the layer of void, of shape ``n + 2``.
    name
        The model, for messages.
    left_out
        A material without quads; None: all have quads.
    """
    labels = decision.labels
    refined = [_find_refined(decision, axis) for axis in range(2)]
    split = np.logical_or.reduce([side for axis in range(2) for side in _both(refined[axis], axis)])
    emitter = Emitter(grid, split, left_out=left_out)
    flat = labels.ravel()
    whole, inside = np.flatnonzero(~split & (labels != left_out)), np.flatnonzero(split)
    emitter.add(emitter.outer(whole), whole, GRID_CELL, flat[whole])
    emitter.add(emitter.inner(inside), inside, INNER_CELL, flat[inside])
    for face, (axis, end) in enumerate(((1, 0), (0, 1), (1, 1), (0, 0))):
        cells = np.flatnonzero(split & ~_both(refined[axis], axis)[1 - end])
        corners = np.concatenate([emitter.outer(cells), emitter.inner(cells)], axis=1)
        emitter.add(corners[:, emitter.template.frusta[face]], cells, SEPARATING, flat[cells])
    for axis in range(2):
        _emit_sides(emitter, axis, np.flatnonzero(refined[axis]), decision)
    return emitter.finish(name)


def _find_refined(decision: PlanarDecision, axis: int) -> BoolArray:
    """Return the cells whose upper side along an axis has a pinched end, shape ``n + 2``."""
    is_pinched = decision.ball >= 0
    n, m = decision.labels.shape
    if axis == 0:
        return np.asarray(is_pinched[1:, :m] | is_pinched[1:, 1:])
    return np.asarray(is_pinched[:n, 1:] | is_pinched[1:, 1:])


def _both(refined: BoolArray, axis: int) -> tuple[BoolArray, BoolArray]:
    """Return the cells whose upper side, and those whose lower side, is refined."""
    return refined, np.roll(refined, 1, axis)


def _emit_sides(emitter: Emitter, axis: int, lower: IntArray, decision: PlanarDecision) -> None:
    """Add the kites and quads of refined sides, given the cells below them."""
    flat, ball = decision.labels.ravel(), decision.ball.ravel()
    upper = lower + (emitter.grid.shape[1] if axis == 0 else 1)
    a, b, a_2, b_2 = (1, 2, 0, 3) if axis == 0 else (2, 3, 1, 0)
    outer, below, above = emitter.outer(lower), emitter.inner(lower), emitter.inner(upper)
    p, q = outer[:, a], outer[:, b]
    on_p, on_q = ball[p] >= 0, ball[q] >= 0
    first = _add_point(emitter, p, q, on_p)
    second = _add_point(emitter, q, p, on_q)
    in_a, in_b, up_a, up_b = below[:, a], below[:, b], above[:, a_2], above[:, b_2]
    is_bridge = np.zeros(len(lower), dtype=bool)
    if decision.bridged is not None:
        is_bridge = decision.bridged[axis].ravel()[lower]
    kind = np.where(is_bridge, BRIDGE, SEPARATING)
    for quad, cells in (
        ((first, second, in_b, in_a), lower),
        ((second, first, up_a, up_b), upper),
    ):
        material = np.where(is_bridge, ball[p], flat[cells])
        emitter.add(np.stack(quad, 1), cells, kind, material)
    is_pinched = decision.is_pinched.ravel()
    for kite, on, at in (
        ((p, up_a, first, in_a), on_p, p),
        ((q, in_b, second, up_b), on_q, q),
    ):
        kind = np.where(is_pinched[at[on]], CONNECTING, BRIDGE)
        emitter.add(np.stack(kite, 1)[on], lower[on], kind, ball[at[on]])


def _add_point(emitter: Emitter, end: IntArray, other: IntArray, on: BoolArray) -> IntArray:
    """Return points on sides near a pinched end, or the end itself if it is not pinched."""
    shape = emitter.vertex_shape
    here, there = (np.stack(np.unravel_index(v[on], shape), axis=1) for v in (end, other))
    points = end.copy()
    points[on] = emitter.add_points(here + _KITE * (there - here))
    return points
