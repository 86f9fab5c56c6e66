"""Larger elements inside a mesh: blocks of grid cells far from its boundary become one element.

Only grid cells with nothing but grid cells around them change, so boundary, templates and
topology stay.  There are two kinds of coarse mesh.  In one, blocks of 2, 4, 8, ... cells along each
axis are merged; the vertices between small and large elements hang on the sides, edges and faces of
the large ones, and a solver that knows this constrains them.  In the other, blocks of 3, 9, 27, ...
cells are merged and the elements between them have shapes with which the mesh conforms.

Modules: `blocks` (cells that may be merged, blocks of two), `coarse_mesh` and `hanging` (the mesh
with hanging vertices), `thirds` (blocks of three), `sheets` and `transition` (the elements
between), `conforming` (the conforming mesh), `checks`, `files` (VTU), `mfem_text` (MFEM).
"""

from tusqh.coarsening.coarse_mesh import CoarseMesh, coarsen
from tusqh.coarsening.conforming import ConformingMesh, coarsen_conforming

__all__ = ["CoarseMesh", "ConformingMesh", "coarsen", "coarsen_conforming"]
