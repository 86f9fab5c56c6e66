"""Make the polycrystal: ``python data_sources/polycrystal/derive.py``.

Twenty grains fill a cube of 32^3 voxels.  A voxel belongs to the nearest of twenty seeds, which are
drawn uniformly; distances are exact in integers, and of two seeds at one distance the first wins.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parent

#: Seed of the random numbers, voxels along each side, and grains.
SEED, SIDE, GRAINS = 20, 32, 20


def grains(side: int = SIDE, n: int = GRAINS, seed: int = SEED) -> np.ndarray:
    """Return the grain of every voxel, numbered from 1, shape (side, side, side)."""
    seeds = np.random.default_rng(seed).integers(0, side, (n, 3))
    axis = np.arange(side)
    squared = sum(
        ((axis[:, None] - seeds[:, k]) ** 2).reshape(
            [side if j == k else 1 for j in range(3)] + [n]
        )
        for k in range(3)
    )
    return (squared.argmin(axis=-1) + 1).astype(np.uint8)


if __name__ == "__main__":
    np.save(FOLDER / "polycrystal.npy", grains())
