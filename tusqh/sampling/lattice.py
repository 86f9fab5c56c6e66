"""The lattice of samples, and how many of them each half-block has along an axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tusqh.grid import BackgroundGrid, FloatArray, IntArray

Box = tuple[tuple[float, ...], tuple[float, ...]]


@dataclass(frozen=True)
class Lattice:
    """Evenly spaced samples, grouped into half-blocks of equal size.

    A lattice in the plane is a lattice in space with a single layer; its axes are x, -, y.

    Parameters
    ----------
    origin
        The first sample, shape (3,), in model units.
    step
        Distance of neighbouring samples, in model units.
    half
        Samples along each side of a half-block, shape (3,).
    n_blocks
        Half-blocks along each axis, shape (3,).
    first, last
        The samples ``first <= k < last`` along each axis count and all others are 0; shape (3,)
        each.
    """

    origin: FloatArray
    step: float
    half: IntArray
    n_blocks: IntArray
    first: IntArray
    last: IntArray

    @classmethod
    def over_grid(cls, grid: BackgroundGrid, samples: int, window: Box | None = None) -> Lattice:
        """Return the lattice of `samples` samples along each side of every cell of a grid.

        Parameters
        ----------
        grid
            The background grid.
        samples
            Samples along each side of a cell, an even number.
        window
            Box, in model units; samples outside it count as void.

        Examples
        --------
        >>> grid = BackgroundGrid(shape=(2, 3), cell_size=1.0, origin=(0.0, 0.0))
        >>> lattice = Lattice.over_grid(grid, 4)
        >>> lattice.n_blocks.tolist(), lattice.half.tolist(), lattice.origin.tolist()
        ([4, 1, 6], [2, 1, 2], [0.125, 0.0, 0.125])
        """
        step = grid.cell_size / samples
        origin = np.array(grid.origin) + 0.5 * step
        shape = np.array(grid.shape, dtype=np.int64) * samples
        first, last = np.zeros_like(shape), shape.copy()
        if window is not None:
            for axis, (low, high) in enumerate(zip(*window, strict=True)):
                places = origin[axis] + step * np.arange(shape[axis])
                first[axis] = np.searchsorted(places, low, side="left")
                last[axis] = np.searchsorted(places, high, side="right")
        half = np.full(grid.dim, samples // 2, dtype=np.int64)
        parts = [origin, half, shape // half, first, np.maximum(first, last)]
        if grid.dim == 2:
            parts = [
                np.insert(part, 1, filler)
                for part, filler in zip(parts, (0, 1, 1, 0, 1), strict=True)
            ]
        origin, half, n_blocks, first, last = parts
        return cls(origin, step, half, n_blocks, first, last)

    @property
    def is_plane(self) -> bool:
        """Whether the lattice has a single layer."""
        return int(self.n_blocks[1] * self.half[1]) == 1

    def of_samples(self) -> Lattice:
        """Return the same lattice with one half-block for each sample."""
        ones = np.ones(3, dtype=np.int64)
        shape = self.n_blocks * self.half
        return Lattice(self.origin, self.step, ones, shape, self.first, self.last)

    def coverage(self) -> list[FloatArray]:
        """Return for each axis the share of samples that count in every half-block."""
        return [
            ((np.arange(n * h) >= f) & (np.arange(n * h) < t)).reshape(n, h).mean(axis=1)
            for n, h, f, t in zip(self.n_blocks, self.half, self.first, self.last, strict=True)
        ]

    def places(self, axis: int) -> FloatArray:
        """Return the coordinates of the samples along an axis, in model units.

        Parameters
        ----------
        axis
            The axis.
        """
        n = int(self.n_blocks[axis] * self.half[axis])
        return np.asarray(self.origin[axis] + self.step * np.arange(n))
