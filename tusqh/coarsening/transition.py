"""The elements between small and large ones, with good shapes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tusqh.coarsening.blocks import erode
from tusqh.coarsening.sheets import split_blocks
from tusqh.coarsening.thirds import Level
from tusqh.fitting.moving import Moving
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.meshes.jacobians import smallest_jacobians

#: Smallest scaled Jacobian of an element of a transition.
LEAST = 0.25

#: Unit of length of the optimisation, in cells, so that its elements have about unit size.
_UNIT = 1.5
#: Hexes with determinants that are not above this, in cubes of that unit, are untangled.
_TANGLED = 1e-3
#: Most rounds of untangling, the first rounds of them that regularise strongly, and sweeps in each.
_ROUNDS, _WILD, _SWEEPS = 10, 4, 5
#: Sweeps over all free vertices after that.
_EVEN = 3
#: The polish moves what is around hexes below the first value until their vertices have the second.
_WORST, _WISH = 0.32, 0.5
#: Most rounds of the polish, sweeps in each, and what a round must gain.
_POLISH, _STROKES, _GAIN = 12, 4, 1e-3
#: Largest distance of a vertex of a divided block from the vertex of its cell, in cells.
_ON_GRID = 1e-9


class Transition(NamedTuple):
    """The elements in the blocks of a transition.

    Parameters
    ----------
    points
        Coordinates in cells of the level from vertex (0, 0, ...) of its blocks, shape (n, dim).
    cells
        Corners of the elements, shape (m, 2**dim).
    on_grid
        Whether each point is a vertex of an element outside the transition, shape (n,); its
        coordinates are integers.
    block
        The block in which each element lies, shape (m, dim).
    """

    points: FloatArray
    cells: IntArray
    on_grid: BoolArray
    block: IntArray

    @property
    def bad_blocks(self) -> IntArray:
        """The blocks with an element whose scaled Jacobian is less than `LEAST`."""
        scaled = smallest_jacobians(self.points, self.cells).scaled
        return np.unique(self.block[~(scaled >= LEAST)], axis=0)


def fill_transition(level: Level) -> Transition:
    """Return the elements in the transition of a level.

    Parameters
    ----------
    level
        The blocks.
    """
    seen = ~erode(~level.is_transition)
    parts = split_blocks(seen, level.split)
    is_in = level.is_transition[tuple(parts.block.T)]
    is_outside = np.zeros(len(parts.points), dtype=bool)
    is_outside[parts.cells[~is_in]] = True
    used, cells = np.unique(parts.cells[is_in], return_inverse=True)
    cells = cells.reshape(-1, parts.cells.shape[1])
    points, on_grid = parts.points[used], is_outside[used]
    off = np.abs(points[on_grid] - np.round(points[on_grid]))
    assert off.max(initial=0.0) < _ON_GRID, "a vertex outside the transition has moved"
    points[on_grid] = np.round(points[on_grid])
    if points.shape[1] == 3:
        points[~on_grid] = _optimise(points, cells, ~on_grid)[~on_grid]
    return Transition(points, cells, on_grid, parts.block[is_in])


def _optimise(points: FloatArray, cells: IntArray, is_free: BoolArray) -> FloatArray:
    """Return the points of hexes after free ones have moved to where all hexes are good."""
    free = np.where(is_free, 7, 0)
    moving = Moving.of(points / _UNIT, cells, np.arange(len(points)), free)
    for round_ in range(_ROUNDS):
        is_bad = ~(moving.quality.determinant > _TANGLED)
        if not is_bad.any():
            break
        _wake(moving, is_bad)
        moving.sweep(_SWEEPS, is_wild=round_ < _WILD)
    moving.moved[:] = 1.0
    moving.sweep(_EVEN, power=2)
    before = -np.inf
    for _ in range(_POLISH):
        scaled = moving.quality.scaled
        worst = scaled.min(initial=1.0)
        if worst >= _WORST or worst < before + _GAIN:
            break
        before = worst
        _wake(moving, scaled < _WORST)
        moving.sweep(_STROKES, wish=_WISH, longest=0.1)
    return moving.points * _UNIT


def _wake(moving: Moving, is_chosen: BoolArray) -> None:
    """Let the vertices of some hexes move, and those one ring around."""
    around = np.zeros(len(moving.points), dtype=np.bool_)
    around[moving.cells[is_chosen]] = True
    moving.moved[:] = 0.0
    moving.moved[moving.spread(around, 1)] = 1.0
