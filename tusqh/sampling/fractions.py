"""Volume fractions of the grid cells of all dimensions from one lattice of samples.

The fictitious cell that the paper centres at a primal cell (Sub-cell Volume Fractions) covers,
along each axis, the half-blocks ``c - 1`` and ``c`` of the doubled grid::

    half-blocks     |  0  |  1  |  2  |  3  |        two per cell
    doubled grid    0     1     2     3     4        odd: cells, even: vertices
    fraction of 1      = mean of half-blocks 0 and 1 (the cell)
    fraction of 2      = mean of half-blocks 1 and 2 (the vertex between two cells)

Therefore the fractions of cells, edges and vertices are one moving average of the half-block means.
Everything outside the grid is empty.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from tusqh.errors import SamplingError
from tusqh.geometry.kinds import Surface
from tusqh.grid import BackgroundGrid, BoolArray, FloatArray, IntArray, doubled
from tusqh.sampling.doubled_grid import (
    RESOLUTION,
    Multiples,
    average_coverage,
    average_half_blocks,
)
from tusqh.sampling.field import WindingField
from tusqh.sampling.half_blocks import Tally, clipped_by_chunk, sums_by_chunk
from tusqh.sampling.inside import field_of, without_directions
from tusqh.sampling.lattice import Box, Lattice
from tusqh.sampling.memory import require_memory
from tusqh.sampling.nothing_inside import LEAST_MADE, nothing_inside
from tusqh.sampling.placement import Placement
from tusqh.settings.sampling import Sampling


@dataclass(frozen=True)
class VolumeFractions:
    """The volume fractions of every primal cell of a background grid.

    Parameters
    ----------
    grid
        The background grid, of shape n.
    samples
        Samples along each side of a cell.
    multiples
        Fractions on the doubled grid as multiples of `RESOLUTION`, shape ``2 n + 1``, int32.
        Values below 0 or above 1 / `RESOLUTION` occur where the winding number is below 0 or
        above 1.
    placement
        Where the grid was placed; None: at the corner, as requested.
    """

    grid: BackgroundGrid
    samples: int
    multiples: Multiples
    placement: Placement | None = None

    @classmethod
    def from_values(cls, grid: BackgroundGrid, samples: int, values: FloatArray) -> VolumeFractions:
        """Return the fractions with given values, shape ``2 n + 1``, rounded to `RESOLUTION`.

        Parameters
        ----------
        grid
            The background grid, of shape n.
        samples
            Samples along each side of a cell.
        values
            Fractions on the doubled grid, shape ``2 n + 1``, dimensionless.
        """
        return cls(grid, samples, np.rint(values / RESOLUTION).astype(np.int32))

    @property
    def values(self) -> FloatArray:
        """Fractions on the doubled grid, shape ``2 n + 1``, dimensionless; a new array."""
        return np.asarray(self.multiples * RESOLUTION, dtype=np.float64)

    @cached_property
    def cells(self) -> FloatArray:
        """Fractions of the cells, shape n; `cell_multiples` needs no memory."""
        return np.asarray(self.cell_multiples * RESOLUTION, dtype=np.float64)

    @property
    def cell_multiples(self) -> Multiples:
        """Fractions of the cells in multiples of `RESOLUTION`, shape n, a view."""
        return self.multiples[doubled.cells(self.grid.dim)]

    @property
    def vertices(self) -> FloatArray:
        """Sub-cell fractions of the grid vertices, shape ``n + 1``."""
        return np.asarray(
            self.multiples[doubled.vertices(self.grid.dim)] * RESOLUTION, dtype=np.float64
        )

    def volume(self) -> float:
        """Return the volume (2D: area) that the cell fractions add up to, in model units."""
        total = int(self.cell_multiples.sum(dtype=np.int64))
        return total * RESOLUTION * self.grid.cell_size**self.grid.dim

    def count_at_least(self, thresholds: FloatArray) -> IntArray:
        """Return the number of cells with at least each of some fractions.

        Parameters
        ----------
        thresholds
            Volume fractions, shape (r,).
        """
        return np.array([self.cells_at_least(level).sum() for level in thresholds], dtype=np.int64)

    def count_ties(self, threshold: float) -> int:
        """Return the number of cells whose fraction is the threshold itself.

        Parameters
        ----------
        threshold
            Volume fraction, dimensionless.
        """
        return int((self.cell_multiples == to_level(threshold)).sum())

    def at_least(self, threshold: float) -> BoolArray:
        """Return where the fraction is at least a threshold, on the doubled grid.

        Fractions are multiples of `RESOLUTION`, so comparing integers is exact.

        Parameters
        ----------
        threshold
            Volume fraction, dimensionless.
        """
        return np.asarray(self.multiples >= to_level(threshold))

    def cells_at_least(self, threshold: float) -> BoolArray:
        """Return which cells have at least a fraction, shape n.

        Parameters
        ----------
        threshold
            Volume fraction, dimensionless.
        """
        return np.asarray(self.cell_multiples >= to_level(threshold))


def sample_fractions(
    geometry: Surface,
    grid: BackgroundGrid,
    *,
    sampling: Sampling | None = None,
    window: Box | None = None,
    field: WindingField | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> VolumeFractions:
    """Return the volume fractions of an outline or a soup on a grid.

    Parameters
    ----------
    geometry
        The geometry.
    grid
        The background grid.
    sampling
        How the fractions are sampled; None: with the defaults.
    window
        Box, in model units; samples outside it count as void.
    field
        What is averaged; None: that of `tusqh.sampling.inside.field_of`.
    progress
        Called with (samples done, samples in all).

    Raises
    ------
    SamplingError
        `samples` is odd or not positive, the grid does not fit in memory, the window or grid misses
        the geometry, the winding number is zero everywhere, or the grid holds nothing of the
        domain.

    Examples
    --------
    A unit square on a grid of cells twice as large: the vertex at its centre sees all of the
    four quarter cells around it that the square covers.

    >>> from tusqh.geometry.outline import Outline
    >>> square = np.array([[1.0, 1], [3, 1], [3, 3], [1, 3], [1, 1]])
    >>> grid = BackgroundGrid(shape=(2, 2), cell_size=2.0, origin=(0.0, 0.0))
    >>> sample_fractions(Outline.from_chains([square]), grid).values.tolist()[1:4]
    [[0.0, 0.25, 0.5, 0.25, 0.0], [0.0, 0.5, 1.0, 0.5, 0.0], [0.0, 0.25, 0.5, 0.25, 0.0]]
    """
    sampling = sampling or Sampling()
    samples, domain = sampling.samples, sampling.domain
    require_samples(geometry, grid, sampling, window)
    require_memory(grid, "sampling", name=geometry.name)
    lattice = Lattice.over_grid(grid, samples, window)
    field = field or field_of(geometry, sampling, grid.cell_size)
    orientation = without_directions(sampling).orientation
    tally = Tally(float(lattice.half.prod()))
    if sampling.rule == "average":
        multiples = average_half_blocks(sums_by_chunk(field, lattice, tally, progress), lattice)
        sign = tally.sign(orientation)
        np.multiply(multiples, sign, out=multiples)
        if domain == "outside":
            np.subtract(average_coverage(lattice), multiples, out=multiples)
    else:
        for _ in sums_by_chunk(field, lattice, tally):  # Clipping needs the sign.
            pass
        sign = tally.sign(orientation)
        clipped = clipped_by_chunk(field, lattice, sign, domain, progress)
        multiples = average_half_blocks(clipped, lattice)
    is_made = sampling.inside != "winding"
    if not tally.is_nonzero or (is_made and (multiples < LEAST_MADE).all()):
        raise nothing_inside(geometry, sampling, grid.cell_size)
    fractions = VolumeFractions(grid=grid, samples=samples, multiples=multiples)
    if not (multiples[doubled.cells(grid.dim)] > 0).any():
        raise SamplingError(
            f"no cell of the {grid.label} grid has a positive fraction of the {domain} of the "
            "geometry",
            where=geometry.name,
            expected="some material in the grid",
            remedy="use the other `domain`, `orientation: auto`, a finer grid or another window",
        )
    return fractions


def to_level(threshold: float) -> int:
    """Return the lowest multiple of `RESOLUTION` that is at least a threshold.

    Parameters
    ----------
    threshold
        Volume fraction, dimensionless.

    Examples
    --------
    >>> to_level(0.5), to_level(0.3) * RESOLUTION >= 0.3 > (to_level(0.3) - 1) * RESOLUTION
    (524288, True)
    """
    return math.ceil(threshold / RESOLUTION)


def round_fractions(values: FloatArray) -> FloatArray:
    """Return fractions rounded to multiples of `RESOLUTION`.

    Parameters
    ----------
    values
        Fractions of any shape, dimensionless.

    Examples
    --------
    >>> float(round_fractions(np.array([1 / 3]))[0] / RESOLUTION)
    349525.0
    """
    return np.rint(values / RESOLUTION) * RESOLUTION + 0.0  # + 0.0 turns -0.0 into 0.0


def require_samples(
    geometry: Surface, grid: BackgroundGrid, sampling: Sampling, window: Box | None
) -> None:
    """Raise a `SamplingError` if a geometry cannot be sampled on a grid.

    Parameters
    ----------
    geometry, grid, sampling, window
        See `sample_fractions`.

    Raises
    ------
    SamplingError
        `samples` is odd or not positive, or the window or grid misses the geometry.
    """
    _check_samples(sampling.samples)
    _check_overlap(geometry, grid, window)


def _check_samples(samples: Any) -> None:
    if isinstance(samples, bool) or not isinstance(samples, int) or samples < 2 or samples % 2:
        raise SamplingError(
            f"{samples!r} samples along a cell",
            where="samples",
            expected="a positive even number, so that no sample lies on a cell boundary",
            remedy="use 4 (the default), or 8 for smoother fractions",
        )


def _check_overlap(geometry: Surface, grid: BackgroundGrid, window: Box | None) -> None:
    low, high = geometry.bounding_box()
    boxes = {"the background grid": (grid.origin, grid.upper)}
    if window is not None:
        boxes["the window"] = window
    for what, (box_low, box_high) in boxes.items():
        if np.greater(box_low, high).any() or np.less(box_high, low).any():
            raise SamplingError(
                f"{what} from {tuple(box_low)} to {tuple(box_high)} misses the geometry, which "
                f"lies between {low} and {high}",
                where=geometry.name,
                expected="a box that overlaps the geometry",
                remedy="correct `window`, in the units of the geometry file",
            )
