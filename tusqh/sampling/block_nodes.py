"""The nodes of a block of samples, and interpolation from them.

The nodes are Chebyshev nodes with both end points along each axis; a polynomial through the values
at them replaces the winding number of far triangles (see `tusqh.sampling.cap_field`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.kernel_arguments import NodeTables

#: Factor by which each further node reduces the interpolation error of far triangles.
_RHO = 3.9
#: Ratio of the interpolation error at N nodes to ``_RHO ** -N``, with a margin (measured).
_ERROR = 0.15


def nodes_for(tolerance: float) -> int:
    """Return how many nodes along an axis keep the error of fractions below a tolerance.

    Parameters
    ----------
    tolerance
        Largest error of a fraction, dimensionless.

    Examples
    --------
    >>> [nodes_for(10.0**-k) for k in (4, 6, 8, 10)]
    [6, 9, 13, 16]
    """
    return max(3, int(np.ceil(np.log(_ERROR / tolerance) / np.log(_RHO))))


@dataclass(frozen=True)
class BlockNodes:
    """The nodes of a block along each axis and in C order, and matrices for their values.

    Parameters
    ----------
    places
        Coordinates of the nodes along each axis, in [0, 1].
    counts
        Number of nodes along each axis, shape (3,).
    halves
        Matrices for each axis, shape (2, n, n), that map values at the nodes to values at the nodes
        of the lower and of the upper half; shape (1, 1, 1) for the axis of a single layer.
    surface, inside
        Indices of the nodes on the surface and inside, in C order.
    fill
        Matrix that maps the surface values of a harmonic function to its values inside, shape
        (n_surface, n_inside).
    """

    places: list[FloatArray]
    counts: IntArray
    halves: list[FloatArray]
    surface: IntArray
    inside: IntArray
    fill: FloatArray

    @classmethod
    @cache
    def of(cls, n: int, is_plane: bool) -> BlockNodes:
        """Return the nodes of a block.

        Parameters
        ----------
        n
            Number of nodes along each axis.
        is_plane
            Whether the lattice has a single layer, which gets one node along its axis.
        """
        counts = np.array([n, 1 if is_plane else n, n])
        line = -np.cos(np.pi * np.arange(n) / (n - 1))
        places = [np.array([0.5]) if m == 1 else (line + 1) / 2 for m in counts]
        halves = [
            np.ones((1, 1, 1))
            if m == 1
            else np.stack([interpolation(n, (line + o) / 2) for o in (-1, 1)])
            for m in counts
        ]
        # Second derivatives at the nodes: for a harmonic function their sum over the axes is zero.
        basis = np.polynomial.chebyshev.Chebyshev
        second = np.stack([basis.basis(k).deriv(2)(line) for k in range(n)], axis=1)
        second = second @ np.linalg.inv(np.polynomial.chebyshev.chebvander(line, n - 1))
        one = np.eye(n)
        if is_plane:
            laplacian = np.kron(second, one) + np.kron(one, second)
        else:
            laplacian = (
                np.kron(np.kron(second, one), one)
                + np.kron(np.kron(one, second), one)
                + np.kron(np.kron(one, one), second)
            )
        index = np.stack(np.unravel_index(np.arange(counts.prod()), counts), axis=1)
        is_end = ((index == 0) | (index == n - 1)) & (counts > 1)
        surface = np.flatnonzero(is_end.any(axis=1))
        inside = np.flatnonzero(~is_end.any(axis=1))
        fill = -np.linalg.solve(
            laplacian[np.ix_(inside, inside)], laplacian[np.ix_(inside, surface)]
        )
        return cls(places, counts, halves, surface, inside, np.ascontiguousarray(fill.T))

    @property
    def tables(self) -> NodeTables:
        """The nodes in the form that compiled functions take."""
        x, y, z = self.places
        return NodeTables(x, y, z, self.surface, self.inside, self.fill)


def interpolation(n: int, places: FloatArray) -> FloatArray:
    """Return the matrix that maps values at nodes to values of the interpolating polynomial.

    Parameters
    ----------
    n
        Number of nodes.
    places
        Where to evaluate the polynomial, in [-1, 1], shape (m,).

    Returns
    -------
    matrix
        Shape (m, n).
    """
    nodes = -np.cos(np.pi * np.arange(n) / (n - 1))
    inverse = np.linalg.inv(np.polynomial.chebyshev.chebvander(nodes, n - 1))
    return np.asarray(np.polynomial.chebyshev.chebvander(places, n - 1) @ inverse)
