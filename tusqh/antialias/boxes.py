"""The worst elements of templates in cells that are boxes."""

from __future__ import annotations

from functools import cache

import numpy as np

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.grid import BackgroundGrid
from tusqh.grid.frame import Frame
from tusqh.meshes.volume_mesh import SIDE_BALL
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Policy

#: Cells along each side of the noise, by dimension.  Other noise and larger grids have the same
#: worst element.
_CELLS = {2: 24, 3: 12}


@cache
def least_on_boxes(sides: tuple[float, ...], *, has_side_balls: bool) -> float:
    """Return the smallest scaled Jacobian of templates in boxes, which the mesh of noise has.

    Noise has all kinds of contacts, in all directions.

    Parameters
    ----------
    sides
        Edge lengths of a cell, divided by their geometric mean.
    has_side_balls
        Whether elements of balls on the sides of the grid count, too.

    Examples
    --------
    >>> round(least_on_boxes((1.0, 1.0), has_side_balls=False), 6)
    0.707107
    >>> round(least_on_boxes((2**0.5, 0.5**0.5), has_side_balls=False), 6)
    0.447214
    """
    dim = len(sides)
    grid = BackgroundGrid((_CELLS[dim],) * dim, 1.0, (0.0,) * dim, frame=Frame(sides=sides))
    noise = np.random.default_rng(0).random(tuple(2 * n + 1 for n in grid.shape))
    fractions = VolumeFractions.from_values(grid, 4, noise)
    mesh = build_mesh(CellSets(fractions, Policy(bridges="none")).at(0.5), grid).mesh
    counts = has_side_balls | (mesh.kind != SIDE_BALL)
    return float(mesh.jacobians.scaled[counts].min())
