r"""Build the paper's simplicial filtration of a background grid, in 2D and 3D.

Paper: Transferring Persistent Parameters to Simplices.  Nodes are the cells of the grid, its
interior vertices and, in 3D, its interior edges; a node's value is its volume fraction, clamped
between the values around it.  Every grid vertex is coned to the cells (and edges) around it::

      cell ----- cell        2D: four triangles (cell, cell, vertex) per vertex,
        | \     / |          3D: 24 tetrahedra (cell, cell, edge, vertex) per vertex.
        |  vertex |          A simplex enters together with its last node.
        | /     \ |
      cell ----- cell

The grid is padded with one layer of empty cells, so that all of its vertices are interior.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.grid.doubled import Offset, cells_around, place_dimensions, unit_offsets


@dataclass(frozen=True)
class Filtration:
    """Nodes with values above 0, and the simplices between them.

    Parameters
    ----------
    values
        Value of every node, shape (n,), dimensionless; nodes enter by decreasing value.
    positions
        Doubled-grid index of every node in the unpadded grid, shape (n, dim).
    simplices
        ``simplices[k]`` lists the k-simplices by their nodes, shape (m_k, k + 1).
    """

    values: FloatArray
    positions: IntArray
    simplices: list[IntArray]

    def simplex_values(self, k: int) -> FloatArray:
        """Return the threshold at which each k-simplex enters.

        Parameters
        ----------
        k
            Dimension of the simplices.

        Returns
        -------
        values
            Smallest value of the nodes of each simplex, shape (m_k,).
        """
        return np.asarray(self.values[self.simplices[k]].min(axis=1))


def clamp_values(values: FloatArray) -> FloatArray:
    """Return fractions after clamping interior edges and vertices to the nodes around them.

    Parameters
    ----------
    values
        Fractions on the doubled grid, shape ``2 n + 1``; the outermost layer does not change.

    Examples
    --------
    >>> import numpy as np
    >>> fractions = np.zeros((5, 5))
    >>> fractions[1::2, 1::2] = [[0.5, 0.25], [0.25, 0.5]]
    >>> fractions[2, 2] = 0.75
    >>> float(clamp_values(fractions)[2, 2])
    0.5
    """
    dim = values.ndim
    clamped = values.copy()
    if dim == 3:
        for along in range(3):
            parity = tuple(1 if axis == along else 0 for axis in range(3))
            _clamp(clamped, parity, cells_around(parity))
    origin = (0,) * dim
    around = [*cells_around(origin), *(unit_offsets(dim) if dim == 3 else [])]
    _clamp(clamped, origin, around)
    return clamped


def build_filtration(values: FloatArray) -> Filtration:
    """Return the filtration of fractions on a doubled grid of shape ``2 n + 1``.

    Only thresholds above 0 matter, so nodes with values of at most 0 are left out.

    Parameters
    ----------
    values
        Fractions on the doubled grid, shape ``2 n + 1``, dimensionless.

    Examples
    --------
    >>> import numpy as np
    >>> fractions = np.zeros((5, 5))
    >>> fractions[1::2, 1::2] = 1.0     # 2 x 2 full cells around one full vertex
    >>> fractions[2, 2] = 1.0
    >>> [len(s) for s in build_filtration(fractions).simplices]
    [5, 8, 4]
    """
    dim = values.ndim
    padded = clamp_values(np.pad(values, 2))
    is_node = (padded > 0) & (place_dimensions(padded.shape) != dim - 1)
    number = np.full(padded.shape, -1, dtype=np.int64)
    # Every place has a node except edges in 2D and faces in 3D.
    places = np.argwhere(is_node)
    number[tuple(places.T)] = np.arange(len(places))
    simplices = [np.arange(len(places), dtype=np.int64)[:, None]]
    for k in range(1, dim + 1):
        rows = [_place(number, parity, offsets) for parity, offsets in _star_simplices(dim, k)]
        simplices.append(np.concatenate(rows))
    return Filtration(values=padded[tuple(places.T)], positions=places - 2, simplices=simplices)


def _star_simplices(dim: int, k: int) -> list[tuple[Offset, tuple[Offset, ...]]]:
    """List the k-simplices by the parity of their lowest-dimensional place and all offsets."""
    found: list[tuple[Offset, tuple[Offset, ...]]] = []
    for parity in itertools.product((0, 1), repeat=dim):
        n_odd = sum(parity)
        here = (0,) * dim
        if n_odd == dim - 1:  # Two cells that share a side or face, which itself has no node.
            pair = tuple(cells_around(parity))
            if k == 1:
                found.append((parity, pair))
        elif n_odd < dim:
            found += [(parity, (here, *rest)) for rest in _link(parity, dim, k - 1)]
    return found


def _link(parity: Offset, dim: int, k: int) -> list[tuple[Offset, ...]]:
    """List the k-simplices of nodes of higher dimension around a place, as offsets."""
    cells = cells_around(parity)
    found: list[tuple[Offset, ...]] = []
    if k == 0:
        found += [(cell,) for cell in cells]
    if k == 1:
        found += [pair for pair in itertools.combinations(cells, 2) if _n_differences(*pair) == 1]
    if sum(parity) == 0 and dim == 3:
        for edge in unit_offsets(3):
            at_edge = [c for c in cells if sum(a * b for a, b in zip(c, edge, strict=True)) == 1]
            if k == 0:
                found.append((edge,))
            if k == 1:
                found += [(edge, cell) for cell in at_edge]
            if k == 2:
                found += [
                    (edge, *pair)
                    for pair in itertools.combinations(at_edge, 2)
                    if _n_differences(*pair) == 1
                ]
    return found


def _n_differences(a: Offset, b: Offset) -> int:
    return sum(x != y for x, y in zip(a, b, strict=True))


def _interior(parity: Offset, offset: Offset, shape: tuple[int, ...]) -> tuple[slice, ...]:
    """Return the places of one parity, moved by an offset, without the outermost layers."""
    return tuple(
        slice(1 + (p == 0) + o, n - 1 + o, 2) for p, o, n in zip(parity, offset, shape, strict=True)
    )


def _place(number: IntArray, parity: Offset, offsets: tuple[Offset, ...]) -> IntArray:
    """Return the node numbers of all simplices of one kind whose nodes all exist."""
    rows = np.stack([number[_interior(parity, o, number.shape)].ravel() for o in offsets], axis=1)
    return rows[(rows >= 0).all(axis=1)]


def _clamp(values: FloatArray, parity: Offset, around: list[Offset]) -> None:
    """Clamp the places of one parity to the range of the given neighbours, in place."""
    neighbours = [values[_interior(parity, offset, values.shape)] for offset in around]
    here = _interior(parity, (0,) * values.ndim, values.shape)
    values[here] = np.clip(values[here], np.min(neighbours, axis=0), np.max(neighbours, axis=0))
