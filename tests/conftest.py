import sys
from pathlib import Path

import numpy as np
import pytest

from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid
from tusqh.sampling.fractions import VolumeFractions, round_fractions

REPOSITORY = Path(__file__).resolve().parent.parent

sys.path.insert(0, str(Path(__file__).parent))  # for `import oracles`


@pytest.fixture(scope="session")
def repository() -> Path:
    return REPOSITORY


@pytest.fixture
def square() -> Outline:
    """The unit square, counter-clockwise."""
    return Outline.from_chains(
        [np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])], name="square"
    )


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
