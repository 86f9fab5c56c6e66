"""Meshes whose inside is merged in tests."""

import numpy as np
from fields import fractions_of_votes
from scipy import ndimage

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.grid import BackgroundGrid
from tusqh.grid.numbering import CORNERS
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.settings.policy import Policy


def random_mesh(seed, shape, width=2.0):
    """Return the mesh of a smooth random field at one half, and its grid."""
    rng = np.random.default_rng(seed)
    smooth = ndimage.gaussian_filter(rng.random(shape), width, mode="nearest")
    grid = BackgroundGrid(shape=shape, cell_size=0.1, origin=(0.3,) * len(shape))
    kept = smooth > np.median(smooth)
    votes = rng.random(tuple(2 * n + 1 for n in shape)) < 0.5
    cells = CellSets(fractions_of_votes(kept, votes, grid), Policy(bridges="none")).at(0.5)
    return build_mesh(cells, grid, name="noise").mesh, grid


def full_mesh(shape):
    """Return the mesh of all cells of a grid, and the grid."""
    grid = BackgroundGrid(tuple(shape), 0.5, tuple(0.25 * k for k in range(len(shape))))
    vertices = np.arange(np.prod([n + 1 for n in shape])).reshape([n + 1 for n in shape])
    places = np.argwhere(np.ones(shape, dtype=bool))
    cells = np.stack(
        [vertices[tuple((places + corner).T)] for corner in CORNERS[len(shape)]], axis=1
    )
    points = grid.to_points(np.argwhere(vertices >= 0))
    mesh = VolumeMesh.from_arrays(points, cells, name="block")
    numbers = np.arange(len(cells), dtype=np.int32)
    return VolumeMesh(mesh.points, mesh.cells, mesh.kind, numbers, "block"), grid
