"""A mesh of hexes whose vertices move, with what the compiled sweeps need."""

from __future__ import annotations

from dataclasses import dataclass, field

import numba
import numpy as np

from tusqh.fitting.energy import sweep_hexes
from tusqh.fitting.planes import FitTerms
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.meshes.jacobians import HEX_NEIGHBOURS, Jacobians, smallest_jacobians

#: Vertices with nothing around them that moved farther than this are left out, in cells.
STILL = 2e-3
#: Layers of hexes below the boundary whose vertices move.
LAYERS = 4
#: Below this number of vertices one thread is faster.
_FEW = 4000
#: Most colours.
_COLOURS = 512


@dataclass
class Moving:
    """Hexes whose vertices move; lengths in cells.

    Parameters
    ----------
    points
        Coordinates, shape (n, 3); change in place.
    cells
        Corners of the hexes, shape (m, 8).
    free
        Bit k: the vertex may move along axis k, shape (n,).
    start, entries
        ``entries[start[v]:start[v + 1]]`` are ``8 * hex + corner`` of vertex v.
    order, bounds
        ``order[bounds[c]:bounds[c + 1]]`` are the vertices of colour c that move.
    """

    points: FloatArray
    cells: IntArray
    free: IntArray
    start: IntArray
    entries: IntArray
    order: IntArray
    bounds: IntArray
    matrix: FloatArray = field(init=False)
    place: FloatArray = field(init=False)
    weight: FloatArray = field(init=False)
    moved: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        n = len(self.points)
        self.matrix, self.place = np.zeros((n, 6)), np.zeros((n, 3))
        self.weight, self.moved = np.zeros(n), np.ones(n)

    @classmethod
    def of(cls, points: FloatArray, cells: IntArray, boundary: IntArray, free: IntArray) -> Moving:
        """Return hexes of which those near the boundary move.

        Parameters
        ----------
        points, cells
            The hexes.
        boundary
            Vertices of the boundary.
        free
            See `Moving`.
        """
        start, entries = list_corners(cells, len(points))
        colour = _colour(cells, start, entries)
        is_near = np.zeros(len(points), dtype=np.bool_)
        is_near[boundary] = True
        for _ in range(LAYERS):
            is_near[cells[is_near[cells].any(axis=1)]] = True
        order = np.argsort(colour, kind="stable")
        order = order[is_near[order]]
        bounds = np.searchsorted(colour[order], np.arange(int(colour.max(initial=0)) + 2))
        return cls(points, cells, free, start, entries, order, bounds.astype(np.int64))

    def aim(self, vertices: IntArray, terms: FitTerms, weight: FloatArray) -> None:
        """Set the fit terms of vertices, and let them and what is around them move.

        Parameters
        ----------
        vertices
            The vertices.
        terms
            Their fit terms.
        weight
            Weight of each of them.
        """
        self.matrix[vertices], self.place[vertices] = terms
        self.weight[vertices] = weight
        self.moved[vertices] = 1.0

    def sweep(
        self,
        times: int,
        *,
        power: int = 1,
        wish: float = 0.0,
        longest: float = 0.25,
        is_wild: bool = False,
    ) -> None:
        """Move every vertex several times.

        Parameters
        ----------
        times
            Number of sweeps.
        power, wish, longest, is_wild
            See `tusqh.fitting.energy.sweep_hexes`.
        """
        n_threads = numba.get_num_threads()
        if len(self.order) < _FEW:  # Threads wait for each other longer than they work.
            numba.set_num_threads(1)
        for _ in range(times):
            sweep_hexes(
                self.points,
                self.cells,
                HEX_NEIGHBOURS,
                self.start,
                self.entries,
                self.order,
                self.bounds,
                self.free,
                self.matrix,
                self.weight,
                self.place,
                (power, wish, longest, is_wild),
                self.moved,
                STILL,
            )
        numba.set_num_threads(n_threads)

    @property
    def quality(self) -> Jacobians:
        """The smallest Jacobian and scaled Jacobian of every hex, now."""
        return smallest_jacobians(self.points, self.cells)

    def spread(self, is_in: BoolArray, rings: int) -> BoolArray:
        """Return a set of vertices with all that lie within some rings of hexes around it.

        Parameters
        ----------
        is_in
            The vertices, shape (n,).
        rings
            Number of rings.
        """
        wider = is_in.copy()
        for _ in range(rings):
            wider[self.cells[wider[self.cells].any(axis=1)]] = True
        return wider


def list_corners(cells: IntArray, n: int) -> tuple[IntArray, IntArray]:
    """Return the corners of hexes at every vertex.

    Parameters
    ----------
    cells
        Corners of the hexes, shape (m, 8).
    n
        Number of vertices.

    Returns
    -------
    start, entries
        See `Moving`.
    """
    flat = cells.ravel()
    start = np.zeros(n + 1, dtype=np.int64)
    np.cumsum(np.bincount(flat, minlength=n), out=start[1:])
    return start, np.argsort(flat, kind="stable").astype(np.int64)


@numba.njit(cache=True)
def _colour(cells, start, entries):  # type: ignore[no-untyped-def]
    """Return a colour of each vertex so that no hex has two vertices of one colour (greedy)."""
    n = len(start) - 1
    colour = np.full(n, -1, dtype=np.int64)
    taken = np.full(_COLOURS, -1, dtype=np.int64)
    for v in range(n):
        for e in range(start[v], start[v + 1]):
            for k in range(8):
                other = colour[cells[entries[e] >> 3, k]]
                if other >= 0:
                    taken[other] = v
        c = 0
        while taken[c] == v:
            c += 1
        colour[v] = c
    return colour
