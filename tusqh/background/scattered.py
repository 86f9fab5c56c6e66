"""Winding numbers of a geometry at scattered points: crossings of rays, and the cap by a tree.

The geometry is the sum of a closed cycle and a small cap (`tusqh.sampling.closing`).  The winding
number of the cycle is the number of its signed crossings by a ray in direction +z (in the plane
+x), which is exact; triangles are sorted into columns, so that a ray meets few of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numba
import numpy as np

from tusqh.fitting.planar.winding import wind_around, wind_beside_cap
from tusqh.geometry.kinds import Surface
from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.closing import Chain, close
from tusqh.sampling.winding_tree import WindingTree, plant, wind_beside

#: Up to this many pairs of a point and a triangle of the cap, angles are summed one by one.
_PAIRS = 200_000_000
#: Most columns along an axis.
_MOST_COLUMNS = 1024


@dataclass(frozen=True)
class ScatteredField:
    """The winding number of a geometry at any points.

    Parameters
    ----------
    cycle, cap
        Two chains whose sum is the geometry, in model units; in the plane with y = 0.
    is_plane
        Whether the geometry is an outline.
    """

    cycle: Chain
    cap: Chain
    is_plane: bool

    @classmethod
    def of(cls, geometry: Surface) -> ScatteredField:
        """Return the field of a geometry.

        Parameters
        ----------
        geometry
            The geometry, turned as for sampling.
        """
        return cls(*close(geometry), len(geometry.bounding_box()[0]) == 2)

    def at(self, points: FloatArray) -> FloatArray:
        """Return the winding numbers at points, shape (n,).

        Parameters
        ----------
        points
            Coordinates, shape (n, dim).

        Examples
        --------
        >>> from tusqh.geometry.soup import Soup
        >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        >>> faces = np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]])
        >>> field = ScatteredField.of(Soup(corners, faces, np.zeros(4, dtype=np.int64)))
        >>> field.at(np.array([[0.2, 0.2, 0.2], [0.2, 0.2, -0.1], [1.0, 1.0, 1.0]])).tolist()
        [1.0, 0.0, 0.0]
        """
        if self.is_plane:
            chains = [(c.corners[:, :, [0, 2]], c.multiplicity) for c in (self.cycle, self.cap)]
            return wind_around(points, *chains[0]) + wind_beside_cap(points, *chains[1])
        found = np.zeros(len(points))
        if len(self.cycle):
            _count_crossings(
                points, self.cycle.corners, self.cycle.multiplicity, *self._columns, found
            )
        if len(self.cap) * len(points) > _PAIRS:
            return found + wind_beside(self._tree, points, np.zeros_like(points))[:, 0]
        if len(self.cap):
            _sum_angles(points, self.cap.corners, self.cap.multiplicity, found)
        return found

    @cached_property
    def _tree(self) -> WindingTree:
        """The tree of the cap, with every triangle as often as it counts."""
        sign = np.sign(self.cap.multiplicity)
        turned = np.where(sign[:, None, None] < 0, self.cap.corners[:, ::-1], self.cap.corners)
        return plant(np.repeat(turned, np.abs(self.cap.multiplicity), axis=0))

    @cached_property
    def _columns(self) -> tuple[FloatArray, FloatArray, IntArray, IntArray, IntArray]:
        """Lowest corner and size of the columns, their numbers, and the triangles in each."""
        flat = self.cycle.corners[:, :, :2]
        low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
        n = int(np.clip(np.sqrt(len(flat)), 1, _MOST_COLUMNS))
        shape = np.array([n, n])
        size = np.maximum((high - low) / shape, 1e-300)
        first, last = (
            np.clip((end - low) / size, 0, shape - 1).astype(np.int64)
            for end in (flat.min(axis=1), flat.max(axis=1))
        )
        start = np.zeros(n * n + 1, dtype=np.int64)
        _count_in_columns(first, last, n, start)
        np.cumsum(start, out=start)
        listed = np.empty(start[-1], dtype=np.int64)
        _list_in_columns(first, last, n, start[:-1].copy(), listed)
        return low, size, shape, start, listed


@numba.njit(cache=True)
def _count_in_columns(first, last, n, start):  # type: ignore[no-untyped-def]
    for t in range(len(first)):
        for i in range(first[t, 0], last[t, 0] + 1):
            for j in range(first[t, 1], last[t, 1] + 1):
                start[i * n + j + 1] += 1


@numba.njit(cache=True)
def _list_in_columns(first, last, n, end, listed):  # type: ignore[no-untyped-def]
    for t in range(len(first)):
        for i in range(first[t, 0], last[t, 0] + 1):
            for j in range(first[t, 1], last[t, 1] + 1):
                listed[end[i * n + j]] = t
                end[i * n + j] += 1


@numba.njit(cache=True)
def _turns_around(corner, x, y):  # type: ignore[no-untyped-def]
    """Return how often a triangle, seen along z, winds around a point: -1, 0 or 1.

    Every edge is computed from its lower end, so that the triangles at it agree on every point.
    """
    turns = 0
    for k in range(3):
        ax, ay = corner[k, 0], corner[k, 1]
        bx, by = corner[(k + 1) % 3, 0], corner[(k + 1) % 3, 1]
        if (ay <= y) == (by <= y):
            continue
        if ay <= by:
            at = ax + (bx - ax) * ((y - ay) / (by - ay))
        else:
            at = bx + (ax - bx) * ((y - by) / (ay - by))
        if at > x:
            turns += 1 if by > ay else -1
    return turns


@numba.njit(cache=True, parallel=True)
def _count_crossings(  # type: ignore[no-untyped-def]
    points, corners, multiplicity, low, size, shape, start, listed, found
):
    """Add up the signed crossings of a ray in direction +z from every point."""
    for p in numba.prange(len(points)):
        x, y, z = points[p, 0], points[p, 1], points[p, 2]
        i, j = (x - low[0]) / size[0], (y - low[1]) / size[1]
        if i < 0 or j < 0 or i > shape[0] or j > shape[1]:
            continue
        column = min(int(i), shape[0] - 1) * shape[1] + min(int(j), shape[1] - 1)
        total = 0
        for e in range(start[column], start[column + 1]):
            t = listed[e]
            turns = _turns_around(corners[t], x, y)
            if turns != 0:
                ax, ay, az = corners[t, 0]
                ux, uy, uz = corners[t, 1, 0] - ax, corners[t, 1, 1] - ay, corners[t, 1, 2] - az
                vx, vy, vz = corners[t, 2, 0] - ax, corners[t, 2, 1] - ay, corners[t, 2, 2] - az
                nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
                at = az
                if nz != 0.0:
                    at = az - (nx * (x - ax) + ny * (y - ay)) / nz
                if at > z:
                    total += turns * multiplicity[t]
        found[p] += total


@numba.njit(cache=True, parallel=True)
def _sum_angles(points, corners, multiplicity, found):  # type: ignore[no-untyped-def]
    """Add the winding numbers of triangles (van Oosterom and Strackee, 1983)."""
    for p in numba.prange(len(points)):
        total = 0.0
        for t in range(len(corners)):
            ax, ay, az = corners[t, 0] - points[p]
            bx, by, bz = corners[t, 1] - points[p]
            cx, cy, cz = corners[t, 2] - points[p]
            a = np.sqrt(ax * ax + ay * ay + az * az)
            b = np.sqrt(bx * bx + by * by + bz * bz)
            c = np.sqrt(cx * cx + cy * cy + cz * cz)
            above = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
            below = a * b * c + (ax * bx + ay * by + az * bz) * c
            below += (bx * cx + by * cy + bz * cz) * a + (cx * ax + cy * ay + cz * az) * b
            total += multiplicity[t] * np.arctan2(above, below)
        found[p] += total / (2 * np.pi)
