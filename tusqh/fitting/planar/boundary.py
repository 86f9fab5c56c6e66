"""What attracts each boundary point of a quad mesh: its patches, lines and goals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.fitting.planar.patches import Patches, find_patches, label_sides
from tusqh.fitting.planar.pillow import Layered, directions_of
from tusqh.fitting.planar.planes import Attraction, Lines
from tusqh.fitting.target import Target
from tusqh.grid import BoolArray, FloatArray, IntArray

#: Cosine of the smallest angle between the lines of two patches at a corner: 30 degrees.
_CORNER = 0.87

#: Weight of the line at a point; the rest is that of the middles of its two sides.
_OWN = 1 / 3

#: Longest way of a goal from the staircase, in cells, for points and for corners.
_FAR, _FAR_CORNER = 1.25, 1.75

#: Longest way of a goal from the point, in cells.
_STEP = 0.7

#: Weight of points that nothing attracts: they follow the smoothed staircase.
_SMOOTHED = 0.3


class Goals(NamedTuple):
    """Where points should go, for `tusqh.fitting.planar.energy.sweep_points`.

    Parameters
    ----------
    weight
        Weight of each point, shape (n,).
    matrix
        Entries xx, xy, yy of its matrix, shape (n, 3).
    place
        Where it should go, shape (n, 2).
    is_led
        Whether a line attracts it, shape (n,).
    """

    weight: FloatArray
    matrix: FloatArray
    place: FloatArray
    is_led: BoolArray


@dataclass(frozen=True)
class Boundary:
    """The boundary of a quad mesh with a layer, and what attracts it.

    Parameters
    ----------
    layered
        The mesh with its layer, before it moves.
    start
        Its points, shape (n, 2); the sides form the staircase.
    smoothed
        The points with a smoothed staircase, shape (n, 2).
    attraction
        The lines of the target.
    patches
        Its patches.
    labels
        Patch of every side, -1 for none, shape (k,).
    is_held
        Whether each side belongs to no surface, because topology was changed there, shape (k,).
    is_corner
        Points at which two patches meet, shape (n,).
    is_free
        Coordinates that may change, shape (n, 2).
    """

    layered: Layered
    start: FloatArray
    smoothed: FloatArray
    attraction: Attraction
    patches: Patches
    labels: IntArray
    is_held: BoolArray
    is_corner: BoolArray
    is_free: BoolArray

    @classmethod
    def of(cls, layered: Layered, target: Target, is_held: BoolArray) -> Boundary:
        """Return the boundary of a layered mesh with the patches of a target.

        Parameters
        ----------
        layered
            The mesh with its layer.
        target
            The target.
        is_held
            Sides that belong to no surface, shape (k,).
        """
        start, sides = layered.points.copy(), layered.sides
        patches = find_patches(target)
        loop = np.stack(layered.loop)
        normals = directions_of(start, sides)
        labels = label_sides(target, patches, start[sides].mean(axis=1), normals, loop)
        labels[is_held] = -1
        attraction = Attraction(target, patches)
        smoothed = start.copy()
        for _ in range(3):
            before, after = smoothed[sides[loop[0], 0]], smoothed[sides[:, 1]]
            smoothed[sides[:, 0]] = 0.5 * smoothed[sides[:, 0]] + 0.25 * (before + after)
        is_free = _free(layered, patches, labels, start)
        smoothed = np.where(is_free, smoothed, start)
        is_corner = np.zeros(len(start), dtype=np.bool_)
        two = _pairs(labels, loop, patches)
        at = sides[two, 0]
        direction = _point_normals(start, sides, loop)[two]
        one = attraction.lines(start[at], direction, labels[loop[0][two]])
        other = attraction.lines(start[at], direction, labels[two])
        is_sharp = (one.normal * other.normal).sum(axis=1) < _CORNER
        is_corner[at[is_sharp & one.holds & other.holds]] = True
        return cls(
            layered, start, smoothed, attraction, patches, labels, is_held, is_corner, is_free
        )

    def pieces(self, points: FloatArray) -> IntArray | None:
        """Return the piece between corners to which every side belongs, shape (k,).

        Parameters
        ----------
        points
            Coordinates of the fitted mesh, shape (n, 2).

        Returns
        -------
        pieces
            The piece of every side, -1 without a surface; None: the outline has no corners.
        """
        sides, before = self.layered.sides, self.layered.loop[0]
        normals = directions_of(points, sides)
        is_end = (normals * normals[before]).sum(axis=1) < _CORNER
        is_end &= self.labels != self.labels[before]
        is_end |= self.is_corner[sides[:, 0]]
        if not is_end.any():
            return None
        side, joined = np.arange(len(sides)), ~is_end & ~self.is_held & ~self.is_held[before]
        graph = coo_array(
            (np.ones(joined.sum()), (side[joined], before[joined])), shape=(len(side),) * 2
        )
        number = connected_components(graph, directed=False)[1]
        return np.where(self.is_held, -1, number).astype(np.int64)

    def goals(self, points: FloatArray, weight: float) -> Goals:
        """Return where the points should go from where they are now.

        Parameters
        ----------
        points
            Coordinates, shape (n, 2).
        weight
            Weight of the lines.
        """
        layered, n = self.layered, len(points)
        sides, loop = layered.sides, np.stack(layered.loop)
        at = sides[:, 0]
        own, middle = self._lines(points, loop)
        is_corner = self.is_corner[at]
        matrix, pull = np.zeros((len(at), 2, 2)), np.zeros((len(at), 2))
        here = points[at]
        is_own = own[0].holds & ~(self.is_held & self.is_held[loop[0]])
        _add(matrix, pull, own[0], here, np.where(is_corner, 1.0, _OWN) * is_own)
        _add(matrix, pull, own[1], here, np.where(is_corner & own[1].holds, 1.0, 0.0))
        for rows in (np.arange(len(at)), loop[0]):
            line = Lines(middle.foot[rows], middle.normal[rows], middle.holds[rows])
            share = np.where(line.holds & ~is_corner & ~self.is_held[rows], (1 - _OWN) / 2, 0.0)
            _add(matrix, pull, line, points[sides[rows]].mean(axis=1), share)
        step = np.linalg.solve(matrix + 0.02 * np.eye(2), pull[:, :, None])[:, :, 0]
        step *= np.minimum(1, _STEP / np.maximum(np.linalg.norm(step, axis=1), 1e-12))[:, None]
        far = np.where(is_corner, _FAR_CORNER, _FAR)
        is_led = is_own & (np.linalg.norm(here + step - self.start[at], axis=1) < far)
        rest = 0.2 / max(weight, 100.0)
        goal = Goals(np.zeros(n), np.zeros((n, 3)), points.copy(), np.zeros(n, dtype=np.bool_))
        entries = np.stack(
            [matrix[:, 0, 0] + rest, matrix[:, 0, 1], matrix[:, 1, 1] + rest], axis=1
        )
        without = np.array([_SMOOTHED, 0.0, _SMOOTHED])
        goal.weight[at] = np.where(is_led, np.where(is_corner, 5 * weight, weight), 1.0)
        goal.matrix[at] = np.where(is_led[:, None], entries, without)
        goal.place[at] = np.where(is_led[:, None], here + step, self.smoothed[at])
        goal.is_led[at] = is_led
        return goal

    def _lines(self, points: FloatArray, loop: IntArray) -> tuple[tuple[Lines, Lines], Lines]:
        """Return the lines at the first point of every side, and in the middle of every side."""
        sides = self.layered.sides
        at = sides[:, 0]
        normals = directions_of(points, sides)
        at_points = _point_normals(points, sides, loop)
        before = self.labels[loop[0]]
        is_corner = self.is_corner[at]
        patch = np.where(is_corner | (before == self.labels), before, -1)
        own = self.attraction.lines(points[at], at_points, patch)
        other = self.attraction.lines(points[at], at_points, self.labels)
        middle = self.attraction.lines(points[sides].mean(axis=1), normals, self.labels)
        return (own, other), middle


def _pairs(labels: IntArray, loop: IntArray, patches: Patches) -> IntArray:
    """Return the sides at whose first point two long patches meet."""
    before = labels[loop[0]]
    rows = np.flatnonzero((labels >= 0) & (before >= 0) & (labels != before))
    return np.asarray(rows[patches.is_long[labels[rows]] & patches.is_long[before[rows]]])


def _point_normals(points: FloatArray, sides: IntArray, loop: IntArray) -> FloatArray:
    """Return the outward unit normal at the first point of every side, shape (k, 2)."""
    normals = directions_of(points, sides)
    normals = normals + normals[loop[0]]
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-12)[:, None])


def _free(layered: Layered, patches: Patches, labels: IntArray, start: FloatArray) -> BoolArray:
    """Return the coordinates that may change: not those of points on sides of the box."""
    is_free = np.ones((len(start), 2), dtype=np.bool_)
    rows = np.flatnonzero(labels >= 0)
    rows = rows[patches.axis[labels[rows]] >= 0]
    axis, place = patches.axis[labels[rows]], patches.place[labels[rows]]
    for k in range(2):
        points = layered.sides[rows, k]
        is_on = np.abs(start[points, axis] - place) < 1e-9
        is_free[points[is_on], axis[is_on]] = False
    return is_free


def _add(
    matrix: FloatArray, pull: FloatArray, lines: Lines, places: FloatArray, weight: FloatArray
) -> None:
    """Add weighted lines to the matrices and pulls of points."""
    normal = lines.normal
    off = ((lines.foot - places) * normal).sum(axis=1)
    matrix += weight[:, None, None] * normal[:, :, None] * normal[:, None]
    pull += (weight * off)[:, None] * normal
