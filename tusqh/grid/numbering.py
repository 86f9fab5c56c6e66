"""Corners and faces of a cell, in VTK order.

::

    3 ----2---- 2        7 ------- 6         Corners and sides of a quad: corner c is the
    |           |       /|        /|         start of side c, traversed counter-clockwise.
    3           1      4 ------- 5 |         A hex has the quad of its lower face first,
    |           |      | 3 ------|-2         then the one of its upper face.
    0 ----0---- 1      |/        |/
                       0 ------- 1
"""

from __future__ import annotations

import numpy as np

from tusqh.grid.arrays import IntArray

#: Corner offsets of a quad, shape (4, 2).
QUAD_CORNERS: IntArray = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.int64)

#: Corner offsets of a hex, shape (8, 3).
HEX_CORNERS: IntArray = np.array(
    [[*corner, z] for z in (0, 1) for corner in QUAD_CORNERS.tolist()], dtype=np.int64
)

#: Corner offsets of a cell, by dimension.
CORNERS = {2: QUAD_CORNERS, 3: HEX_CORNERS}

#: Axis and end (0 lower, 1 upper) of every face of a cell, by dimension: the sides of a quad as
#: drawn above, the faces of a hex in the order of `tusqh.meshes.facets.HEX_FACETS`.
FACES = {
    2: ((1, 0), (0, 1), (1, 1), (0, 0)),
    3: ((0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)),
}
