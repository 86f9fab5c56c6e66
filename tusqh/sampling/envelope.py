"""The envelope of a geometry: what a ball cannot reach from outside.

The centre of the ball moves along the lattice of samples, from outside the bounding box, in steps
between neighbouring samples that are at least r' away from the geometry.  Here
``r' = sqrt(r^2 + s^2 / 4)`` for a ball of radius r and samples s apart, so all of a step is at
least r away from it.  Around every sample that the centre reaches, the ball grows until it touches
the geometry, at most to r' + 2 s; what it then covers is outside, all the rest is the envelope.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tusqh.errors import SamplingError
from tusqh.geometry.kinds import Surface
from tusqh.geometry.outline import Outline
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.machine import available_memory
from tusqh.sampling.flood import BLOCKED, NEAR, REACHED, cover, reach
from tusqh.sampling.nearest_triangle import BoxTree, find_nearest, make_tree
from tusqh.sampling.offset_scan import Marks, mark_near

#: By how many steps of the lattice the radius of the ball may grow where it has room.
GROWTH = 2.0
#: Samples that are looked through at a time.
_AT_A_TIME = 16_000_000
#: Relative difference of distances that edges between facets of a curved surface make.
_CURVED = 0.02


@dataclass(frozen=True)
class Envelope:
    """What a ball reaches, on a lattice that covers the geometry and a margin around it.

    Parameters
    ----------
    marks
        Marks of `tusqh.sampling.flood` for each sample, shape (n_x, n_y, n_z), n_y = 1 in the
        plane.  Samples without `REACHED` and `COVERED` are in the envelope.
    origin
        The first sample, in model units, shape (3,).
    step
        Distance of neighbouring samples, in model units.
    radius
        Least distance of the ball's centre from the geometry, in steps.
    tree
        The triangles of the geometry, in steps from the first sample.
    """

    marks: Marks
    origin: FloatArray
    step: float
    radius: float
    tree: BoxTree

    def is_touched(self, points: FloatArray, normals: FloatArray) -> BoolArray:
        """Return whether the ball touches points of the geometry from the side of a normal.

        Parameters
        ----------
        points
            Points of the geometry, in model units, shape (n, 3).
        normals
            Unit vectors, shape (n, 3).
        """
        centres = (points - self.origin) / self.step + self.radius * normals
        distance = find_nearest(self.tree, centres, within=2 * self.radius).distance
        is_free = distance >= self.radius * (1 - _CURVED)
        is_reached = np.zeros(len(points), dtype=np.bool_)
        last = np.array(self.marks.shape) - 1
        for corner in np.ndindex(2, min(2, len(self.marks[0])), 2):
            place = np.floor(centres).astype(np.int64) + corner
            is_in = ((place >= 0) & (place <= last)).all(axis=1)
            found = self.marks[tuple(np.clip(place, 0, last).T)] & REACHED > 0
            is_reached |= found | ~is_in
        return np.asarray(is_free & is_reached)


def make_envelope(geometry: Surface, seal: float, *, origin: FloatArray, step: float) -> Envelope:
    """Return the envelope of a geometry on the lattice through a sample.

    Parameters
    ----------
    geometry
        An outline or a soup.
    seal
        Diameter of the ball, in model units.
    origin
        A sample, in model units, shape (3,); in the plane x, 0, y.
    step
        Distance of neighbouring samples, in model units.

    Raises
    ------
    SamplingError
        The lattice does not fit in memory.

    Examples
    --------
    Two squares, one in the other: the ball does not come to the inner one.

    >>> from tusqh.geometry.outline import Outline
    >>> from tusqh.sampling.flood import COVERED
    >>> side = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    >>> squares = Outline.from_chains([2 * side, side])
    >>> envelope = make_envelope(squares, 1.0, origin=np.array([0.25, 0, 0.25]), step=0.5)
    >>> outside = envelope.marks & (REACHED | COVERED)
    >>> float((outside == 0).sum() * envelope.step**2)
    16.0
    """
    corners = (corners_of(geometry) - origin) / step
    radius = math.hypot(0.5 * seal / step, 0.5)
    margin = math.ceil(radius + GROWTH) + 2
    low = np.floor(corners.min(axis=(0, 1))) - margin
    high = np.ceil(corners.max(axis=(0, 1))) + margin
    if corners.shape[1] == 2:
        low[1] = high[1] = 0
    shape = tuple(int(n) for n in high - low + 1)
    _require_memory(shape, step, seal, geometry.name)
    corners = corners - low
    marks: Marks = np.zeros(shape, dtype=np.uint8)
    mark_near(corners, radius + GROWTH, NEAR, marks)
    mark_near(corners, radius, BLOCKED, marks)
    reach(marks)
    tree = make_tree(corners if corners.shape[1] == 3 else corners[:, [0, 1, 1]])
    _cover_near(marks, tree, radius + GROWTH)
    return Envelope(marks, origin + step * low, step, radius, tree)


def corners_of(geometry: Surface) -> FloatArray:
    """Return the corners of triangles, shape (m, 3, 3), or of segments, shape (m, 2, 3), y = 0.

    Parameters
    ----------
    geometry
        An outline or a soup.
    """
    if isinstance(geometry, Outline):
        return np.insert(geometry.points[geometry.segments], 1, 0.0, axis=2)
    return np.asarray(geometry.points[geometry.triangles], dtype=np.float64)


def _cover_near(marks: Marks, tree: BoxTree, within: float) -> None:
    """Cover what balls reach around the reached samples that are near the geometry."""
    centres: list[IntArray] = []
    rows = max(1, _AT_A_TIME // (marks.shape[1] * marks.shape[2]))
    for begin in range(0, len(marks), rows):
        found = np.argwhere(marks[begin : begin + rows] == NEAR | REACHED)
        found[:, 0] += begin
        centres.append(found)
    chosen = np.concatenate(centres)
    radii = find_nearest(tree, chosen.astype(np.float64), within=within).distance
    cover(marks, chosen, np.minimum(radii, within))


def _require_memory(shape: tuple[int, ...], step: float, seal: float, name: str) -> None:
    needed = 1.3 * math.prod(shape)
    available = available_memory()
    if needed > available:
        raise SamplingError(
            f"the envelope needs {math.prod(shape):,} samples {step:.3g} apart, about "
            f"{needed / 1e9:.3g} GB",
            where=name,
            expected=f"at most the {available / 1e9:.3g} GB that this machine has left",
            remedy=f"use larger cells or a larger `--seal` than {seal:.3g}, or leave out what lies "
            "far away: the ball moves around the whole geometry, not only in the window",
        )
