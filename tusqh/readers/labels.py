"""Decide whether the integers in an image are labels or grey values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Largest number of distinct values that can be labels.
_MOST_LABELS = 4096
#: More distinct values than this are labels only if values jump, which smooth grey values do not.
_FEW = 32
#: Number of planes in a block, and of blocks in an image, that are examined.
_PLANES, _BLOCKS = 8, 16
#: Largest range of values that is counted in a table.
_TABLE = 2**20


def as_whole_numbers(voxels: NDArray[Any]) -> NDArray[Any] | None:
    """Return voxels as integers, or None if some are not integers or all may be fractions.

    Parameters
    ----------
    voxels
        Values of any dtype.
    """
    if voxels.dtype.kind in "ui":
        return voxels
    if voxels.dtype.kind != "f" or not voxels.size:
        return None
    first = np.asarray(voxels.ravel()[:4096], dtype=np.float64)
    if not np.array_equal(first, np.rint(first)) or not np.isfinite(voxels).all():
        return None
    low, high = float(voxels.min()), float(voxels.max())
    if (low >= 0 and high <= 1) or max(-low, high) >= 2**31 or (voxels != np.rint(voxels)).any():
        return None
    return voxels.astype(np.int64)


def count_values(voxels: NDArray[Any]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the distinct values of an integer image, ascending, and the voxel count of each.

    Parameters
    ----------
    voxels
        Integers, shape (nx, ny, nz) or (nx, ny).

    Returns
    -------
    values, counts : ndarray of int64
        Two arrays of equal length.

    Examples
    --------
    >>> values, counts = count_values(np.array([[[7, 2, 7]]]))
    >>> values.tolist(), counts.tolist()
    ([2, 7], [1, 2])
    """
    low, high = int(voxels.min()), int(voxels.max())
    if high - low >= _TABLE or low < -(2**62) or high >= 2**62:
        values, counts = np.unique(voxels, return_counts=True)
        return values.astype(np.int64), counts
    table = np.zeros(high - low + 1, dtype=np.int64)
    for plane in voxels:
        table += np.bincount(plane.ravel().astype(np.int64) - low, minlength=len(table))
    found = np.flatnonzero(table)
    return found + low, table[found]


def look_like_labels(voxels: NDArray[Any], values: NDArray[np.int64]) -> bool:
    """Return whether integers are labels rather than grey values.

    Labels fill regions: most voxels whose value is neither the smallest nor the largest have a
    neighbour of the same value along every axis.  This is true neither of noise nor of voxels on
    the boundary of a solid that hold a fraction of material.

    Parameters
    ----------
    voxels
        Integers, shape (nx, ny, nz) or (nx, ny).
    values
        The distinct values, ascending.

    Examples
    --------
    >>> labels = np.repeat(np.arange(4), 3).reshape(-1, 1, 1) * np.ones((1, 3, 3), dtype=int)
    >>> look_like_labels(labels, np.arange(4))
    True
    >>> look_like_labels(np.arange(27).reshape(3, 3, 3) % 4, np.arange(4))
    False
    """
    if not 3 <= len(values) <= _MOST_LABELS:
        return False
    n_between = n_in_regions = 0
    jumps = []
    for block in _blocks(voxels):
        between = (block > values[0]) & (block < values[-1])
        in_region = between.copy()
        for axis in range(block.ndim):
            if block.shape[axis] < 2:
                continue
            ahead, behind = _halves(block, axis)
            is_same = ahead == behind
            has_twin = np.zeros(block.shape, dtype=bool)
            for half in _halves(has_twin, axis):
                half |= is_same
            in_region &= has_twin
            differing = ~is_same & np.logical_and(*_halves(between, axis))
            jumps.append(np.abs(ahead[differing].astype(np.float64) - behind[differing]))
        n_between += int(between.sum())
        n_in_regions += int(in_region.sum())
    if not n_between or 2 * n_in_regions <= n_between:
        return False
    steps = np.concatenate(jumps) if jumps else np.zeros(0)
    return len(values) <= _FEW or not steps.size or float(np.median(steps)) > 2


def suggest_levels(values: NDArray[np.int64], counts: NDArray[np.int64]) -> tuple[int, int] | None:
    """Return the two peaks of a histogram of grey values, or None if there are not two.

    Otsu's threshold divides the values into two parts, each with its own peak.

    Parameters
    ----------
    values, counts
        Distinct values, ascending, and the voxel count of each.

    Returns
    -------
    low, high : int
        Grey values of the two peaks.

    References
    ----------
    Otsu, A threshold selection method from gray-level histograms, IEEE Trans. SMC 9 (1979).
    """
    n_bins = int(min(256, values[-1] - values[0] + 1))
    heights, edges = np.histogram(values, bins=n_bins, weights=counts)
    smooth = np.convolve(heights, np.hanning(2 * (n_bins // 40) + 3), mode="same")
    centres = (edges[:-1] + edges[1:]) / 2
    below = np.cumsum(heights)
    moment = np.cumsum(heights * centres)
    with np.errstate(divide="ignore", invalid="ignore"):
        spread = (moment[-1] * below - below[-1] * moment) ** 2 / (below * (below[-1] - below))
    split = int(np.argmax(np.nan_to_num(spread[:-1], posinf=0.0))) + 1 if n_bins > 2 else 0
    if not 0 < split < n_bins:
        return None
    first, second = int(np.argmax(smooth[:split])), split + int(np.argmax(smooth[split:]))
    if smooth[first : second + 1].min() > 0.8 * min(smooth[first], smooth[second]):
        return None
    return round(float(centres[first])), round(float(centres[second]))


def to_text(values: Sequence[int] | NDArray[np.int64]) -> str:
    """Return labels as text, at most the first eight.

    Parameters
    ----------
    values
        The labels.

    Examples
    --------
    >>> to_text([1, 2, 3])
    '1, 2, 3'
    """
    text = ", ".join(str(int(value)) for value in values[:8])
    return f"{text}, ..." if len(values) > 8 else text


def _blocks(voxels: NDArray[Any]) -> list[NDArray[Any]]:
    """Return evenly spaced blocks of planes, or the whole image if it is small."""
    n_planes = len(voxels)
    if n_planes <= _PLANES * _BLOCKS:
        return [voxels]
    starts = np.linspace(0, n_planes - _PLANES, _BLOCKS).astype(int)
    return [voxels[start : start + _PLANES] for start in starts]


def _halves(array: NDArray[Any], axis: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return two views of an array, without its first and without its last layer along an axis."""
    layers = np.moveaxis(array, axis, 0)
    return layers[1:], layers[:-1]
