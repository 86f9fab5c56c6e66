"""Resolve contacts in 3D: mark vertices and choose the material of every stick at them.

The faces at a marked vertex are refined: the four rings around a grid edge form a *stick*, which
has the material of one of the four cells.  Every pinched vertex is marked.  If possible, its sticks
follow the votes of pinched edges and of the vertex (its *ball*); otherwise all labels of its six
sticks are tried.  An unmarked vertex that becomes bad through its refined faces is marked too.  If
no sticks are good, all marked vertices that grid edges join take the *order rule*: every stick has
the first material among its four cells, which is good at every vertex.  Marks are only added, so
the procedure ends.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from tusqh.contacts.material_fractions import MaterialFractions
from tusqh.contacts.octants import octants
from tusqh.contacts.planar import find_diagonals
from tusqh.contacts.predict import Contacts, Labels
from tusqh.contacts.spatial_votes import SpatialVotes
from tusqh.contacts.stick_field import Costs, Field, find_pinched
from tusqh.contacts.sticks import improve, judge
from tusqh.contacts.votes import Votes
from tusqh.grid import BoolArray, IntArray


@dataclass(frozen=True)
class SpatialDecision:
    """Materials of cells, sticks and balls in a grid with two more layers of void.

    Parameters
    ----------
    labels
        Material of every cell, shape ``n + 4``.
    field
        Marks, sticks and the rings of single faces.
    contacts
        Pinched edges and vertices with their decided materials.
    n_overruled
        Number of pinched edges and vertices whose vote was overruled.
    n_by_order
        Number of vertices under the order rule.
    """

    labels: Labels
    field: Field
    contacts: Contacts
    n_overruled: int
    n_by_order: int


class _Decider:
    """The mutable state of marks, sticks and costs; see the module's docstring."""

    def __init__(self, votes: SpatialVotes) -> None:
        self.votes, self.tables = votes, octants()
        n = len(votes.labels)
        self.field = Field(
            labels=votes.labels,
            marked=np.zeros(n, dtype=bool),
            sticks=np.full((3, n), -1, dtype=np.int32),
            sides=np.zeros((3, n), dtype=np.uint8),
            steps=votes.steps,
        )
        for axis in range(3):
            lower = np.roll(votes.labels, votes.steps[axis])
            self.field.sides[axis] = votes.labels < lower
        self.by_order = np.zeros(n, dtype=bool)
        self.vertices = find_pinched(votes.labels, votes.shape, votes.steps, self.tables)
        self.octants, self.ball = votes.of_vertices(self.vertices)
        self.edges: list[tuple[int, IntArray, Labels, Votes]] = []
        row = np.full(n, -1, dtype=np.int32)
        row[self.vertices] = np.arange(len(self.vertices))
        self.costs = Costs(row, self.ball.price, np.full((3, n), -1, np.int32), np.empty((0, 4)))
        self._mark(self.vertices)
        prices = [votes.price for _, _, _, votes in self.edges]
        self.costs = self.costs._replace(edge_cost=np.concatenate([np.empty((0, 4)), *prices]))

    def run(self) -> None:
        """Decide all sticks."""
        while True:
            marked = np.flatnonzero(self.field.marked)
            while improve(marked, self.field, self.costs, self.by_order, self.tables):
                pass
            near = self._near()
            bad = near[judge(near, self.field, self.tables) == 0]
            is_marked = self.field.marked[bad]
            if is_marked.any():
                self._fall_back(bad[is_marked])
            elif len(bad):
                self._mark(bad)
                self._spread_order()
            else:
                break
        self._choose_sides()

    def _mark(self, vertices: IntArray) -> None:
        """Mark vertices and give sticks to those of their edges that have none."""
        self.field.marked[vertices] = True
        wish = np.full(len(self.field.marked), -1, dtype=np.int32)
        wish[self.vertices] = self.ball.winner
        for axis in range(3):
            step = self.votes.steps[axis]
            edges = np.unique(np.concatenate([vertices, vertices - step]))
            edges = edges[self.field.sticks[axis, edges] < 0]
            around, votes = self.votes.of_edges(axis, edges)
            is_pinched = find_diagonals(around.T)
            sticks = votes.winner.copy()
            for ends in (edges + step, edges):
                takes = ~is_pinched & (around == wish[ends][:, None]).any(axis=1)
                sticks[takes] = wish[ends][takes]
            self.field.sticks[axis, edges] = sticks
            if is_pinched.any():
                n = sum(len(numbers) for _, numbers, _, _ in self.edges)
                pinched = edges[is_pinched]
                self.costs.edge_row[axis, pinched] = n + np.arange(len(pinched))
                own = Votes(votes.winner[is_pinched], votes.price[is_pinched])
                self.edges.append((axis, pinched, around[is_pinched], own))

    def _near(self) -> IntArray:
        """Return the marked vertices and the vertices that share a face with one."""
        marked = np.flatnonzero(self.field.marked)
        is_near = np.zeros(len(self.field.marked), dtype=bool)
        offsets = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 3)
        for offset in offsets[np.abs(offsets).sum(axis=1) < 3]:
            is_near[marked + offset @ self.votes.steps] = True
        return np.flatnonzero(is_near)

    def _fall_back(self, vertices: IntArray) -> None:
        """Apply the order rule to all marked vertices that are joined to some vertices."""
        self.by_order[vertices] = True
        self._spread_order()

    def _spread_order(self) -> None:
        """Extend the order rule to all marked vertices that grid edges join to it."""
        if not self.by_order.any():
            return
        marked = self.field.marked.reshape(self.votes.shape)
        clusters = ndimage.label(marked)[0].ravel()
        reached = np.zeros(clusters.max() + 1, dtype=bool)
        reached[clusters[self.by_order]] = True
        reached[0] = False
        self.by_order |= reached[clusters]
        for axis in range(3):
            step = self.votes.steps[axis]
            vertices = np.flatnonzero(self.by_order)
            edges = np.unique(np.concatenate([vertices, vertices - step]))
            around = self.votes.octant[self.tables.around[2 * axis + 1]]
            first = self.votes.labels[edges[:, None] + around].min(axis=1)
            self.field.sticks[axis, edges] = first

    def _choose_sides(self) -> None:
        """Assign the rings of faces to the cell with the material of their sticks if that is good.

        Such faces stay plain.  Faces at a vertex whose verdict changes are reset, until none does.
        """
        faces, flat = self._find_sides()
        sides = self.field.sides.ravel()
        before = sides[faces]
        corners = faces[:, None] % len(self.field.labels) + flat
        vertices = np.unique(corners)
        allowed = judge(vertices, self.field, self.tables)
        sides[faces] = 1 - before
        while len(faces):
            differs = judge(vertices, self.field, self.tables) != allowed
            is_back = differs[np.searchsorted(vertices, corners)].any(axis=1)
            if not is_back.any():
                break
            sides[faces[is_back]] = before[is_back]
            faces, corners, before = faces[~is_back], corners[~is_back], before[~is_back]

    def _find_sides(self) -> tuple[IntArray, IntArray]:
        """Return the faces whose rings should move to the other cell, and steps to their corners.

        Faces are numbered over all axes; the steps have shape (f, 4).
        """
        n = len(self.field.labels)
        found, to_corners = [], []
        for axis in range(3):
            faces, lower, upper, sticks, has = face_sticks(self.field, axis)
            is_upper = self.field.sides[axis, faces] == 1
            other = np.where(is_upper, lower, upper)
            fits = ((sticks == other[:, None]) | ~has).all(axis=1)
            fits &= (lower != upper) & ~has.all(axis=1)
            a, b = self.votes.steps[axis - 2], self.votes.steps[axis - 1]
            found.append(axis * n + faces[fits])
            to_corners.append(np.tile([0, a, b, a + b], (int(fits.sum()), 1)))
        return np.concatenate(found), np.concatenate(to_corners)


def decide_sticks(
    fractions: MaterialFractions,
    labels: Labels,
    thresholds: IntArray,
) -> SpatialDecision:
    """Return the materials of all sticks and balls.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    labels
        Material of every cell, with two layers of void around them, shape ``n + 4``.
    thresholds
        Threshold of every material, in multiples of 2**-20, shape (m,).
    """
    decider = _Decider(SpatialVotes(fractions, labels, thresholds))
    decider.run()
    field, votes, vertices = decider.field, decider.votes, decider.vertices
    allowed = judge(vertices, field, decider.tables)
    is_allowed = (allowed[:, None] >> np.arange(8) & 1).astype(bool)
    best = np.where(is_allowed, decider.costs.vertex_cost, np.inf).argmin(axis=1)
    ball = np.take_along_axis(decider.octants, best[:, None], axis=1)[:, 0]
    half_edges = [(e // 2, vertices - (1 - e % 2) * votes.steps[e // 2]) for e in range(6)]
    nothing = np.empty((0, 4), dtype=np.int64)
    rows = [
        (e[:, None] + votes.octant[decider.tables.around[2 * axis + 1]], field.sticks[axis, e], v)
        for axis, e, _, v in decider.edges
    ]
    n_overruled = int((ball != decider.ball.winner).sum())
    n_overruled += sum(int((stick != v.winner).sum()) for _, stick, v in rows)
    return SpatialDecision(
        labels=labels,
        field=field,
        contacts=Contacts(
            vertex_cells=_to_cells(vertices[:, None] + votes.octant, votes.shape),
            ball=ball,
            sticks=np.stack([field.sticks[axis, e] for axis, e in half_edges], axis=1),
            edge_cells=_to_cells(np.concatenate([nothing, *[c for c, _, _ in rows]]), votes.shape),
            edge_material=np.concatenate([np.empty(0, np.int32), *[s for _, s, _ in rows]]),
        ),
        n_overruled=n_overruled,
        n_by_order=int(decider.by_order.sum()),
    )


def face_sticks(field: Field, axis: int) -> tuple[IntArray, Labels, Labels, Labels, BoolArray]:
    """Return the refined faces normal to an axis and the sticks along their edges.

    Parameters
    ----------
    field
        Marks and sticks.
    axis
        Direction of the normals.

    Returns
    -------
    faces
        Numbers of the faces, shape (f,).
    lower, upper
        Materials of the cells on both sides, shape (f,).
    sticks
        Materials of the sticks, shape (f, 4).  The first two lie along the next axis but one, at
        the lowest corner and one step along the next axis; the other two lie along the next axis
        likewise.
    has
        Whether these edges have a stick, shape (f, 4).
    """
    a, b = (axis + 1) % 3, (axis + 2) % 3
    step_a, step_b = field.steps[a], field.steps[b]
    marked = np.flatnonzero(field.marked)
    around = [marked - i * step_a - j * step_b for i in (0, 1) for j in (0, 1)]
    faces = np.unique(np.concatenate(around))
    edges = [(b, faces), (b, faces + step_a), (a, faces), (a, faces + step_b)]
    sticks = np.stack([field.sticks[k, e] for k, e in edges], axis=1)
    return faces, field.labels[faces - field.steps[axis]], field.labels[faces], sticks, sticks >= 0


def _to_cells(numbers: IntArray, shape: tuple[int, ...]) -> IntArray:
    """Return the flat cells of a grid from the numbers of their lowest vertices."""
    index = np.unravel_index(numbers, shape)
    return np.asarray(np.ravel_multi_index(index, tuple(n - 1 for n in shape)), dtype=np.int64)
