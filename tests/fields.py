"""Small fields of fractions that several tests share."""

import numpy as np

from tusqh.antialias.cells import CellSet, CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.grid import BackgroundGrid
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.sampling.fractions import VolumeFractions, round_fractions
from tusqh.settings.policy import Policy


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


def fractions_of_votes(kept, votes, grid=None) -> VolumeFractions:
    """Return fractions of 1 or 0 at kept and empty cells, and at places that vote to join or not.

    The votes are an array on the doubled grid, or one value for all places.
    """
    kept = np.asarray(kept, dtype=bool)
    values = np.zeros(tuple(2 * n + 1 for n in kept.shape))
    values[...] = votes
    values[(slice(1, None, 2),) * kept.ndim] = kept
    grid = grid or BackgroundGrid(shape=kept.shape, cell_size=1.0, origin=(0.0,) * kept.ndim)
    return VolumeFractions.from_values(grid, 4, values)


def decide_votes(kept, votes) -> CellSet:
    """Return kept cells whose contacts are decided by given votes, without bridges."""
    return CellSets(fractions_of_votes(kept, votes), Policy(bridges="none")).at(0.5)


def random_votes(rng: np.random.Generator, shape) -> np.ndarray:
    """Return random votes of all places of the doubled grid."""
    return rng.random(tuple(2 * n + 1 for n in shape)) < rng.random()


def noise_mesh(shape) -> VolumeMesh:
    """Return the mesh of random kept cells, with pinches of every kind, far from the origin."""
    rng = np.random.default_rng(1)
    kept = rng.random(shape) < 0.6
    grid = BackgroundGrid(shape=shape, cell_size=0.1, origin=(1e3, -2.0, 7.0)[: len(shape)])
    fractions = fractions_of_votes(kept, rng.random(tuple(2 * n + 1 for n in shape)) < 0.5, grid)
    cells = CellSets(fractions, Policy(bridges="none")).at(0.5)
    return build_mesh(cells, grid, name="noise").mesh
