"""Place a model in random orientations and offsets, and lay grids of several sizes over it.

Turning the grid is equivalent to turning the model the other way.  One lattice of blocks is sampled
for every placement, and grids of all sizes are made from it, because the fractions of a grid need
only its half-block means (`tusqh.sampling.fractions`), and these are means of whole blocks.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tusqh.geometry.kinds import Surface
from tusqh.grid import BackgroundGrid, FloatArray
from tusqh.sampling.doubled_grid import combine_half_blocks
from tusqh.sampling.fractions import VolumeFractions, sample_fractions
from tusqh.sampling.inside_lengths import box_of_inside, with_lengths
from tusqh.sampling.lattice import Box
from tusqh.settings.grid import Grid
from tusqh.settings.sampling import Sampling

#: Samples along each side of a block.
_SAMPLES = 2


@dataclass(frozen=True)
class Placement:
    """A rigid motion of the model, which turns it about the middle of a box and then moves it.

    Parameters
    ----------
    rotation
        Rotation matrix, shape (dim, dim).
    offset
        New position of the middle of the box, shape (dim,), in cells of the largest size.
    """

    rotation: FloatArray
    offset: FloatArray


def random_placements(dim: int, count: int, *, seed: int) -> list[Placement]:
    """Return orientations uniform over all rotations and offsets uniform over a cell.

    Parameters
    ----------
    dim
        Dimension, 2 or 3.
    count
        Number of placements.
    seed
        Seed of the random numbers.

    Examples
    --------
    >>> placements = random_placements(3, 2, seed=0)
    >>> turned = placements[0].rotation
    >>> bool(np.allclose(turned @ turned.T, np.eye(3))), float(np.linalg.det(turned).round(12))
    (True, 1.0)
    """
    rng = np.random.default_rng(seed)
    placements = []
    for _ in range(count):
        if dim == 2:
            angle = rng.uniform(0, 2 * np.pi)
            turned = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        else:
            turned = _from_quaternion(rng.standard_normal(4))
        placements.append(Placement(turned, rng.uniform(0, 1, dim)))
    return placements


def lay_grids(
    geometry: Surface,
    placement: Placement,
    sizes: Sequence[int],
    *,
    window: Box | None = None,
    sampling: Sampling | None = None,
) -> Iterator[tuple[int, VolumeFractions]]:
    """Yield the volume fractions of a placed model on grids of several sizes.

    Parameters
    ----------
    geometry
        The model.
    placement
        Rotation and shift of the model.
    sizes
        Numbers of cells along the longest side of the window or bounding box before the rotation;
        the largest must be a multiple of every other one.
    window
        Box that turns with the model; everything outside it counts as void.
    sampling
        How the fractions are sampled, except for the number of samples; None: with the defaults.
        Lengths in cells refer to the cells of the largest size.
    """
    low, high = (np.array(end) for end in window or geometry.bounding_box())
    finest = max(sizes)
    block = float((high - low).max()) / (2 * finest)
    coarsest = finest // min(sizes)
    centre = (low + high) / 2
    shift = placement.offset * 2 * block * coarsest
    placed = replace(geometry, points=(geometry.points - centre) @ placement.rotation.T + shift)
    finely = with_lengths(geometry, replace(sampling or Sampling(), samples=_SAMPLES), 2 * block)
    if window is None:
        box = box_of_inside(placed, placed.bounding_box(), finely, Grid(cell_size=2 * block))
        lower, upper = (np.array(end) for end in box)
    else:
        reach = np.abs(placement.rotation) @ ((high - low) / 2)
        lower, upper = shift - reach, shift + reach
    # The step is a common multiple of all cell sizes, so that the lattice holds whole cells.
    step = 2 * np.lcm.reduce([finest // size for size in sizes])
    first = np.floor(lower / (step * block)).astype(int) * step
    last = np.ceil(upper / (step * block)).astype(int) * step
    lattice = BackgroundGrid(
        shape=tuple((last - first).tolist()),
        cell_size=block,
        origin=tuple((first * block).tolist()),
    )
    blocks = sample_fractions(placed, lattice, sampling=finely).cells.copy()
    if window is not None:
        indices = np.argwhere(np.ones(lattice.shape, dtype=bool))
        places = lattice.to_points(indices.astype(np.float64) + 0.5)
        local = (places - shift) @ placement.rotation
        is_out = (np.abs(local) > (high - low) / 2).any(axis=1)
        blocks.ravel()[is_out] = 0.0
    for size in sizes:
        yield size, _on_grid(blocks, lattice, finest // size)


def _on_grid(blocks: FloatArray, lattice: BackgroundGrid, per_half: int) -> VolumeFractions:
    """Return the fractions on a grid with `per_half` blocks along each side of a half-block."""
    split = [k for n in blocks.shape for k in (n // per_half, per_half)]
    means = blocks.reshape(split).mean(axis=tuple(range(1, 2 * blocks.ndim, 2)))
    grid = BackgroundGrid(
        shape=tuple(n // 2 for n in means.shape),
        cell_size=2 * per_half * lattice.cell_size,
        origin=lattice.origin,
    )
    return VolumeFractions(grid, 2 * per_half * _SAMPLES, combine_half_blocks(means))


def _from_quaternion(quaternion: FloatArray) -> FloatArray:
    """Return the rotation of a quaternion of any length; normal variates give uniform rotations."""
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
