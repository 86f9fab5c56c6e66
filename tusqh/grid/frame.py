"""The frame of a grid: how its axes are turned, and the sides of its cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tusqh.grid.arrays import FloatArray


@dataclass(frozen=True)
class Frame:
    """A linear map from the space of the model to that of the grid, where cells are cubes.

    Points are turned onto the axes of the grid, and their coordinates divided by the sides of a
    cell.  The map preserves volumes, because the product of `sides` is 1.  Without turn and sides
    it changes nothing.

    Parameters
    ----------
    axes
        Directions of the axes of the grid in the model, one row each, orthonormal and
        right-handed; empty: the axes of the coordinates.
    sides
        Edge lengths of a cell along these axes, divided by their geometric mean; empty: cells are
        cubes.

    Examples
    --------
    >>> turned = Frame(axes=((0.0, 1.0), (-1.0, 0.0)))
    >>> turned.to_grid(np.array([[2.0, 1.0]])).tolist()
    [[1.0, -2.0]]
    >>> Frame(sides=(2.0, 0.5)).to_grid(np.array([[2.0, 1.0]])).tolist()
    [[1.0, 2.0]]
    """

    axes: tuple[tuple[float, ...], ...] = ()
    sides: tuple[float, ...] = ()

    @property
    def is_plain(self) -> bool:
        """Whether model and grid have the same coordinates."""
        return not self.axes and not self.sides

    def to_grid(self, points: FloatArray) -> FloatArray:
        """Return points of the model in the coordinates of the grid, shape (..., dim).

        Parameters
        ----------
        points
            Points, shape (..., dim), in model units.
        """
        if self.axes:
            points = _turn(points, np.array(self.axes))
        return points / self.sides if self.sides else points

    def to_model(self, points: FloatArray) -> FloatArray:
        """Return points in the coordinates of the grid as points of the model, shape (..., dim).

        Parameters
        ----------
        points
            Points, shape (..., dim).
        """
        if self.sides:
            points = points * self.sides
        return _turn(points, np.array(self.axes).T) if self.axes else points

    def to_dict(self) -> dict[str, Any]:
        """Return what is not plain as numbers, for JSON."""
        found = {"axes": [list(axis) for axis in self.axes], "sides": list(self.sides)}
        return {name: values for name, values in found.items() if values}

    @classmethod
    def from_dict(cls, numbers: dict[str, Any]) -> Frame:
        """Return the frame that `to_dict` described.

        Parameters
        ----------
        numbers
            Axes and sides, where they are not plain.
        """
        axes = tuple(tuple(float(x) for x in axis) for axis in numbers.get("axes", ()))
        return cls(axes, tuple(float(x) for x in numbers.get("sides", ())))

    @classmethod
    def of_sides(cls, axes: FloatArray | None, lengths: Sequence[float]) -> tuple[Frame, float]:
        """Return the frame of cells with given edge lengths, and their geometric mean.

        Parameters
        ----------
        axes
            Directions of the axes of the grid, shape (dim, dim); None: those of the coordinates.
        lengths
            Edge lengths of a cell, in model units.

        Returns
        -------
        frame, cell_size
            The frame, and the edge length of a cube of the same volume.

        Examples
        --------
        >>> Frame.of_sides(None, (4.0, 1.0))
        (Frame(axes=(), sides=(2.0, 0.5)), 2.0)
        """
        rows = () if axes is None else tuple(map(tuple, np.asarray(axes, dtype=float).tolist()))
        if len(set(lengths)) == 1:
            return cls(axes=rows), float(lengths[0])
        mean = float(np.prod(np.power(lengths, 1 / len(lengths))))
        return cls(rows, tuple(float(x / mean) for x in lengths)), mean


def _turn(points: FloatArray, axes: FloatArray) -> FloatArray:
    """Return the coordinates of points along axes; without BLAS, whose rounding varies."""
    columns = [
        sum((points[..., k] * axis[k] for k in range(1, len(axis))), points[..., 0] * axis[0])
        for axis in axes
    ]
    return np.stack(columns, axis=-1)
