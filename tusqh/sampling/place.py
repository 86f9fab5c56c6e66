"""Move the background grid by a fraction of a cell if that corrects the mesh's volume.

If the faces of a part lie in the middle of cells, a threshold keeps or drops all these cells
together, so the mesh of a box may have half its volume on one grid and twice its volume on another.
Grids that are moved by whole samples share one lattice of samples, and the fractions of their cells
are moving averages over it.  One pass counts the cells that a threshold keeps for every placement.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numba
import numpy as np

from tusqh.geometry.kinds import Surface
from tusqh.grid import BackgroundGrid, FloatArray, IntArray
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.field import WindingField
from tusqh.sampling.half_blocks import SAMPLES_AT_A_TIME
from tusqh.sampling.inside import field_of, without_directions
from tusqh.sampling.lattice import Box, Lattice
from tusqh.sampling.placement import Placement
from tusqh.settings.sampling import Sampling

#: The grid stays at the corner if its volume error there is at most this.
_GOOD = 0.01
#: Placements whose errors differ by less are equally good.
_EQUAL = 0.001
#: A fraction nearer to the threshold than this is not robust.
_NEAR = 0.125
#: Largest share of the material in walls that a placement drops (unless the corner drops more).
_LOST = 0.01


@dataclass(frozen=True)
class _Counts:
    """The cells that each placement keeps; shapes (S, S, S), or (S, 1, S) in the plane.

    Parameters
    ----------
    kept
        Numbers of kept cells a little below, at and a little above the threshold, shape (3, ...).
    near
        Numbers of cells whose fraction is near the threshold.
    lost
        Material of missing walls, in cells: the fractions of cells that are dropped together with
        all their neighbours, a little above the threshold.
    """

    kept: IntArray
    near: IntArray
    lost: FloatArray


class Counted(Protocol):
    """Volume fractions of a grid, as a whole or in slabs."""

    @property
    def grid(self) -> BackgroundGrid:
        """The background grid."""

    def count_at_least(self, thresholds: FloatArray) -> IntArray:
        """Return the number of cells with at least each of some fractions.

        Parameters
        ----------
        thresholds
            Volume fractions, shape (r,).
        """


def place_grid(
    geometry: Surface,
    fractions: Counted,
    volume: float,
    *,
    sampling: Sampling,
    window: Box | None = None,
    threshold: float = 0.5,
    field: WindingField | None = None,
    box: Box | None = None,
) -> tuple[BackgroundGrid, Placement]:
    """Return the placement of the grid whose kept cells best match the volume of the geometry.

    The grid stays where it is if its volume error is at most 1 %; then no other placement is
    tried.  Otherwise the placements that differ by whole samples are compared, and the one with the
    least error is chosen; errors that differ by less than 0.1 % are equal.  Ties go to the
    placement with the fewest cells near the threshold, then to the one that moves along the fewest
    axes.  A placement is allowed only if its error at the threshold does not exceed that of the
    given grid, it keeps some cells, and it loses no more walls than the corner does.

    Parameters
    ----------
    geometry
        The geometry, its parts turned.
    fractions
        Its volume fractions on the grid at the corner of the box.
    volume
        The volume that the kept cells should have, in model units.
    sampling
        How the fractions are sampled.
    window
        Box to mesh in, in model units; None: the bounding box.
    threshold
        Fractions of at least this are kept.
    field
        What is averaged; None: that of `tusqh.sampling.inside.field_of`.
    box
        What the grid must cover, in model units; None: the window or the bounding box.

    Returns
    -------
    grid
        The moved grid, with the same cell size and at most one more cell along each axis.
    placement
        How far it was moved and how that changes the volume.
    """
    grid = fractions.grid
    stays = Placement((0,) * grid.dim, sampling.samples, 1, threshold, volume)
    reason = _find_obstacle(volume, sampling, window)
    if reason:
        return grid, Placement(stays.moved, stays.samples, reason=reason)
    kept = fractions.count_at_least(levels_near(threshold, sampling.samples**grid.dim))
    error = float(np.abs(kept * grid.cell_size**grid.dim / volume - 1).max())
    if error <= _GOOD:
        return grid, replace(stays, error=error, corner_error=error)
    counts = _count(geometry, grid, sampling, window, threshold, field)
    errors = np.abs(counts.kept * grid.cell_size**grid.dim / volume - 1)
    robust = errors.max(axis=0)
    corner = chosen = (0, 0, 0)
    if robust[corner] > _GOOD:
        may = (errors[1] <= errors[1][corner]) & (robust <= robust[corner])
        material = volume / grid.cell_size**grid.dim
        may &= counts.lost <= max(_LOST * material, counts.lost[corner])
        may &= (counts.kept > 0).all(axis=0)
        may[corner] = True
        chosen = _best(may, robust, counts)
    moved = tuple(k for k, n in zip(chosen, robust.shape, strict=True) if n > 1)
    placement = Placement(
        moved,
        sampling.samples,
        tried=robust.size,
        threshold=threshold,
        reference_volume=volume,
        error=float(robust[chosen]),
        corner_error=float(robust[corner]),
    )
    return move_grid(grid, box or window or geometry.bounding_box(), placement), placement


def move_grid(grid: BackgroundGrid, box: Box, placement: Placement) -> BackgroundGrid:
    """Return a grid moved by a fraction of a cell, with as many cells as a box needs.

    Parameters
    ----------
    grid
        The grid at the corner.
    box
        The box that it covers, in model units.
    placement
        How far it is moved.

    Examples
    --------
    >>> grid = BackgroundGrid((4, 4), 1.0, (0.0, 0.0))
    >>> move_grid(grid, ((0.0, 0.0), (4.0, 4.0)), Placement((1, 0), 4))
    BackgroundGrid(shape=(5, 4), cell_size=1.0, origin=(-0.75, 0.0))
    """
    shape, origin = list(grid.shape), list(grid.origin)
    for axis, step in enumerate(placement.moved):
        if step == 0:
            continue
        slack = 1e-9 * grid.cell_size
        low, high = box[0][axis], box[1][axis]
        origin[axis] += grid.cell_size * step / placement.samples
        if origin[axis] > low + slack:
            origin[axis] -= grid.cell_size
            shape[axis] += 1
        if origin[axis] + (shape[axis] - 1) * grid.cell_size >= high - slack:
            shape[axis] -= 1
    return replace(grid, shape=tuple(shape), origin=tuple(origin))


def _find_obstacle(volume: float, sampling: Sampling, window: Box | None) -> str:
    """Return why a grid cannot be moved, or an empty string if it can."""
    if sampling.domain == "outside" and window is None:
        return "without a window, the domain outside ends where the grid does"
    return "" if volume > 0 else "the volume that the mesh should have is unknown"


def _best(may: FloatArray, robust: FloatArray, counts: _Counts) -> tuple[int, int, int]:
    """Return the best of the allowed placements."""
    places = np.argwhere(may)
    of = tuple(places.T)
    keys = (
        (places > 0).sum(axis=1),
        np.rint(100 * counts.near[of] / np.maximum(counts.kept[1][of], 1)),
        np.rint(robust[of] / _EQUAL),
    )
    a, b, c = places[np.lexsort(keys)[0]].tolist()
    return a, b, c


def _count(
    geometry: Surface,
    grid: BackgroundGrid,
    sampling: Sampling,
    window: Box | None,
    threshold: float,
    field: WindingField | None = None,
) -> _Counts:
    """Return the counts of the cells that every placement of a grid keeps."""
    coarse = replace(sampling, tolerance=max(sampling.tolerance, 1e-4), sampler="crossings")
    field = field or field_of(geometry, coarse, grid.cell_size)
    lattice = Lattice.over_grid(grid.padded(), sampling.samples, window)
    sign = _sign(field, lattice, without_directions(sampling))
    single = lattice.of_samples()
    shape = tuple(1 if n == 1 else sampling.samples for n in single.n_blocks.tolist())
    counts = _Counts(
        np.zeros((3, *shape), dtype=np.int64), np.zeros(shape, dtype=np.int64), np.zeros(shape)
    )
    levels = levels_near(threshold, int(np.prod(shape)))
    n_places = int(single.n_blocks[0]) - shape[0] + 1
    step = max(shape[0], SAMPLES_AT_A_TIME // int(single.n_blocks[1] * single.n_blocks[2]))
    for begin in range(0, n_places, step):
        end = min(begin + step, n_places)
        first, last = max(begin - shape[0], 0), min(end + shape[0], n_places)
        values = sign * field.sums(single, first, last + shape[0] - 1)
        values = _of_domain(values, single, first, sampling)
        for axis, width in enumerate(shape):
            values = _moving_mean(values, axis, width)
        _tally(values, first, begin, end, levels, counts.kept, counts.near, counts.lost)
    return counts


def levels_near(threshold: float, n_samples: int) -> FloatArray:
    """Return levels a little below, at and a little above a threshold, for rounded fractions.

    Parameters
    ----------
    threshold
        Volume fraction.
    n_samples
        Number of samples in a cell.
    """
    least = 0.5 / n_samples
    return threshold + np.array([-least, -RESOLUTION, least])


def _sign(field: WindingField, lattice: Lattice, sampling: Sampling) -> int:
    """Return -1 if the winding number must be negated, otherwise 1."""
    if sampling.orientation != "auto":
        return -1 if sampling.orientation == "flip" else 1
    n = int(lattice.n_blocks[0])
    step = max(16, SAMPLES_AT_A_TIME // int(lattice.n_blocks[1] * lattice.n_blocks[2]) // 16 * 16)
    total = sum(float(field.sums(lattice, k, min(k + step, n)).sum()) for k in range(0, n, step))
    return -1 if total < 0 else 1


def _of_domain(values: FloatArray, lattice: Lattice, begin: int, sampling: Sampling) -> FloatArray:
    """Return the material at samples according to the domain and the rule; 0 beyond the window."""
    is_outside = sampling.domain == "outside"
    if is_outside:
        counted = lattice.coverage()
        counted[0] = counted[0][begin : begin + len(values)]
        covered = counted[0][:, None, None] * counted[1][:, None] * counted[2]
        values = covered - values
    return np.clip(values, 0.0, 1.0) if sampling.rule == "clamped" else values


def _moving_mean(values: FloatArray, axis: int, width: int) -> FloatArray:
    """Return the means of `width` neighbours along an axis."""
    n = values.shape[axis] - width + 1
    total = values[(slice(None),) * axis + (slice(0, n),)].copy()
    for k in range(1, width):
        total += values[(slice(None),) * axis + (slice(k, k + n),)]
    total /= width
    return total


@numba.njit(cache=True)
def _tally(
    fractions: FloatArray,
    first: int,
    begin: int,
    end: int,
    levels: FloatArray,
    kept: IntArray,
    near: IntArray,
    lost: FloatArray,
) -> None:
    """Count, for each placement, the cells that start at the samples ``begin <= i < end`` along x.

    The fractions begin at the sample ``first``, so they include the neighbours of these cells.
    """
    n_x, n_y, n_z = near.shape
    m_x, m_y, m_z = fractions.shape
    for i in range(begin - first, end - first):
        a = (first + i) % n_x
        for j in range(m_y):
            b = j % n_y
            for k in range(m_z):
                c = k % n_z
                fraction = fractions[i, j, k]
                for level in range(3):
                    if fraction >= levels[level]:
                        kept[level, a, b, c] += 1
                if fraction > 0 and abs(fraction - levels[1]) < _NEAR:
                    near[a, b, c] += 1
                if 0 < fraction < levels[2]:
                    nearby = 0.0
                    if i >= n_x:
                        nearby = max(nearby, fractions[i - n_x, j, k])
                    if i + n_x < m_x:
                        nearby = max(nearby, fractions[i + n_x, j, k])
                    if j >= n_y:
                        nearby = max(nearby, fractions[i, j - n_y, k])
                    if j + n_y < m_y:
                        nearby = max(nearby, fractions[i, j + n_y, k])
                    if k >= n_z:
                        nearby = max(nearby, fractions[i, j, k - n_z])
                    if k + n_z < m_z:
                        nearby = max(nearby, fractions[i, j, k + n_z])
                    if nearby < levels[2]:
                        lost[a, b, c] += fraction
