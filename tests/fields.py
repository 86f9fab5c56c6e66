"""Small fields of fractions that several tests share."""

import numpy as np

from tusqh.antialias.clusters import decide_by_vote
from tusqh.antialias.pinches import find_pinches
from tusqh.antialias.resolve import resolve
from tusqh.grid import BackgroundGrid
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.sampling.fractions import VolumeFractions, round_fractions


def make_fractions(cells, vertices=None) -> VolumeFractions:
    """Return fractions with given cell and vertex values on a unit grid; edges are left 0."""
    cells = np.asarray(cells, dtype=float)
    values = np.zeros(tuple(2 * n + 1 for n in cells.shape))
    values[1::2, 1::2] = cells
    if vertices is not None:
        values[::2, ::2] = vertices
    grid = BackgroundGrid(shape=cells.shape, cell_size=1.0, origin=(0.0, 0.0))
    return VolumeFractions.from_values(grid=grid, samples=4, values=round_fractions(values))


def random_fractions(rng: np.random.Generator, shape, n_levels: int = 5) -> VolumeFractions:
    """Return random fractions with many ties, zeros and ones."""
    cells = rng.integers(0, n_levels, shape) / (n_levels - 1)
    vertices = rng.integers(0, n_levels, np.add(shape, 1)) / (n_levels - 1)
    return make_fractions(cells, vertices)


def noise_mesh(shape) -> VolumeMesh:
    """Return the mesh of random kept cells, with pinches of every kind, far from the origin."""
    rng = np.random.default_rng(1)
    kept = rng.random(shape) < 0.6
    pinches = find_pinches(kept)
    decisions = decide_by_vote(pinches, rng.random(pinches.shape) < 0.5)
    grid = BackgroundGrid(shape=shape, cell_size=0.1, origin=(1e3, -2.0, 7.0)[: len(shape)])
    return resolve(kept, decisions, grid, name="noise")[0]
