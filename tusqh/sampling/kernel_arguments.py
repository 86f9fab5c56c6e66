"""Arguments of the compiled functions in `angles` and `cap_field`, grouped into named tuples.

numba's cache on disk does not notice a changed field here: change those two files as well.
"""

from __future__ import annotations

from typing import NamedTuple

from tusqh.grid import FloatArray, IntArray


class Pieces(NamedTuple):
    """The triangles or segments of a chain, in steps of the lattice from its first sample.

    Parameters
    ----------
    corners
        Triangles, shape (m, 3, 3), or segments in the plane y = 0, shape (m, 2, 3).
    multiplicity
        Signed number of times each one counts, shape (m,).
    middle, reach
        Centre of each, shape (m, 3), and the distance of its farthest corner, shape (m,).
    """

    corners: FloatArray
    multiplicity: IntArray
    middle: FloatArray
    reach: FloatArray


class Points(NamedTuple):
    """Coordinates of points, in steps of the lattice, shape (n,) each."""

    x: FloatArray
    y: FloatArray
    z: FloatArray


class Lists(NamedTuple):
    """A list of pieces for every block.

    Parameters
    ----------
    pieces
        Indices of the pieces of all blocks, one list after the other.
    start
        Block ``r`` has ``pieces[start[r] : start[r + 1]]``, shape (n_blocks + 1,).
    """

    pieces: IntArray
    start: IntArray


class Blocks(NamedTuple):
    """Blocks of one size at which far pieces are evaluated.

    Parameters
    ----------
    lowest
        Lowest corner of each block, in steps of the lattice, shape (n_blocks, 3).
    size
        Their size along each axis, in steps of the lattice, shape (3,).
    """

    lowest: FloatArray
    size: FloatArray


class NodeTables(NamedTuple):
    """The nodes of a block, see `tusqh.sampling.block_nodes.BlockNodes`.

    Parameters
    ----------
    x, y, z
        Coordinates of the nodes along each axis, in [0, 1].
    surface
        Indices of the nodes on the surface, in C order.
    distance
        Least distance of pieces from the centre of the block, in sides of the block.
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    surface: IntArray
    distance: float


class Samples(NamedTuple):
    """The samples of a range of half-blocks.

    Parameters
    ----------
    begin
        First half-block along x.
    half
        Samples along each side of a half-block, shape (3,).
    first, last
        The samples ``first <= k < last`` along each axis count, shape (3,) each.
    """

    begin: int
    half: IntArray
    first: IntArray
    last: IntArray


class Ball(NamedTuple):
    """A ball that contains points, and the least distance of all chosen pieces from it."""

    x: float
    y: float
    z: float
    radius: float
    clearance: float
