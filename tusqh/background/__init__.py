"""Any conforming mesh of quads or hexes in place of the grid.

The complex of such a mesh is listed: cells, edges and vertices are its nodes, and every face with
one of its edges and an end of that edge gives a tetrahedron (in 2D, every side with an end gives a
triangle).  It has the Betti numbers of the kept cells for edges of any valence.

Modules: `background_mesh` (cells and what they share), `reading` and `checks` (mesh files),
`node_values` and `simplices` (the complex), `curves` (Betti numbers at every threshold),
`scattered` and `fractions` (sampling), `pinches`, `cells`, `split_hexes`, `split_quads` and `mesh`
(the mesh at a threshold), `improve` (better elements), `run` (all steps), `makers` (common
backgrounds).
"""

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.background.reading import read_background

__all__ = ["BackgroundMesh", "read_background"]
