r"""The templates of both dimensions; they split a cell into an inner cell and a frustum per face.

The 1-5 split of a quad (paper: Anti-aliasing; algorithm 4.3)::

    3-----------2      The inner cell is inset by a quarter, and each side has a
    | \   2   / |      trapezoid.  To *separate*, kept cells at the pinch are split and
    |  3-----2  |      the trapezoids between them and the void are removed, so that the
    |3 |inner|1 |      cell draws back from the pinch.  To *connect*, empty cells at the
    |  0-----1  |      pinch are split, and the trapezoids between them and kept cells are
    | /   0   \ |      added, so that the kept cells meet side to side.
    0-----------1

The 1-7 split of a hex is analogous, with one frustum per face.  Outer faces of split cells stay
whole, so the cells around them conform.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tusqh.grid.arrays import FloatArray, IntArray
from tusqh.grid.numbering import CORNERS
from tusqh.meshes.facets import HEX_FACETS, QUAD_FACETS

#: Distance of the inner cell from the faces, in cells.  On cubic cells trapezoids have angles of 45
#: and 135 degrees, so their scaled Jacobian is sqrt(2)/2; that of frusta is 1/sqrt(3).
INSET = 0.25


@dataclass(frozen=True)
class Template:
    """The split of a cell of one dimension.

    Parameters
    ----------
    inner
        Corners of the inner cell, in cells from the lowest corner, shape (2**dim, dim).
    facets
        Corners of every face of the cell, in the order of `tusqh.grid.numbering.FACES`,
        shape (2 dim, 2**(dim - 1)).
    frusta
        Corners of the frustum at every face, shape (2 dim, 2**dim): numbers below ``2**dim`` are
        outer corners of the cell, the others corners of the inner cell.
    """

    inner: FloatArray
    facets: IntArray
    frusta: IntArray

    @property
    def n_corners(self) -> int:
        """Number of corners of a cell."""
        return len(self.inner)


def _inner(dim: int) -> FloatArray:
    return np.asarray(INSET + (1 - 2 * INSET) * CORNERS[dim])


#: The split of a cell, by dimension.
TEMPLATES = {
    2: Template(
        inner=_inner(2),
        facets=QUAD_FACETS,
        frusta=np.concatenate([QUAD_FACETS, 4 + QUAD_FACETS[:, ::-1]], axis=1),
    ),
    3: Template(
        inner=_inner(3),
        facets=HEX_FACETS,
        frusta=np.concatenate([8 + HEX_FACETS, HEX_FACETS], axis=1),
    ),
}
