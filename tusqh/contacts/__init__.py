"""Contacts between materials, each decided by its own vote, in one conforming mesh.

`mesh_materials` meshes the fractions of several materials or an image of labels, in 2D and 3D.
Modules: `material_fractions`, `voxel_fractions` (what the materials are), `votes` (who wins a
place), `planar` (balls in 2D), `octants`, `stick_field`, `sticks`, `spatial_votes`, `spatial`
(sticks in 3D), `templates`, `emitter`, `emit_spatial` (elements), `predict` (Betti numbers before
meshing), `mesh` (all of it).
"""

from tusqh.contacts.material_fractions import MaterialFractions
from tusqh.contacts.mesh import MaterialMesh, mesh_materials
from tusqh.contacts.voxel_fractions import fractions_of_labels

__all__ = ["MaterialFractions", "MaterialMesh", "fractions_of_labels", "mesh_materials"]
