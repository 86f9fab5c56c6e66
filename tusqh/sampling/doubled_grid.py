"""Rounded fractions on the doubled grid from sums over half-blocks, slab by slab."""

from __future__ import annotations

from collections.abc import Iterable

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid import FloatArray
from tusqh.sampling.lattice import Lattice

#: Fractions are rounded once to multiples of this, because ties decide topology.
RESOLUTION = 2.0**-20

Multiples = NDArray[np.int32]


def average_half_blocks(slabs: Iterable[FloatArray], lattice: Lattice) -> Multiples:
    """Return the means over the fictitious cells, as multiples of `RESOLUTION`.

    Parameters
    ----------
    slabs
        Sums over half-blocks, shapes (*, n_y, n_z), in order along x.
    lattice
        The lattice that they cover.

    Returns
    -------
    multiples
        Multiples of `RESOLUTION`, one more than half-blocks along each axis, int32; the axis of a
        single layer is left out.
    """
    n_x, n_y, n_z = (int(n) for n in lattice.n_blocks)
    rows = 1 if lattice.is_plane else n_y + 1
    multiples = np.empty((n_x + 1, rows, n_z + 1), dtype=np.int32)
    scale = _scale(lattice)
    before = np.zeros((1, n_y, n_z))
    begin = 0
    for slab in slabs:
        _round_rows(np.concatenate([before, slab]), scale, multiples[begin : begin + len(slab)])
        before = slab[-1:]
        begin += len(slab)
    _round_rows(np.concatenate([before, np.zeros_like(before)]), scale, multiples[begin:])
    return multiples[:, 0] if lattice.is_plane else multiples


def average_rows(sums: FloatArray, lattice: Lattice) -> Multiples:
    """Return the means over the fictitious cells between neighbouring columns of half-blocks.

    Parameters
    ----------
    sums
        Sums over half-blocks in space, shape (m + 1, n_y, n_z).
    lattice
        The lattice, in space, to which they belong.

    Returns
    -------
    multiples
        The m rows of the result of `average_half_blocks` between them.
    """
    multiples = np.empty((len(sums) - 1, *(n + 1 for n in sums.shape[1:])), dtype=np.int32)
    _round_rows(sums, _scale(lattice), multiples)
    return multiples


def _scale(lattice: Lattice) -> float:
    """Return the factor from the sum over a fictitious cell to a multiple of `RESOLUTION`."""
    pair = 4 if lattice.is_plane else 8
    return 1.0 / (pair * float(lattice.half.prod()) * RESOLUTION)


def combine_half_blocks(means: FloatArray) -> Multiples:
    """Return the means over the fictitious cells from means over half-blocks, as multiples.

    Parameters
    ----------
    means
        Means over half-blocks, shape ``2 n``, dimensionless.

    Returns
    -------
    multiples
        Multiples of `RESOLUTION`, shape ``2 n + 1``, int32.

    Examples
    --------
    >>> fractions = combine_half_blocks(np.array([[1.0, 0.0], [1.0, 0.0]])) * RESOLUTION
    >>> fractions.tolist()
    [[0.25, 0.25, 0.0], [0.5, 0.5, 0.0], [0.25, 0.25, 0.0]]
    """
    is_plane = means.ndim == 2
    sums = np.pad(means[:, None] if is_plane else means, ((1, 1), (0, 0), (0, 0)))
    shape = [n + 1 for n in means.shape]
    multiples = np.empty((shape[0], 1, shape[1]) if is_plane else shape, dtype=np.int32)
    _round_rows(sums, 1.0 / ((4 if is_plane else 8) * RESOLUTION), multiples)
    return multiples[:, 0] if is_plane else multiples


def average_coverage(lattice: Lattice, rows: slice = slice(None)) -> Multiples:
    """Return the share of samples that count in each fictitious cell, like `average_half_blocks`.

    Parameters
    ----------
    lattice
        The samples.
    rows
        The rows along x that are wanted; all of them by default.

    Returns
    -------
    multiples
        Multiples of `RESOLUTION`, shape ``2 n + 1`` (with `rows`, fewer along x), int32.
    """
    pairs = [np.convolve(share, [0.5, 0.5]) for share in lattice.coverage()]
    pairs[0] = pairs[0][rows]
    if lattice.is_plane:
        product = pairs[0][:, None] * pairs[2]
    else:
        product = pairs[0][:, None, None] * pairs[1][:, None] * pairs[2]
    return np.rint(product / RESOLUTION).astype(np.int32)


@numba.njit(cache=True, error_model="numpy", parallel=True)
def _round_rows(sums, scale, multiples):  # type: ignore[no-untyped-def]
    """Add up pairs of neighbours along each axis, scale and round."""
    n_x, n_y, n_z = sums.shape
    rows = multiples.shape[1]
    for i in numba.prange(n_x - 1):
        line = np.empty(n_z)
        for j in range(rows):
            line[:] = 0.0
            for y in range(max(j - 1, 0) if rows > 1 else 0, min(j + 1, n_y)):
                for z in range(n_z):
                    line[z] += sums[i, y, z] + sums[i + 1, y, z]
            multiples[i, j, 0] = np.int32(np.rint(line[0] * scale))
            for k in range(1, n_z):
                multiples[i, j, k] = np.int32(np.rint((line[k - 1] + line[k]) * scale))
            multiples[i, j, n_z] = np.int32(np.rint(line[n_z - 1] * scale))
