"""Small fields of fractions that several tests share."""

import numpy as np

from tusqh.grid import BackgroundGrid
from tusqh.sampling.fractions import VolumeFractions, round_fractions


def make_fractions(cells, vertices=None) -> VolumeFractions:
    """Fractions with given cell and vertex values on a unit grid; edges are left 0."""
    cells = np.asarray(cells, dtype=float)
    values = np.zeros(tuple(2 * n + 1 for n in cells.shape))
    values[1::2, 1::2] = cells
    if vertices is not None:
        values[::2, ::2] = vertices
    grid = BackgroundGrid(shape=cells.shape, cell_size=1.0, origin=(0.0, 0.0))
    return VolumeFractions.from_values(grid=grid, samples=4, values=round_fractions(values))


def random_fractions(rng: np.random.Generator, shape, n_levels: int = 5) -> VolumeFractions:
    """Random fractions with many ties, zeros and ones."""
    cells = rng.integers(0, n_levels, shape) / (n_levels - 1)
    vertices = rng.integers(0, n_levels, np.add(shape, 1)) / (n_levels - 1)
    return make_fractions(cells, vertices)
