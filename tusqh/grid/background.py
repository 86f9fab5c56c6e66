"""The background grid of equal cells over a box."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tusqh.errors import SamplingError
from tusqh.grid.arrays import FloatArray, IntArray
from tusqh.grid.frame import Frame

#: Cell sizes whose cube does not underflow or overflow, in units of the model.
_SMALLEST, _LARGEST = 1e-100, 1e100


@dataclass(frozen=True)
class BackgroundGrid:
    """A grid of equal cubic cells laid over a box (paper: Volume Fractions).

    Parameters
    ----------
    shape
        Number of cells along each axis.
    cell_size
        Edge length of a cell, in the units of the model.
    origin
        Lowest corner of the grid, in the units of the model.
    unit
        Unit of length of the model; empty if it is not known.
    frame
        How the axes of the grid are turned, and the sides of cells that are not cubes.  `cell_size`
        and `origin` are in the coordinates of the grid, in which cells are cubes of the same
        volume.

    Examples
    --------
    >>> grid = BackgroundGrid(shape=(4, 3), cell_size=0.5, origin=(0.0, 1.0))
    >>> grid.n_cells, grid.upper
    (12, (2.0, 2.5))
    >>> grid.label
    '4x3'
    """

    shape: tuple[int, ...]
    cell_size: float
    origin: tuple[float, ...]
    unit: str = field(default="", repr=False)
    frame: Frame = field(default=Frame(), repr=False)

    def __post_init__(self) -> None:
        if len(self.shape) != len(self.origin) or len(self.shape) not in (2, 3):
            raise SamplingError(
                f"shape {self.shape} and origin {self.origin} do not describe a 2D or 3D grid",
                where="background grid",
                expected="two or three numbers in each",
                remedy="give one entry per axis",
            )
        if min(self.shape) < 1 or not _SMALLEST <= self.cell_size <= _LARGEST:
            raise SamplingError(
                f"shape {self.shape} with cell size {self.cell_size:g}",
                where="background grid",
                expected="at least one cell along each axis, of a positive size whose cube is "
                f"a number: from {_SMALLEST:g} to {_LARGEST:g}",
                remedy="correct `grid.cells` or `grid.cell_size`, or take another unit of length",
            )

    @property
    def dim(self) -> int:
        """Dimension of the grid, 2 or 3."""
        return len(self.shape)

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return math.prod(self.shape)

    @property
    def upper(self) -> tuple[float, ...]:
        """Highest corner of the grid, in the coordinates of the grid."""
        return tuple(o + n * self.cell_size for o, n in zip(self.origin, self.shape, strict=True))

    @property
    def sides(self) -> tuple[float, ...]:
        """Edge lengths of a cell along the axes of the grid, in model units."""
        return tuple(self.cell_size * side for side in self.frame.sides or (1.0,) * self.dim)

    @property
    def label(self) -> str:
        """The shape as text, such as ``60x79``."""
        return "x".join(str(n) for n in self.shape)

    def padded(self) -> BackgroundGrid:
        """Return the grid with one more layer of cells on every side."""
        return replace(
            self,
            shape=tuple(n + 2 for n in self.shape),
            origin=tuple(o - self.cell_size for o in self.origin),
        )

    def to_points(self, lattice: FloatArray | IntArray) -> FloatArray:
        """Return the points of the model, shape (n, dim), at positions in cells from the origin.

        Parameters
        ----------
        lattice
            Positions, shape (n, dim).
        """
        places = np.asarray(self.origin) + self.cell_size * np.asarray(lattice, dtype=np.float64)
        return self.frame.to_model(places)

    def to_lattice(self, points: FloatArray) -> FloatArray:
        """Return the positions of points of the model in cells from the origin, shape (n, dim).

        Parameters
        ----------
        points
            Points, shape (n, dim), in model units.
        """
        return np.asarray((self.frame.to_grid(points) - np.asarray(self.origin)) / self.cell_size)

    def to_dict(self) -> dict[str, Any]:
        """Return the grid as plain numbers, for JSON."""
        return {
            "shape": list(self.shape),
            "cell_size": self.cell_size,
            "origin": list(self.origin),
            **({"unit": self.unit} if self.unit else {}),
            **({} if self.frame.is_plain else {"frame": self.frame.to_dict()}),
        }

    @classmethod
    def from_dict(cls, numbers: dict[str, Any]) -> BackgroundGrid:
        """Return the grid that `to_dict` described.

        Parameters
        ----------
        numbers
            Shape, cell size and origin, the unit if it is known, and a frame that is not plain.
        """
        return cls(
            shape=tuple(int(n) for n in numbers["shape"]),
            cell_size=float(numbers["cell_size"]),
            origin=tuple(float(o) for o in numbers["origin"]),
            unit=str(numbers.get("unit", "")),
            frame=Frame.from_dict(numbers.get("frame", {})),
        )

    @classmethod
    def over_box(
        cls,
        lower: tuple[float, ...],
        upper: tuple[float, ...],
        *,
        cells: int | tuple[int, ...] | None = None,
        cell_size: float | None = None,
    ) -> BackgroundGrid:
        """Return the grid of cubic cells that covers a box, centred on it.

        Parameters
        ----------
        lower, upper
            Corners of the box, in the units of the model.
        cells
            Cells along the longest side (an int), or along each axis; the cells are cubes, so the
            axis that needs the largest ones determines their size and the others get some slack.
        cell_size
            Edge length of a cell, instead of a number of cells.

        Raises
        ------
        SamplingError
            The box has no extent along an axis, or not exactly one of `cells` and `cell_size`
            is given, or they are out of range.

        Examples
        --------
        >>> BackgroundGrid.over_box((0.0, 0.0), (4.0, 1.0), cells=8)
        BackgroundGrid(shape=(8, 2), cell_size=0.5, origin=(0.0, 0.0))
        >>> BackgroundGrid.over_box((0.0, 0.0), (4.0, 1.0), cells=(8, 4)).origin
        (0.0, -0.5)
        """
        extent = np.subtract(upper, lower)
        if not np.isfinite(extent).all() or (extent <= 0).any():
            raise SamplingError(
                f"the box from {tuple(lower)} to {tuple(upper)} has zero extent along an axis",
                where="background grid",
                expected="a positive extent along every axis",
                remedy="check the geometry, or give a `window` with an area",
            )
        if (cells is None) == (cell_size is None):
            raise SamplingError(
                f"cells is {cells} and cell_size is {cell_size}",
                where="background grid",
                expected="exactly one of them",
                remedy="give `cells` or `cell_size`, not both",
            )
        if cells is None:
            assert cell_size is not None
            size = float(cell_size)
        elif isinstance(cells, int):
            size = float(extent.max() / max(cells, 1))
        else:
            size = float(np.max(extent / np.maximum(cells, 1)))
        if isinstance(cells, tuple):
            shape = tuple(int(n) for n in cells)
        else:
            # A box that is a whole number of cells long must not gain one by rounding.
            shape = tuple(max(1, math.ceil(e / size - 1e-9)) for e in extent)
            if isinstance(cells, int) and cells < 1:
                shape = (0,) * len(shape)
        slack = np.multiply(shape, size) - extent
        origin = tuple(float(low - s / 2) for low, s in zip(lower, slack, strict=True))
        return cls(shape=shape, cell_size=size, origin=origin)
