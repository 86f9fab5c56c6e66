"""The outline: line segments in the plane, exactly as a file gave them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tusqh.errors import GeometryError
from tusqh.grid import FloatArray, IntArray

__all__ = ["Outline"]


@dataclass(frozen=True)
class Outline:
    """Directed line segments in the plane, as read: nothing is merged, closed or dropped.

    Parameters
    ----------
    points
        Coordinates, shape (n, 2), in the units of the file.
    segments
        Start and end point of every segment, shape (m, 2).
    chains
        Number of the chain (ring, path or polyline of the file) to which each segment belongs,
        shape (m,).
    name
        Where it came from, for messages.
    parts
        Number of the part (feature or shape of a map) to which each segment belongs, shape (m,);
        None if the file has only chains.
    part_names
        Name of every part, empty for a part without one; none if the file has no names.
    unit
        Unit of length of the coordinates; empty if it is not known.

    Raises
    ------
    GeometryError
        There are no segments, coordinates are not finite, or the outline has no extent.
    """

    points: FloatArray
    segments: IntArray
    chains: IntArray
    name: str = "outline"
    parts: IntArray | None = None
    part_names: tuple[str, ...] = ()
    unit: str = ""

    def __post_init__(self) -> None:
        if len(self.segments) == 0:
            raise GeometryError(
                "the geometry is empty: no line segment in it",
                where=self.name,
                expected="at least one polygon, polyline, path or segment",
                remedy="check that the file holds the layers and geometry types you think it does",
            )
        n_bad = int((~np.isfinite(self.points)).any(axis=1).sum())
        if n_bad:
            first = int(np.flatnonzero((~np.isfinite(self.points)).any(axis=1))[0])
            raise GeometryError(
                f"{n_bad} of {len(self.points)} points have NaN or infinite coordinates "
                f"(the first is point {first}: {self.points[first].tolist()})",
                where=self.name,
                expected="finite coordinates",
                remedy="remove or correct those points in the file",
            )
        extent = np.ptp(self.points[np.unique(self.segments)], axis=0)
        if not extent.max() > 0:
            raise GeometryError(
                f"the geometry has zero extent: every point is {self.points[0].tolist()}",
                where=self.name,
                expected="an outline with an extent",
                remedy="check units and coordinates in the file",
            )

    @property
    def n_segments(self) -> int:
        """Number of segments."""
        return len(self.segments)

    def bounding_box(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the lowest and the highest corner of the box around the segments.

        Returns
        -------
        low, high : tuple of float
            Coordinates of the corners.
        """
        used = self.points[np.unique(self.segments)]
        low, high = used.min(axis=0), used.max(axis=0)
        return (float(low[0]), float(low[1])), (float(high[0]), float(high[1]))

    @classmethod
    def from_chains(cls, chains: list[FloatArray], *, name: str = "outline") -> Outline:
        """Return the outline of polylines.

        Parameters
        ----------
        chains
            Points of every polyline, shape (k, 2).
        name
            Where it came from, for messages.

        Examples
        --------
        >>> import numpy as np
        >>> corner = Outline.from_chains([np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0]])])
        >>> corner.segments.tolist(), corner.chains.tolist()
        ([[0, 1], [1, 2]], [0, 0])
        """
        kept = [np.asarray(c, dtype=np.float64).reshape(-1, 2) for c in chains]
        lengths = np.array([len(c) for c in kept], dtype=np.int64)
        first = np.concatenate([[0], np.cumsum(lengths)])
        n_points = int(first[-1])
        starts = np.arange(n_points, dtype=np.int64)
        is_last = np.zeros(n_points, dtype=bool)
        is_last[first[1:][lengths > 0] - 1] = True
        starts = starts[~is_last]
        return cls(
            points=np.concatenate(kept) if kept else np.empty((0, 2)),
            segments=np.column_stack([starts, starts + 1]),
            chains=np.repeat(np.arange(len(kept)), lengths)[starts].astype(np.int64),
            name=name,
        )
