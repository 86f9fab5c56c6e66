"""The background grid, its numbering conventions, and the neighbourhoods of its cells.

Arrays in C order are indexed ``[i, j]`` or ``[i, j, k]`` = (x, y[, z]).  A grid of shape
``n = (nx, ny)`` has cells ``0 <= i < nx`` and grid vertices ``0 <= i <= nx``::

      (0,2)---(1,2)---(2,2)
        | (0,1) | (1,1) |          Vertices are (n, dim) float64 arrays, connectivity
      (0,1)---(1,1)---(2,1)        is (m, 2**dim) int32 in VTK order.
        | (0,0) | (1,0) |
      (0,0)---(1,0)---(2,0)

Modules: `background` (the grid), `numbering` (corners and faces of a cell), `neighbourhoods` (the
cells around vertices and edges, the corners of cells, neighbours across faces), `doubled` (cells,
faces, edges and vertices in one array), `arrays` (types).
"""

from tusqh.grid.arrays import BoolArray, FloatArray, IndexArray, IntArray
from tusqh.grid.background import BackgroundGrid
from tusqh.grid.numbering import HEX_CORNERS, QUAD_CORNERS

__all__ = [
    "HEX_CORNERS",
    "QUAD_CORNERS",
    "BackgroundGrid",
    "BoolArray",
    "FloatArray",
    "IndexArray",
    "IntArray",
]
