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

#: A triangle is far from a block if its distance to the block's centre is at least this many sides.
FAR = 1.5
#: Pieces are seldom farther from a block, in sides, because they were far from a larger block.
_FARTHEST = 4.0
#: Ratio of the error of pieces at `FAR` with N nodes to ``ellipse(FAR) ** -N`` (measured).
_ERROR = 0.07
#: Ratio of the error of pieces at `FAR` to that of pieces with fewer nodes, so that it dominates.
_MARGIN = 10.0


def ellipse(distance: FloatArray | float) -> FloatArray:
    """Return the factor by which each further node reduces the error of pieces at a distance.

    It is the sum of the half-axes of the largest Bernstein ellipse of a coordinate in which the
    field is analytic.  The worst source lies in the direction of the middle of an edge of the
    block, and the worst coordinate runs along this edge: with the others on the edge, the field is
    singular at distance ``distance - sqrt(1/2)`` beside the middle of the interval of length 1.

    Parameters
    ----------
    distance
        Distance of the source from the block's centre, in sides of the block.

    Examples
    --------
    >>> ellipse(FAR).round(2).item()
    3.46
    """
    beside = 2 * np.asarray(distance) - np.sqrt(2)
    return np.asarray(beside + np.sqrt(beside**2 + 1))


def nodes_for(tolerance: float) -> int:
    """Return how many nodes along an axis keep the error of fractions below a tolerance.

    Parameters
    ----------
    tolerance
        Largest error of a fraction, dimensionless.

    Examples
    --------
    >>> [nodes_for(10.0**-k) for k in (4, 6, 8, 10)]
    [6, 9, 13, 17]
    """
    return max(3, int(np.ceil(np.log(_ERROR / tolerance) / np.log(ellipse(FAR)))))


@dataclass(frozen=True)
class Orders:
    """Numbers of nodes for pieces at growing distances from a block.

    Parameters
    ----------
    n_nodes
        Number of nodes along each axis, decreasing, shape (m,).
    distance
        Least distance of the pieces from the block's centre, in sides of the block, increasing from
        `FAR`, shape (m,).
    """

    n_nodes: IntArray
    distance: FloatArray


@cache
def orders_for(tolerance: float) -> Orders:
    """Return how many nodes pieces need so that those farther away make no larger error.

    Parameters
    ----------
    tolerance
        Largest error of a fraction, dimensionless.

    Examples
    --------
    >>> orders = orders_for(1e-6)
    >>> orders.n_nodes.tolist(), orders.distance.round(1).tolist()
    ([9, 7, 6], [1.5, 2.2, 2.7])
    """
    n = nodes_for(tolerance)
    distances = np.linspace(FAR, _FARTHEST, 500)
    # The field of a small piece at the block's nearest corner, relative to that of one at `FAR`,
    # times the area of a soup that fills space at this distance.
    field = ((FAR - np.sqrt(0.75)) / (distances - np.sqrt(0.75)) * distances / FAR) ** 2
    allowed = ellipse(FAR) ** -n / _MARGIN
    n_nodes, distance = [n], [FAR]
    for fewer in (n - 2, n - 3):
        suffices = np.flatnonzero(field * ellipse(distances) ** -fewer <= allowed)
        if fewer > 2 and len(suffices):
            n_nodes.append(fewer)
            distance.append(float(distances[suffices[0]]))
    return Orders(np.array(n_nodes), np.array(distance))


@dataclass(frozen=True)
class BlockNodes:
    """The nodes of a block along each axis and in C order, and matrices for their values.

    Parameters
    ----------
    places
        Coordinates of the nodes along each axis, in [0, 1].
    counts
        Number of nodes along each axis, shape (3,).
    surface, inside
        Indices of the nodes on the surface and inside, in C order.
    fill
        Matrix that maps the surface values of a harmonic function to its values inside, shape
        (n_surface, n_inside).
    """

    places: list[FloatArray]
    counts: IntArray
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
        return cls(places, counts, surface, inside, np.ascontiguousarray(fill.T))

    def tables(self, distance: float) -> NodeTables:
        """Return the nodes in the form that compiled functions take.

        Parameters
        ----------
        distance
            Least distance of pieces from the centre of the block, in sides of the block.
        """
        x, y, z = self.places
        return NodeTables(x, y, z, self.surface, distance)

    def sums_from_surface(
        self, weights: list[FloatArray], block: IntArray, side: IntArray
    ) -> FloatArray:
        """Return the matrix from surface values to sums over half-blocks, shape (n_surface, m).

        Parameters
        ----------
        weights
            Weights of the nodes in the sums along each axis, shape (half-blocks, nodes) each.
        block
            Lowest half-block of a block, shape (3,).
        side
            Number of half-blocks along each side of the block, shape (3,).
        """
        x, y, z = (w[b : b + s] for w, b, s in zip(weights, block, side, strict=True))
        of_node = np.einsum("ia,jb,kc->abcijk", x, y, z).reshape(int(self.counts.prod()), -1)
        return np.ascontiguousarray(of_node[self.surface] + self.fill @ of_node[self.inside])

    def in_order(self, on_surface: FloatArray, inside: FloatArray) -> FloatArray:
        """Return values at all nodes in C order, shape (m, n_nodes).

        Parameters
        ----------
        on_surface, inside
            Values at the nodes on the surface and inside, shape (m, n_surface) and (m, n_inside).
        """
        values = np.empty((len(on_surface), int(self.counts.prod())))
        values[:, self.surface] = on_surface
        values[:, self.inside] = inside
        return values


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
