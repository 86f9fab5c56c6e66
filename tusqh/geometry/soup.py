"""The soup: triangles in space, exactly as a file gave them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from tusqh.errors import GeometryError
from tusqh.geometry.boundary_chain import match_points
from tusqh.grid import FloatArray, IntArray

__all__ = ["Soup"]

#: Points, shape (n, 3), and the triangles between them, shape (m, 3).
Part = tuple[FloatArray, IntArray]


@dataclass(frozen=True)
class Soup:
    """Directed triangles in space, as read: nothing is merged, closed or dropped.

    Parameters
    ----------
    points
        Coordinates, shape (n, 3), in the units of the file.
    triangles
        Corners of every triangle, counter-clockwise seen from outside, shape (m, 3).
    parts
        Number of the part (object, solid or shell of the file) to which each triangle belongs,
        shape (m,).
    name
        Where it came from, for messages.
    part_names
        Name of every part, empty for a part without one; none if the file has no names.
    unit
        Unit of length of the coordinates; empty if it is not known.

    Raises
    ------
    GeometryError
        There are no triangles, corners are out of range, coordinates are not finite, or the soup
        has no extent.

    Examples
    --------
    >>> corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> Soup(corner, np.array([[0, 1, 2]]), np.array([0])).bounding_box()
    ((0.0, 0.0, 0.0), (1.0, 1.0, 0.0))
    """

    points: FloatArray
    triangles: IntArray
    parts: IntArray
    name: str = "soup"
    part_names: tuple[str, ...] = ()
    unit: str = ""

    def __post_init__(self) -> None:
        if len(self.triangles) == 0:
            raise GeometryError(
                "the geometry is empty: no triangle in it",
                where=self.name,
                expected="a surface of triangles or polygons",
                remedy="check that the file holds a surface, not only points or lines",
            )
        is_out = (self.triangles < 0) | (self.triangles >= len(self.points))
        if is_out.any():
            first = int(np.flatnonzero(is_out.any(axis=1))[0])
            raise GeometryError(
                f"{int(is_out.any(axis=1).sum())} triangles have corners out of range (the first "
                f"is triangle {first}: {self.triangles[first].tolist()})",
                where=self.name,
                expected=f"corners between 0 and {len(self.points) - 1}",
                remedy="export the file again; it is damaged",
            )
        used = np.unique(self.triangles)
        is_bad = ~np.isfinite(self.points[used]).all(axis=1)
        if is_bad.any():
            first = int(used[is_bad][0])
            raise GeometryError(
                f"{int(is_bad.sum())} of {len(used)} points have NaN or infinite coordinates "
                f"(the first is point {first}: {self.points[first].tolist()})",
                where=self.name,
                expected="finite coordinates",
                remedy="remove or correct those points in the file",
            )
        if not np.ptp(self.points[used], axis=0).max() > 0:
            raise GeometryError(
                f"the geometry has zero extent: every point is {self.points[used[0]].tolist()}",
                where=self.name,
                expected="a surface with an extent",
                remedy="check units and coordinates in the file",
            )

    def bounding_box(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the lowest and the highest corner of the box around the triangles.

        Returns
        -------
        low, high : tuple of float
            Coordinates of the corners.
        """
        return self._box

    @cached_property
    def _box(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        used = self.points[np.unique(self.triangles)]
        return tuple(used.min(axis=0).tolist()), tuple(used.max(axis=0).tolist())

    @cached_property
    def remembered(self) -> dict[Any, Any]:
        """What other modules have found out about this soup, by a key that they choose."""
        return {}

    def matched(self) -> tuple[FloatArray, IntArray]:
        """Return points and triangles after merging points with equal coordinates.

        Returns
        -------
        points : numpy.ndarray
            Distinct points, shape (n, 3).
        triangles : numpy.ndarray
            Indices of the points at the corners of every triangle, shape (m, 3).
        """
        points, number = match_points(self.points)
        return points, number[self.triangles]

    @classmethod
    def from_parts(
        cls, parts: Sequence[Part], *, name: str = "soup", part_names: Sequence[str] = ()
    ) -> Soup:
        """Return the soup of parts, each with its own points and triangles.

        Parameters
        ----------
        parts
            Points, shape (n, 3), and triangles, shape (m, 3), of every part.
        name
            Where it came from, for messages.
        part_names
            Names of the parts, see `Soup`.

        Raises
        ------
        GeometryError
            See `Soup`.

        Examples
        --------
        >>> corner = np.eye(3), np.array([[0, 1, 2]])
        >>> Soup.from_parts([corner, corner], name="two").triangles.tolist()
        [[0, 1, 2], [3, 4, 5]]
        """
        first = np.cumsum([0, *(len(points) for points, _ in parts)])
        triangles = [t + f for (_, t), f in zip(parts, first, strict=False)]
        return cls(
            points=np.concatenate([np.empty((0, 3)), *(points for points, _ in parts)]),
            triangles=np.concatenate([np.empty((0, 3), dtype=np.int64), *triangles]),
            parts=np.repeat(np.arange(len(parts)), [len(t) for _, t in parts]).astype(np.int64),
            name=name,
            part_names=tuple(part_names),
        )
