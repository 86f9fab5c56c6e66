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

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from tusqh.errors import SamplingError
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid, FloatArray
from tusqh.sampling.blocks import average_blocks, block_means
from tusqh.sampling.crossings import has_small_cap, wind_on_lattice
from tusqh.sampling.winding_number import winding_number

Box = tuple[tuple[float, ...], tuple[float, ...]]
Domain = Literal["inside", "outside"]
Rule = Literal["average", "clamped"]
Orientation = Literal["auto", "as-is", "flip"]

#: Fractions are rounded once to multiples of this, because ties decide topology.
RESOLUTION = 2.0**-20

#: Samples per call of the winding number, by dimension: bounds memory, paces progress reports.
_SLAB = {2: 50_000, 3: 10_000_000}

#: Memory that fractions and the filtration need per cell, by dimension (measured).
_BYTES_PER_CELL = {2: 300, 3: 600}

Geometry = Outline | Soup


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
    geometry: Geometry,
    grid: BackgroundGrid,
    *,
    samples: int = 4,
    domain: Domain = "inside",
    window: Box | None = None,
    rule: Rule = "average",
    orientation: Orientation = "auto",
    progress: Callable[[int, int], None] | None = None,
) -> VolumeFractions:
    """Return the volume fractions of an outline or a soup on a grid.

    Parameters
    ----------
    geometry
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
        Odd or non-positive `samples`, a grid that does not fit in memory, a window or grid that
        misses the geometry, a winding number that is zero everywhere, or nothing of the domain
        in the grid.

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
    _check_overlap(geometry, grid, window)
    require_memory(grid, name=geometry.name)
    axes = [
        o + grid.cell_size * (np.arange(n * samples) + 0.5) / samples
        for o, n in zip(grid.origin, grid.shape, strict=True)
    ]
    signs = {"as-is": (1,), "flip": (-1,), "auto": (1, -1)}[orientation]
    if isinstance(geometry, Soup) and rule == "average" and has_small_cap(geometry, axes):
        blocks, total = _blocks_by_runs(geometry, axes, samples, domain, window, signs)
        is_nonzero = abs(total) > RESOLUTION
        if progress is not None:
            progress(1, 1)
    else:
        blocks, total, is_nonzero = _blocks_by_samples(
            geometry, axes, samples, domain, window, rule, signs, progress
        )
    if not is_nonzero:
        raise SamplingError(
            "the winding number is zero everywhere, so the geometry has no inside",
            where=geometry.name,
            expected="a geometry that encloses something, each border walked once",
            remedy="remove one of the two copies if every border is there twice in opposite "
            "directions (double-sided sheets)",
        )
    chosen = -1 if -1 in signs and (orientation == "flip" or total < 0) else 1
    values = _average(blocks[chosen])
    fractions = VolumeFractions(grid=grid, samples=samples, values=values)
    if not (fractions.cells > 0).any():
        raise SamplingError(
            f"no cell of the {grid.label} grid has a positive fraction of the {domain} of the "
            "geometry",
            where=geometry.name,
            expected="some material in the grid",
            remedy="use the other `domain`, `orientation: auto`, a finer grid or another window",
        )
    return fractions


def _blocks_by_samples(
    geometry: Geometry,
    axes: list[FloatArray],
    samples: int,
    domain: Domain,
    window: Box | None,
    rule: Rule,
    signs: tuple[int, ...],
    progress: Callable[[int, int], None] | None,
) -> tuple[dict[int, FloatArray], float, bool]:
    """Return half-block means by sign, the sum of all winding numbers, and if any is not zero."""
    blocks: dict[int, list[FloatArray]] = {sign: [] for sign in signs}
    total, is_nonzero = 0.0, False
    for start, winding in _winding_by_slabs(geometry, axes, samples, progress):
        total += float(winding.sum())
        is_nonzero |= bool((np.abs(winding) > RESOLUTION).any())
        slab_axes = [axes[0][start : start + len(winding)], *axes[1:]]
        for sign in signs:
            values = sign * winding if domain == "inside" else 1.0 - sign * winding
            if rule == "clamped":
                values = np.clip(values, 0.0, 1.0)
            if window is not None:
                for axis, (x, low, high) in enumerate(zip(slab_axes, *window, strict=True)):
                    values[(slice(None),) * axis + ((x < low) | (x > high),)] = 0.0
            blocks[sign].append(_half_block_means(values, samples))
    return {sign: np.concatenate(of_sign) for sign, of_sign in blocks.items()}, total, is_nonzero


def _blocks_by_runs(
    soup: Soup,
    axes: list[FloatArray],
    samples: int,
    domain: Domain,
    window: Box | None,
    signs: tuple[int, ...],
) -> tuple[dict[int, FloatArray], float]:
    """Return half-block means by sign and the sum of their winding numbers, without samples."""
    half = samples // 2
    low, high = window or ((-np.inf,) * 3, (np.inf,) * 3)
    first = np.array([np.searchsorted(a, x, side="left") for a, x in zip(axes, low, strict=True)])
    last = np.array([np.searchsorted(a, x, side="right") for a, x in zip(axes, high, strict=True)])
    means = block_means(soup, axes, half, first, last)
    total = float(means.sum())
    if domain == "inside":
        return {sign: sign * means for sign in signs}, total
    counts = [
        ((np.arange(len(a)) >= f) & (np.arange(len(a)) < t)).reshape(-1, half).mean(axis=1)
        for a, f, t in zip(axes, first, last, strict=True)
    ]
    whole = counts[0][:, None, None] * counts[1][:, None] * counts[2]
    return {sign: whole - sign * means for sign in signs}, total


def round_fractions(values: FloatArray) -> FloatArray:
    """Return fractions rounded to multiples of `RESOLUTION`.

    >>> float(round_fractions(np.array([1 / 3]))[0] / RESOLUTION)
    349525.0
    """
    return np.rint(values / RESOLUTION) * RESOLUTION + 0.0  # + 0.0 turns -0.0 into 0.0


def require_memory(grid: BackgroundGrid, *, name: str) -> None:
    """Raise a `SamplingError` with the estimate when a grid cannot fit in this machine's memory."""
    needed = grid.n_cells * _BYTES_PER_CELL[grid.dim]
    available = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if needed > available:
        coarser = (needed / available) ** (1 / grid.dim)
        raise SamplingError(
            f"the {grid.label} grid of {grid.n_cells:,} cells needs about {needed / 1e9:.0f} GB",
            where=name,
            expected=f"at most the {available / 1e9:.0f} GB of this machine",
            remedy=f"use cells at least {coarser:.2g} times as large (`grid.cell_size`), or fewer "
            "`grid.cells`",
        )


def _winding_by_slabs(
    geometry: Geometry,
    axes: list[FloatArray],
    samples: int,
    progress: Callable[[int, int], None] | None,
) -> Iterator[tuple[int, FloatArray]]:
    """Yield the winding numbers of slabs of whole half-blocks along x, and where each starts."""
    shape = tuple(len(a) for a in axes)
    half = samples // 2
    limit = _SLAB[len(shape)]
    rows = max(1, limit // int(np.prod(shape[1:])) // half) * half
    for start in range(0, shape[0], rows):
        stop = min(start + rows, shape[0])
        slab = [axes[0][start:stop], *axes[1:]]
        if isinstance(geometry, Soup):
            winding = wind_on_lattice(geometry, slab)
        else:
            queries = np.stack(np.meshgrid(*slab, indexing="ij"), axis=-1).reshape(-1, 2)
            winding = winding_number(geometry, queries).reshape(stop - start, *shape[1:])
        yield start, winding
        if progress is not None:
            progress(stop * int(np.prod(shape[1:])), int(np.prod(shape)))


def _half_block_means(values: FloatArray, samples: int) -> FloatArray:
    """Return the means of half-blocks of samples, two along each side of a cell."""
    half = samples // 2
    blocked = [k for n in values.shape for k in (n // half, half)]
    return np.asarray(values.reshape(blocked).mean(axis=tuple(range(1, 2 * values.ndim, 2))))


def _average(blocks: FloatArray) -> FloatArray:
    """Return the rounded fractions on the doubled grid from half-block means."""
    if blocks.ndim == 3:
        return np.asarray(average_blocks(blocks, RESOLUTION))
    padded = np.pad(blocks, 1)
    low, high = slice(None, -1), slice(1, None)
    quarters = [padded[x, y] for x in (low, high) for y in (low, high)]
    return round_fractions(np.asarray(sum(quarters)) / 4)


def _check_samples(samples: Any) -> None:
    if isinstance(samples, bool) or not isinstance(samples, int) or samples < 2 or samples % 2:
        raise SamplingError(
            f"{samples!r} samples along a cell",
            where="samples",
            expected="a positive even number, so that no sample lies on a cell boundary",
            remedy="use 4 (the default), or 8 for smoother fractions",
        )


def _check_overlap(geometry: Geometry, grid: BackgroundGrid, window: Box | None) -> None:
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
