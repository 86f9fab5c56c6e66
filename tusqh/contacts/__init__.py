"""Mesh several materials in one conforming mesh; a vote decides each contact between them.

`mesh_materials` meshes the fractions of several materials or an image of labels, in 2D and 3D.
Modules: `material_fractions` and `voxel_fractions` (fractions of the materials), `votes` (which
material wins a place), `planar` (balls in 2D), `octants`, `stick_field`, `sticks`, `spatial_votes`
and `spatial` (sticks in 3D), `templates`, `emitter`, `emit_spatial` and `ball_elements`
(elements), `predict` (Betti numbers before meshing), `mesh` (the whole method).
"""

from tusqh.contacts.material_fractions import MaterialFractions
from tusqh.contacts.mesh import MaterialMesh, mesh_materials
from tusqh.contacts.voxel_fractions import fractions_of_labels

__all__ = ["MaterialFractions", "MaterialMesh", "fractions_of_labels", "mesh_materials"]
