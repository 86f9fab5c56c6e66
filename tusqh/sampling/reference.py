"""The reference volume of a geometry, with which meshes are compared at any threshold."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Protocol

import numba
import numpy as np

from tusqh.geometry.framed import box_to_frame, to_frame
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry, Surface
from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid, FloatArray
from tusqh.sampling.closing import close
from tusqh.sampling.field import CrossingField
from tusqh.sampling.inside import field_of
from tusqh.sampling.lattice import Box, Lattice
from tusqh.sampling.orient import orient
from tusqh.sampling.snap import NEAR
from tusqh.settings.sampling import Sampling

#: Approximate number of samples, and the most along a side of a cell.
_SAMPLES, _FINEST = 2**23, 16

#: Largest deviation of a winding number from 0 or 1 that counts as rounding.
_ROUNDING = 1e-6


@dataclass(frozen=True)
class Reference:
    """The volume (2D: area) that a mesh should have.

    Parameters
    ----------
    volume
        In model units to the power of the dimension; 0 if it is unknown.
    source
        How it was determined, in words.
    ambiguity
        How much the volume depends on the definition of inside: the ratio of samples with a winding
        number between 1/4 and 3/4 to samples inside; 0 for closed surfaces.
    geometry
        The geometry, turned as for sampling, so that its facets point outwards.
    is_outside
        Whether the material lies outside the geometry.
    window
        Box, in model units; everything outside it counts as void.
    is_made
        Whether the inside was made of an envelope or a shell, so that the directions and the gaps
        of the geometry do not matter.
    """

    volume: float
    source: str
    ambiguity: float = 0.0
    geometry: Geometry | None = field(default=None, repr=False, compare=False)
    is_outside: bool = field(default=False, repr=False)
    window: Box | None = field(default=None, repr=False)
    is_made: bool = field(default=False, repr=False)


class Sampled(Protocol):
    """Volume fractions of a grid, as a whole or in slabs."""

    @property
    def grid(self) -> BackgroundGrid:
        """The background grid."""

    @property
    def samples(self) -> int:
        """Samples along each side of a cell."""

    def volume(self) -> float:
        """Return the volume (2D: area) that the cell fractions add up to, in model units."""


def find_reference(
    geometry: Geometry,
    fractions: Sampled,
    *,
    sampling: Sampling | None = None,
    window: Box | None = None,
) -> Reference:
    """Return the volume of a geometry in the grid and the window.

    The volume is exact for a closed surface that covers no point twice and lies in the window.
    Otherwise it comes from the number of samples with a winding number of at least 1/2, on a
    lattice of about 8 million samples, finer or coarser than that of the fractions.  For images it
    is the sum of the fractions.

    Parameters
    ----------
    geometry
        The geometry.
    fractions
        Its volume fractions.
    sampling
        How they were sampled; None: with the defaults.
    window
        Box, in model units; everything outside it counts as void.

    Examples
    --------
    >>> from tusqh.sampling.fractions import sample_fractions
    >>> square = Outline.from_chains([np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])])
    >>> grid = BackgroundGrid(shape=(3, 3), cell_size=0.4, origin=(0.0, 0.0))
    >>> find_reference(square, sample_fractions(square, grid))
    Reference(volume=1.0, source='the exact area', ambiguity=0.0)
    """
    sampling, grid = sampling or Sampling(), fractions.grid
    if isinstance(geometry, Image):
        return Reference(max(fractions.volume(), 0.0), "the grey values of the image")
    geometry, window = to_frame(geometry, grid.frame), box_to_frame(window, grid.frame)
    if sampling.inside != "winding":
        return _of_made(geometry, fractions, sampling, window)
    geometry = orient(geometry, sampling.orientation).geometry
    lattice = _lattice(grid, fractions.samples, window)
    cycle, cap = close(geometry)
    winding = CrossingField(cycle, cap, max(sampling.tolerance, 1e-4))
    counted = _count(winding, lattice)
    is_outside = sampling.domain == "outside"
    sign = -1 if counted.is_flipped(sampling) else 1
    outwards = geometry if sign > 0 else _reversed(geometry)
    what = "area" if grid.dim == 2 else "volume"
    size = lattice.step**grid.dim
    if len(cap) == 0 and counted.is_simple(sign) and _lies_in(geometry, grid, window):
        exact = sign * signed_volume(geometry)
        of_window = _volume_of_window(grid, window)
        volume = of_window - exact if is_outside else exact
        source = f"the exact {what}"
        return Reference(max(volume, 0.0), source, 0.0, outwards, is_outside, window)
    n_inside = counted.n_above if sign > 0 else counted.n_below
    if is_outside:
        n_inside = counted.n_samples - n_inside
    source = f"the {what} where the winding number is at least 1/2"
    ambiguity = counted.n_between / max(n_inside, 1)
    return Reference(n_inside * size, source, ambiguity, outwards, is_outside, window)


def signed_volume(geometry: Surface) -> float:
    """Return the signed volume (2D: area) that a closed geometry encloses, in model units.

    Parameters
    ----------
    geometry
        An outline or a soup; if it is open, the result depends on the origin.

    Examples
    --------
    >>> square = [[0.0, 0], [2, 0], [2, 1], [0, 1], [0, 0]]
    >>> signed_volume(Outline.from_chains([np.array(square)]))
    2.0
    """
    low, high = geometry.bounding_box()
    points = geometry.points - (np.array(low) + np.array(high)) / 2
    if isinstance(geometry, Outline):
        a, b = np.moveaxis(points[geometry.segments], 1, 0)
        return float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2)
    a, b, c = np.moveaxis(points[geometry.triangles], 1, 0)
    return float(np.einsum("mi,mi->m", a, np.cross(b, c)).sum() / 6)


def _of_made(
    geometry: Surface, fractions: Sampled, sampling: Sampling, window: Box | None
) -> Reference:
    """Return the volume of samples in a made inside, or outside it, on a finer lattice if any."""
    grid, volume = fractions.grid, fractions.volume()
    lattice = _lattice(grid, fractions.samples, window)
    if lattice.step * fractions.samples < grid.cell_size * (1 - 1e-9):
        made = field_of(geometry, sampling, grid.cell_size)
        n = int(lattice.n_blocks[0])
        rows = max(1, _SAMPLES // int(lattice.n_blocks[1] * lattice.n_blocks[2]))
        parts = (made.sums(lattice, k, min(k + rows, n)) for k in range(0, n, rows))
        n_inside = sum(float(part.sum()) for part in parts)
        if sampling.domain == "outside":
            n_inside = float(np.prod(lattice.last - lattice.first)) - n_inside
        volume = n_inside * lattice.step**grid.dim
    what = "area" if fractions.grid.dim == 2 else "volume"
    names = {"union": "solids and shells"}
    name = names.get(sampling.inside, f"the {sampling.inside}")
    beyond = "outside " if sampling.domain == "outside" else ""
    return Reference(max(volume, 0.0), f"the {what} {beyond or 'of '}{name}", is_made=True)


@dataclass(frozen=True)
class _Counted:
    """Statistics of the winding numbers on a lattice: sum, extremes, and counts by range."""

    total: float
    lowest: float
    highest: float
    n_above: int
    n_below: int
    n_between: int
    n_samples: int

    def is_flipped(self, sampling: Sampling) -> bool:
        if sampling.orientation == "auto":
            return self.total < 0
        return sampling.orientation == "flip"

    def is_simple(self, sign: int) -> bool:
        """Return whether the winding number is 0 or 1 everywhere."""
        low, high = sorted((sign * self.lowest, sign * self.highest))
        return low > -_ROUNDING and high < 1 + _ROUNDING


def _count(field: CrossingField, lattice: Lattice) -> _Counted:
    n = int(lattice.n_blocks[0])
    per_slab = max(1, _SAMPLES // int(lattice.n_blocks[1] * lattice.n_blocks[2]))
    n_above = n_below = n_between = 0
    total = lowest = highest = 0.0
    for begin in range(0, n, per_slab):
        slab = field.sums(lattice, begin, min(begin + per_slab, n))
        above, below, between = _tally(slab)
        n_above, n_below, n_between = n_above + above, n_below + below, n_between + between
        total += float(slab.sum())
        lowest, highest = min(lowest, float(slab.min())), max(highest, float(slab.max()))
    n_samples = int(np.prod(lattice.last - lattice.first))
    return _Counted(total, lowest, highest, n_above, n_below, n_between, n_samples)


@numba.njit(cache=True)
def _tally(values):  # type: ignore[no-untyped-def]
    """Count winding numbers of at least 1/2, of at most -1/2, and between 1/4 and 3/4 in size."""
    above = below = between = 0
    for value in values.ravel():
        above += value >= 0.5
        below += value <= -0.5
        between += abs(abs(value) - 0.5) < 0.25
    return above, below, between


def _reversed(geometry: Surface) -> Surface:
    """Return a geometry with every facet turned."""
    if isinstance(geometry, Outline):
        return replace(geometry, segments=geometry.segments[:, ::-1])
    return replace(geometry, triangles=geometry.triangles[:, ::-1])


def _lattice(grid: BackgroundGrid, samples: int, window: Box | None) -> Lattice:
    """Return the lattice on which a volume is counted, with one half-block for each sample."""
    per_cell = (_SAMPLES / grid.n_cells) ** (1 / grid.dim)
    n_joined = math.floor(samples / per_cell)  # Cells of the grid along a coarse cell.
    if n_joined <= 1:
        along = max(samples, min(int(per_cell) // 2 * 2, _FINEST))
        return Lattice.over_grid(grid, along, window).of_samples()
    shape = tuple(-(-n // n_joined) for n in grid.shape)
    coarse = BackgroundGrid(shape, grid.cell_size * n_joined, grid.origin)
    low, high = _box(grid, window)
    box = tuple(low.tolist()), tuple(high.tolist())
    return Lattice.over_grid(coarse, samples, box).of_samples()


def _lies_in(geometry: Surface, grid: BackgroundGrid, window: Box | None) -> bool:
    low, high = geometry.bounding_box()
    box_low, box_high = _box(grid, window)
    # `snap` lays the grid on faces up to their rounding in the file.
    slack = (NEAR if window is None else 1e-9) * grid.cell_size
    return bool(
        (np.array(low) >= box_low - slack).all() and (np.array(high) <= box_high + slack).all()
    )


def _volume_of_window(grid: BackgroundGrid, window: Box | None) -> float:
    low, high = _box(grid, window)
    return float(np.prod(np.maximum(high - low, 0.0)))


def _box(grid: BackgroundGrid, window: Box | None) -> tuple[FloatArray, FloatArray]:
    """Return the corners of the part of the grid that lies in the window."""
    low, high = np.array(grid.origin), np.array(grid.upper)
    if window is None:
        return low, high
    return np.maximum(low, window[0]), np.minimum(high, window[1])
