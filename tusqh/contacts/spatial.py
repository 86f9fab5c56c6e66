"""Resolve contacts in 3D: every pinched edge and vertex gets the material that wins its vote.

The faces between two materials at a *marked* vertex are refined: the rings around a grid edge form
a *stick* of one material, except between cells of one material.  Every pinched vertex is marked.
Its pinched edges have the sticks for which they vote; the labels of the other sticks are chosen so
that every material around it is a manifold, joined as the edges and the vertex (its *ball*) vote,
with as few elements as possible.  Where no labels are good, the vertex gets elements for its ball
alone, which are good with any sticks.  An unmarked vertex that becomes bad through its refined
faces is marked too.  Marks and balls are only added, so the procedure ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.decided import Contacts, Labels
from tusqh.contacts.octants import octants
from tusqh.contacts.planar import find_diagonals
from tusqh.contacts.spatial_votes import LAYERS, SpatialVotes
from tusqh.contacts.stick_field import Field, faces_of_kites, find_pinched
from tusqh.contacts.sticks import improve, judge
from tusqh.contacts.votes import Fractions
from tusqh.grid import BoolArray, IntArray

#: Sweeps over the marked vertices; a few suffice, and stopping early costs elements only.
_MAX_SWEEPS = 20


@dataclass(frozen=True)
class SpatialDecision:
    """Materials of cells, sticks and balls in a grid with two more layers of void.

    Parameters
    ----------
    labels
        Material of every cell, shape ``n + 4``, a view of those of `field`.
    field
        Marks, sticks and the rings of single faces.
    contacts
        Pinched edges and vertices with their decided materials.
    n_overruled
        Number of pinched edges and vertices whose vote was overruled, which is 0.
    bridged
        Edges between cells of void whose sticks belong to a bridge, numbered as in `field`, shape
        (3, n_v); None without bridges.
    """

    labels: NDArray[np.signedinteger]
    field: Field
    contacts: Contacts
    n_overruled: int
    bridged: BoolArray | None = None


class _Decider:
    """The mutable state of marks and sticks; see the module's docstring."""

    def __init__(self, votes: SpatialVotes) -> None:
        self.votes, self.tables = votes, octants()
        n = len(votes.labels)
        self.field = Field(
            labels=votes.labels,
            inside=votes.inside,
            between=np.zeros(n, dtype=np.uint8),
            ball=np.full(n, -1, dtype=votes.labels.dtype),
            is_pinched=np.zeros((3, n), dtype=bool),
            marked=np.zeros(n, dtype=bool),
            has_ball=np.zeros(n, dtype=bool),
            sticks=np.full((3, n), -1, dtype=votes.labels.dtype),
            sides=np.zeros((3, n), dtype=np.uint8),
            stale=np.zeros(n, dtype=bool),
            verdict=np.full(n, -1, dtype=np.int8),
            steps=votes.steps,
            octant=votes.octant,
            face=faces_of_kites(votes.steps, self.tables.kites),
        )
        for axis in range(3):
            lower = np.roll(votes.labels, votes.steps[axis])
            self.field.sides[axis] = votes.labels < lower
            both = votes.inside & np.roll(votes.inside, votes.steps[axis])
            self.field.between[both & (votes.labels != lower)] |= 1 << axis
        self.vertices = find_pinched(votes.labels, votes.shape, votes.steps, self.tables)
        self.field.ball[self.vertices] = votes.of_vertices(self.vertices)
        self._mark(self.vertices)
        self.field.stale[self.vertices] = True

    def lay(self, paths: Sequence[IntArray], material: int) -> BoolArray:
        """Give balls to the vertices of bridges and sticks to their edges, and return these edges.

        The sticks count as pinched, so that they keep their material.
        """
        field, bridged = self.field, np.zeros(self.field.is_pinched.shape, dtype=bool)
        for path in paths:
            vertices = np.ravel_multi_index(tuple((path + LAYERS).T), self.votes.shape)
            field.ball[vertices], field.has_ball[vertices] = material, True
            self._mark(vertices)
            axis = np.abs(np.diff(path, axis=0)).argmax(axis=1)
            edges = np.minimum(vertices[:-1], vertices[1:])
            bridged[axis, edges] = True
            field.sticks[axis, edges] = material
            self._make_stale(vertices)
        field.is_pinched[bridged] = True
        return bridged

    def run(self) -> None:
        """Decide all sticks."""
        while True:
            marked = np.flatnonzero(self.field.marked)
            for _ in range(_MAX_SWEEPS):
                if improve(marked, self.field, self.votes.void, self.tables) == 0:
                    break
            near = self._near()
            bad = near[~judge(near, self.field, self.tables)]
            if len(bad) == 0:
                break
            is_marked = self.field.marked[bad]
            self.field.has_ball[bad[is_marked]] = True
            self._mark(bad[~is_marked])
            self._make_stale(bad)
        self._choose_sides()

    def _mark(self, vertices: IntArray) -> None:
        """Mark vertices and give sticks to those of their edges that have none."""
        field = self.field
        field.marked[vertices] = True
        for axis in range(3):
            step = self.votes.steps[axis]
            edges = np.unique(np.concatenate([vertices, vertices - step]))
            edges = edges[field.sticks[axis, edges] < 0]
            around, winner = self.votes.of_edges(axis, edges)
            is_pinched = find_diagonals(around.T)
            # A stick on a side of the grid has a material of its cells in the grid.
            cells = edges[:, None] + self.votes.octant[self.tables.around[2 * axis + 1]]
            inside = self.votes.inside[cells]
            first = np.take_along_axis(around, inside.argmax(axis=1)[:, None], axis=1)
            around = np.where(inside, around, first)
            is_missing = (around != winner[:, None]).all(axis=1)
            winner[is_missing] = first[is_missing, 0]
            field.is_pinched[axis, edges] = is_pinched
            for ends in (edges + step, edges):
                ball = field.ball[ends]
                takes = ~is_pinched & (around == ball[:, None]).any(axis=1)
                winner[takes] = ball[takes]
            field.sticks[axis, edges] = winner

    def _make_stale(self, vertices: IntArray) -> None:
        """Note that something has changed at some vertices, for those up to two edges away."""
        offsets = np.stack(np.meshgrid(*[np.arange(-2, 3)] * 3), axis=-1).reshape(-1, 3)
        for offset in offsets @ self.votes.steps:
            near = (vertices + offset) % len(self.field.marked)
            self.field.stale[near] = self.field.marked[near]
            self.field.verdict[near] = -1

    def _near(self) -> IntArray:
        """Return the marked vertices and the vertices that share a face with one."""
        marked = np.flatnonzero(self.field.marked)
        is_near = np.zeros(len(self.field.marked), dtype=bool)
        offsets = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 3)
        for offset in offsets[np.abs(offsets).sum(axis=1) < 3]:
            is_near[marked + offset @ self.votes.steps] = True
        return np.flatnonzero(is_near)

    def _choose_sides(self) -> None:
        """Assign the rings of faces to the cell with the material of their sticks if that is good.

        Such faces stay plain.  Faces at a vertex whose verdict changes are reset, until none does.
        """
        faces, flat = self._find_sides()
        sides = self.field.sides.ravel()
        before = sides[faces]
        corners = faces[:, None] % len(self.field.labels) + flat
        vertices = np.unique(corners)
        was_good = judge(vertices, self.field, self.tables)
        sides[faces] = 1 - before
        while len(faces):
            differs = judge(vertices, self.field, self.tables) < was_good
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
    fractions: Fractions,
    labels: Labels,
    thresholds: IntArray,
    *,
    paths: Sequence[IntArray] = (),
    material: int = 0,
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
    paths
        Grid vertices of bridges through void, in order, shape (p, 3) each.
    material
        Material of the bridges.
    """
    votes = SpatialVotes(fractions, labels, thresholds)
    decider = _Decider(votes)
    bridged = decider.lay(paths, material) if len(paths) else None
    decider.run()
    if bridged is not None:
        decider.field.is_pinched[bridged] = False
    field, vertices = decider.field, decider.vertices
    sticks = np.full((len(vertices), 6), -1, dtype=np.int32)
    for e in range(6):
        edges = vertices - (1 - e % 2) * votes.steps[e // 2]
        is_pinched = field.is_pinched[e // 2, edges]
        sticks[is_pinched, e] = field.sticks[e // 2, edges[is_pinched]]
    pinched = [np.flatnonzero(field.is_pinched[axis]) for axis in range(3)]
    edge_cells = [
        edges[:, None] + votes.octant[decider.tables.around[2 * axis + 1]]
        for axis, edges in enumerate(pinched)
    ]
    return SpatialDecision(
        labels=votes.labels.reshape(votes.shape)[:-1, :-1, :-1],
        field=field,
        contacts=Contacts(
            vertex_cells=to_cells(vertices[:, None] + votes.octant, votes.shape),
            ball=field.ball[vertices].astype(np.int32),
            sticks=sticks,
            edge_cells=to_cells(np.concatenate(edge_cells), votes.shape),
            edge_material=np.concatenate(
                [field.sticks[k, e] for k, e in enumerate(pinched)], dtype=np.int32
            ),
        ),
        n_overruled=0,
        bridged=bridged,
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
    has_ball = np.zeros(len(faces), dtype=bool)
    for corner in (0, step_a, step_b, step_a + step_b):
        has_ball |= field.has_ball[faces + corner]
    lower = faces - field.steps[axis]
    # On the sides of the grid only the faces at balls are refined.
    differ = field.labels[lower] != field.labels[faces]
    n_inside = field.inside[lower].astype(int) + field.inside[faces]
    faces = faces[(has_ball & (n_inside > 0)) | (differ & (n_inside == 2))]
    edges = [(b, faces), (b, faces + step_a), (a, faces), (a, faces + step_b)]
    sticks = np.stack([field.sticks[k, e] for k, e in edges], axis=1)
    return faces, field.labels[faces - field.steps[axis]], field.labels[faces], sticks, sticks >= 0


def to_cells(numbers: IntArray, shape: tuple[int, ...]) -> IntArray:
    """Return the flat cells of a grid from the numbers of their lowest vertices.

    Parameters
    ----------
    numbers
        Numbers of vertices.
    shape
        Number of vertices along each axis.
    """
    index = np.unravel_index(numbers, shape)
    return np.asarray(np.ravel_multi_index(index, tuple(n - 1 for n in shape)), dtype=np.int64)
