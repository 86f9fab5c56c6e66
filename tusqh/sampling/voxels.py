"""Volume fractions from the voxels of an image, as exact means without sampling.

A cell of the grid is a cube of ``c`` voxels along each side, where c is an integer.  A half-block
is half a cell, or ``c / 2`` voxels, long: for even c it consists of whole voxels, for odd c it cuts
the middle voxel in two.  The fraction is constant in each voxel, so the mean over a half-block is
the mean over ``c`` half voxels along each axis, and the fractions of cells, edges and vertices
follow from half-blocks as for any other geometry (see `tusqh.sampling.fractions`)::

    voxels           |     0     |     1     |     2     |       c = 3
    half voxels      |  0  |  1  |  2  |  3  |  4  |  5  |
    half-blocks      |        0        |        1        |       one cell

There is no material outside the image.  Pictures have two axes, images three.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tusqh.errors import SamplingError
from tusqh.geometry.image import Image
from tusqh.grid import BackgroundGrid, FloatArray, IntArray
from tusqh.sampling.doubled_grid import combine_half_blocks
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.lattice import Box
from tusqh.sampling.memory import require_memory
from tusqh.settings.sampling import Domain

#: Largest offset between grid and voxels, in voxels, that counts as rounding.
_ROUNDING = 1e-6

#: Approximate number of voxels that are averaged at a time.
VOXELS_AT_A_TIME = 8_000_000


def lay_on_voxels(
    image: Image,
    window: Box | None = None,
    *,
    cells: int | Sequence[int] | None = None,
    cell_size: float | Sequence[float] | None = None,
) -> BackgroundGrid:
    """Return the background grid over an image; every cell is a whole number of voxels long.

    Parameters
    ----------
    image
        The image.
    window
        Box to cover instead of the whole image, in model units; grown to whole voxels.
    cells
        At most this many cells along the longest side, or along each axis.
    cell_size
        Edge length of a cell instead, a multiple of the voxel size.  Cells that are boxes are
        refused.

    Raises
    ------
    SamplingError
        The cell size is not a multiple of the voxel size, or window and image do not overlap.

    Examples
    --------
    >>> image = Image(np.zeros((100, 60, 20), dtype=np.uint8), 0.5)
    >>> lay_on_voxels(image, cells=64)
    BackgroundGrid(shape=(50, 30, 10), cell_size=1.0, origin=(0.0, 0.0, 0.0))
    """
    first, last = _to_range(image, window)
    n_voxels = last - first
    if isinstance(cell_size, Sequence):
        raise SamplingError(
            f"a `cell_size` of {len(cell_size)} numbers for an image",
            where=image.name,
            expected="one number: cells of images are cubes of whole voxels",
            remedy="give one `cell_size`, or `cells`",
        )
    if cell_size is not None:
        per_cell = _to_multiple(image, cell_size)
    elif isinstance(cells, Sequence) and len(cells) != image.dim:
        raise _wrong_count(image, "grid.cells", len(cells))
    else:
        limit = np.asarray(cells if isinstance(cells, Sequence) else [cells] * image.dim)
        ratio = n_voxels / limit if isinstance(cells, Sequence) else n_voxels.max() / limit
        per_cell = max(1, int(np.ceil(ratio.max())))
    return BackgroundGrid(
        shape=tuple((-(-n_voxels // per_cell)).tolist()),
        cell_size=per_cell * image.voxel_size,
        origin=tuple((np.asarray(image.origin) + first * image.voxel_size).tolist()),
        unit=image.unit,
    )


def voxel_fractions(
    image: Image, grid: BackgroundGrid, *, domain: Domain = "inside", window: Box | None = None
) -> VolumeFractions:
    """Return the volume fractions of an image on a grid of whole voxels.

    Parameters
    ----------
    image
        The image.
    grid
        A grid from `lay_on_voxels`.
    domain
        ``"inside"`` meshes the material, ``"outside"`` the rest of the image (the pores).
    window
        Voxels whose centre is beyond this box count as empty, for either domain.

    Raises
    ------
    SamplingError
        The grid does not fit the voxels, or it holds nothing of the domain.

    Examples
    --------
    Three voxels in one cell: its first half sees voxel 0 and half of voxel 1.

    >>> image = Image(np.array([[[1.0, 0.5, 0.0]]]).repeat(3, axis=0).repeat(3, axis=1))
    >>> fractions = voxel_fractions(image, lay_on_voxels(image, cells=1))
    >>> fractions.values[1, 1].round(6).tolist()
    [0.416667, 0.5, 0.083333]
    """
    require_memory(grid, "meshing", name=image.name)
    per_cell = _to_multiple(image, grid.cell_size)
    offset = (np.asarray(grid.origin) - image.origin) / image.voxel_size
    first = np.rint(offset).astype(np.int64)
    if (np.abs(offset - first) > _ROUNDING).any():
        raise SamplingError(
            f"the grid begins {offset.tolist()} voxels from the image",
            where=image.name,
            expected="whole voxels",
            remedy="lay the grid with `lay_on_voxels`",
        )
    counted = _counted_voxels(image, window)
    blocks = np.empty(tuple(2 * n for n in grid.shape))
    layer = int(np.prod(grid.shape[1:])) * per_cell**image.dim
    step = max(1, VOXELS_AT_A_TIME // layer)
    for start in range(0, grid.shape[0], step):
        stop = min(start + step, grid.shape[0])
        size = (np.array([stop - start, *grid.shape[1:]]) * per_cell).tolist()
        corner = first.copy()
        corner[0] += start * per_cell
        values = _cut_out(image, corner, size, counted, domain)
        blocks[2 * start : 2 * stop] = _half_block_means(values, per_cell)
    fractions = VolumeFractions(grid, 2 * per_cell, combine_half_blocks(blocks))
    if not (fractions.cell_multiples > 0).any():
        raise SamplingError(
            f"no cell of the {grid.label} grid has a positive fraction of the {domain} of the "
            "image",
            where=image.name,
            expected="some material in the grid",
            remedy="check `empty` and `full`, or use the other `domain` or another window",
        )
    return fractions


def _half_block_means(values: FloatArray, per_cell: int) -> FloatArray:
    """Return the means over half-blocks of `per_cell` half voxels along each axis."""
    for axis in range(values.ndim):
        if per_cell % 2:
            values = np.repeat(values, 2, axis=axis)
        width = per_cell if per_cell % 2 else per_cell // 2
        shape = list(values.shape)
        shape[axis : axis + 1] = [shape[axis] // width, width]
        values = values.reshape(shape).mean(axis=axis + 1)
    return values


def _cut_out(
    image: Image, corner: IntArray, size: list[int], counted: list[slice], domain: Domain
) -> FloatArray:
    """Return the fractions of a box of voxels; 0 outside the image and for voxels not counted."""
    values = np.zeros(size)
    inside, there = [], []
    for low, n, use in zip(corner.tolist(), size, counted, strict=True):
        begin = max(low, use.start)
        end = max(begin, min(low + n, use.stop))
        inside.append(slice(begin, end))
        there.append(slice(begin - low, end - low))
    fractions = image.fractions(tuple(inside))
    values[tuple(there)] = fractions if domain == "inside" else 1.0 - fractions
    return values


def _counted_voxels(image: Image, window: Box | None) -> list[slice]:
    """Return along each axis the voxels whose centres lie in the window."""
    if window is None:
        return [slice(0, n) for n in image.shape]
    ranges = []
    for low, high, origin, n in zip(*window, image.origin, image.shape, strict=True):
        centres = origin + image.voxel_size * (np.arange(n) + 0.5)
        begin = int(np.searchsorted(centres, low, side="left"))
        ranges.append(slice(begin, max(begin, int(np.searchsorted(centres, high, side="right")))))
    return ranges


def _to_range(image: Image, window: Box | None) -> tuple[IntArray, IntArray]:
    """Return the first voxel of a window along each axis, and the one after its last."""
    n_voxels = np.array(image.shape)
    if window is None:
        return np.zeros(image.dim, dtype=np.int64), n_voxels
    if len(window[0]) != image.dim:
        raise _wrong_count(image, "window", len(window[0]))
    low, high = ((np.array(end) - image.origin) / image.voxel_size for end in window)
    if (high <= 0).any() or (low >= n_voxels).any():
        raise SamplingError(
            f"the window from {window[0]} to {window[1]} misses the image, which lies between "
            f"{' and '.join(map(str, image.bounding_box()))}",
            where=image.name,
            expected="a box that overlaps the image",
            remedy="correct `window`, in the units of the model",
        )
    first = np.floor(low + _ROUNDING).astype(np.int64)
    return first, np.maximum(first + 1, np.ceil(high - _ROUNDING).astype(np.int64))


def _wrong_count(image: Image, key: str, n_given: int) -> SamplingError:
    """Return the error for a setting with too few or too many numbers."""
    return SamplingError(
        f"`{key}` has {n_given} numbers, the image has {image.dim} dimensions",
        where=image.name,
        expected=f"{image.dim} numbers, one for each axis",
        remedy="give one number for each axis",
    )


def _to_multiple(image: Image, cell_size: float) -> int:
    """Return how many voxels a cell is long."""
    ratio = cell_size / image.voxel_size
    per_cell = int(np.rint(ratio))
    if per_cell < 1 or abs(ratio - per_cell) > _ROUNDING:
        raise SamplingError(
            f"a cell of {cell_size:g} is {ratio:g} voxels of {image.voxel_size:g} long",
            where=image.name,
            expected="a whole number of voxels",
            remedy=f"use cells of {max(1, per_cell) * image.voxel_size:g}",
        )
    return per_cell
