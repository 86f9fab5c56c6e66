"""Cells that are split, in arrays that grow, and the parts that result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid import FloatArray, IntArray


@dataclass(frozen=True)
class Parts:
    """The parts of split cells.

    Parameters
    ----------
    points
        Old and new coordinates, shape (p, dim).
    cells
        Corners of the parts, shape (k, 2**dim).
    parent
        The cell to which each part belonged, shape (k,).
    tag
        0 for a part of no ball or stick; 1 + i for the ball of pinch vertex i; 1 + n + j for the
        stick of pinch edge j, where n is the number of pinch vertices; shape (k,).
    """

    points: FloatArray
    cells: IntArray
    parent: IntArray
    tag: IntArray


class Growing:
    """Arrays that grow while cells with k corners are split.

    `head[v]` is the last entry ``k * cell + corner`` at vertex v, `after` the one before it.

    Parameters
    ----------
    points, cells
        The cells.
    """

    def __init__(self, points: FloatArray, cells: IntArray) -> None:
        n_corners = cells.shape[1]
        self.counts = np.array([len(cells), len(points)])
        self.points, self.cells = points.copy(), np.array(cells, dtype=np.int64)
        self.parent = np.arange(len(cells))
        self.tag = np.zeros(len(cells), dtype=np.int64)
        self.alive = np.ones(len(cells), dtype=np.bool_)
        self.head = np.full(len(points), -1, dtype=np.int64)
        self.after = np.full(n_corners * len(cells), -1, dtype=np.int64)
        _enter(self.cells, self.head, self.after)
        self.grow()

    def grow(self) -> None:
        """Double the arrays."""
        more = len(self.alive) + 64
        for name, fill in (("cells", 0), ("parent", 0), ("tag", 0), ("alive", 0)):
            setattr(self, name, _longer(getattr(self, name), more, fill))
        self.after = _longer(self.after, more * self.cells.shape[1], -1)
        more = len(self.head) + 64
        self.points, self.head = _longer(self.points, more, 0), _longer(self.head, more, -1)

    @property
    def arrays(self) -> tuple[NDArray[Any], ...]:
        """Arrays in the order of the compiled functions."""
        return (
            self.points,
            self.cells,
            self.parent,
            self.tag,
            self.alive,
            self.head,
            self.after,
            self.counts,
        )

    def parts(self) -> Parts:
        """Return the parts into which the cells were split."""
        n_cells, n_points = self.counts
        alive = self.alive[:n_cells]
        found = (self.cells, self.parent, self.tag)
        return Parts(self.points[:n_points], *[array[:n_cells][alive] for array in found])


def _longer(old: NDArray[Any], more: int, fill: int) -> NDArray[Any]:
    return np.concatenate([old, np.full((more, *old.shape[1:]), fill, dtype=old.dtype)])


@numba.njit(cache=True)
def _enter(cells, head, after):  # type: ignore[no-untyped-def]
    """List the entries at every vertex."""
    n_corners = cells.shape[1]
    for h in range(len(cells)):
        for c in range(n_corners):
            after[n_corners * h + c] = head[cells[h, c]]
            head[cells[h, c]] = n_corners * h + c
