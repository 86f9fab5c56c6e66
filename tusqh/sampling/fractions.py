"""Volume fractions of the grid cells of all dimensions from one lattice of samples.

The fictitious cell that the paper centres at a primal cell (Sub-cell Volume Fractions) covers,
along each axis, the half-blocks ``c - 1`` and ``c`` of the doubled grid::

    half-blocks     |  0  |  1  |  2  |  3  |        two per cell
    doubled grid    0     1     2     3     4        odd: cells, even: vertices
    fraction of 1      = mean of half-blocks 0 and 1 (the cell)
    fraction of 2      = mean of half-blocks 1 and 2 (the vertex between two cells)

so that the fractions of cells, edges and vertices are one moving average of the half-block means.
Everything outside the grid is empty.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from tusqh.errors import SamplingError
from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid, FloatArray
from tusqh.sampling.winding_number import winding_number

Box = tuple[tuple[float, ...], tuple[float, ...]]
Domain = Literal["inside", "outside"]
Rule = Literal["average", "clamped"]
Orientation = Literal["auto", "as-is", "flip"]

#: Fractions are rounded once to multiples of this, because ties decide topology.
RESOLUTION = 2.0**-20

#: Samples per call of the winding number, which bounds memory and paces progress reports.
_SLAB = 50_000


@dataclass(frozen=True)
class VolumeFractions:
    """The volume fractions of every primal cell of a background grid.

    Parameters
    ----------
    grid
        The background grid, of shape n.
    samples
        Samples along each side of a cell.
    values
        Fractions on the doubled grid, shape ``2 n + 1``, dimensionless, multiples of
        `RESOLUTION`.  Below 0 and above 1 where the winding number is.
    """

    grid: BackgroundGrid
    samples: int
    values: FloatArray

    @property
    def cells(self) -> FloatArray:
        """Fractions of the cells, shape n."""
        return self.values[(slice(1, None, 2),) * self.grid.dim]

    @property
    def vertices(self) -> FloatArray:
        """Sub-cell fractions of the grid vertices, shape ``n + 1``."""
        return self.values[(slice(0, None, 2),) * self.grid.dim]

    def volume(self) -> float:
        """Return the volume (2D: area) that the cell fractions add up to, in model units."""
        return float(self.cells.sum()) * self.grid.cell_size**self.grid.dim


def sample_fractions(
    outline: Outline,
    grid: BackgroundGrid,
    *,
    samples: int = 4,
    domain: Domain = "inside",
    window: Box | None = None,
    rule: Rule = "average",
    orientation: Orientation = "auto",
    progress: Callable[[int, int], None] | None = None,
) -> VolumeFractions:
    """Return the volume fractions of an outline on a grid.

    Parameters
    ----------
    outline
        The geometry, as it is.
    grid
        The background grid.
    samples
        Samples along each side of a cell; even, so that none lies on a cell boundary.
    domain
        ``"inside"`` measures the winding number, ``"outside"`` one minus the winding number.
    window
        Box outside of which there is no material, in model units; samples beyond it count 0.
    rule
        ``"average"`` averages raw (inside or outside) values as the paper does;
        ``"clamped"`` clips each sample to [0, 1] first, right where parts overlap.
    orientation
        ``"auto"`` flips the sign of the winding number when its mean is negative (clockwise
        rings), ``"flip"`` always does, ``"as-is"`` never.
    progress
        Called with (samples done, samples in all).

    Raises
    ------
    SamplingError
        Odd or non-positive `samples`, a window or grid that misses the geometry, a winding
        number that is zero everywhere, or nothing of the domain in the grid.

    Examples
    --------
    A unit square on a grid of cells twice as large: the vertex at its centre sees all of the
    four quarter cells around it that the square covers.

    >>> import numpy as np
    >>> square = np.array([[1.0, 1], [3, 1], [3, 3], [1, 3], [1, 1]])
    >>> grid = BackgroundGrid(shape=(2, 2), cell_size=2.0, origin=(0.0, 0.0))
    >>> sample_fractions(Outline.from_chains([square]), grid).values.tolist()[1:4]
    [[0.0, 0.25, 0.5, 0.25, 0.0], [0.0, 0.5, 1.0, 0.5, 0.0], [0.0, 0.25, 0.5, 0.25, 0.0]]
    """
    _check_samples(samples)
    _check_overlap(outline, grid, window)
    axes = [
        o + grid.cell_size * (np.arange(n * samples) + 0.5) / samples
        for o, n in zip(grid.origin, grid.shape, strict=True)
    ]
    winding = _winding_on_lattice(outline, axes, progress)
    if not (np.abs(winding) > RESOLUTION).any():
        raise SamplingError(
            "the winding number is zero everywhere, so the geometry has no inside",
            where=outline.name,
            expected="curves that enclose something, each border walked once",
            remedy="remove one of the two copies if every curve is there twice in opposite "
            "directions (double-sided sheets)",
        )
    if orientation == "flip" or (orientation == "auto" and winding.mean() < 0):
        winding = -winding
    values = winding if domain == "inside" else 1.0 - winding
    if rule == "clamped":
        values = np.clip(values, 0.0, 1.0)
    if window is not None:
        for axis, (coordinate, low, high) in enumerate(zip(axes, *window, strict=True)):
            is_outside = (coordinate < low) | (coordinate > high)
            values[(slice(None),) * axis + (is_outside,)] = 0.0
    fractions = VolumeFractions(grid=grid, samples=samples, values=_average(values, samples))
    if not (fractions.cells > 0).any():
        raise SamplingError(
            f"no cell of the {grid.label} grid has a positive fraction of the {domain} of the "
            "geometry",
            where=outline.name,
            expected="some material in the grid",
            remedy="use the other `domain`, `orientation: auto`, a finer grid or another window",
        )
    return fractions


def round_fractions(values: FloatArray) -> FloatArray:
    """Return fractions rounded to multiples of `RESOLUTION`.

    >>> float(round_fractions(np.array([1 / 3]))[0] / RESOLUTION)
    349525.0
    """
    return np.rint(values / RESOLUTION) * RESOLUTION + 0.0  # + 0.0 turns -0.0 into 0.0


def _winding_on_lattice(
    outline: Outline, axes: list[FloatArray], progress: Callable[[int, int], None] | None
) -> FloatArray:
    """Return the winding number at every lattice point, shape of the lattice."""
    shape = tuple(len(a) for a in axes)
    winding = np.empty(shape)
    rows = max(1, _SLAB // int(np.prod(shape[1:])))
    for start in range(0, shape[0], rows):
        stop = min(start + rows, shape[0])
        points = np.meshgrid(axes[0][start:stop], *axes[1:], indexing="ij")
        queries = np.stack(points, axis=-1).reshape(-1, len(axes))
        winding[start:stop] = winding_number(outline, queries).reshape(stop - start, *shape[1:])
        if progress is not None:
            progress(stop * winding[0].size, winding.size)
    return winding


def _average(values: FloatArray, samples: int) -> FloatArray:
    """Return the rounded fractions on the doubled grid from values on the sample lattice."""
    half = samples // 2
    blocked = [k for n in values.shape for k in (n // half, half)]
    blocks = values.reshape(blocked).mean(axis=tuple(range(1, 2 * values.ndim, 2)))
    padded = np.pad(blocks, 1)
    for axis in range(padded.ndim):
        lower = np.take(padded, np.arange(padded.shape[axis] - 1), axis=axis)
        upper = np.take(padded, np.arange(1, padded.shape[axis]), axis=axis)
        padded = (lower + upper) / 2
    return round_fractions(padded)


def _check_samples(samples: Any) -> None:
    if isinstance(samples, bool) or not isinstance(samples, int) or samples < 2 or samples % 2:
        raise SamplingError(
            f"{samples!r} samples along a cell",
            where="samples",
            expected="a positive even number, so that no sample lies on a cell boundary",
            remedy="use 4 (the default), or 8 for smoother fractions",
        )


def _check_overlap(outline: Outline, grid: BackgroundGrid, window: Box | None) -> None:
    low, high = outline.bounding_box()
    boxes = {"the background grid": (grid.origin, grid.upper)}
    if window is not None:
        boxes["the window"] = window
    for what, (box_low, box_high) in boxes.items():
        if np.greater(box_low, high).any() or np.less(box_high, low).any():
            raise SamplingError(
                f"{what} from {tuple(box_low)} to {tuple(box_high)} misses the geometry, which "
                f"lies between {low} and {high}",
                where=outline.name,
                expected="a box that overlaps the geometry",
                remedy="correct `window`, in the units of the geometry file",
            )
