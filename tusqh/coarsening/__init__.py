"""Coarser elements inside a mesh: blocks of grid cells far from its boundary become one element.

Only grid cells with nothing but grid cells around them are merged, so boundary, templates and
topology stay.  Elements that meet differ by at most a factor of two in size; the vertices in
between hang on the sides, edges and faces of the coarse elements, and a solver that knows this
constrains them.

Modules: `blocks` (which cells are merged), `coarse_mesh` (the coarse mesh, and back to cells),
`hanging` (the vertices that are constrained), `checks`, `files` (MFEM and VTU).
"""

from tusqh.coarsening.coarse_mesh import CoarseMesh, coarsen

__all__ = ["CoarseMesh", "coarsen"]
