"""Points and elements, and the properties that follow from them alone."""

from __future__ import annotations

from functools import cached_property

from tusqh.grid import FloatArray, IndexArray
from tusqh.meshes.boundary import Boundary, find_boundary
from tusqh.meshes.facets import Facets, find_facets
from tusqh.meshes.jacobians import Jacobians, element_volumes, smallest_jacobians


class ElementMesh:
    """Quads in the plane or hexes in space; each property is computed once, when first needed.

    `tusqh.meshes.volume_mesh.VolumeMesh` is the class of all meshes; this base class provides what
    the modules that measure a mesh need.

    Attributes
    ----------
    points
        Coordinates, shape (n, dim), in the units of the model.
    cells
        Corners of every element, shape (m, 2**dim), VTK order.
    name
        The model to which it belongs, for messages.
    """

    points: FloatArray
    cells: IndexArray
    name: str

    @property
    def dim(self) -> int:
        """Dimension of the mesh, 2 or 3."""
        return int(self.points.shape[1])

    @property
    def n_cells(self) -> int:
        """Number of elements."""
        return len(self.cells)

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.points)

    @cached_property
    def facets(self) -> Facets:
        """The sides of quads or the faces of hexes."""
        return find_facets(self.cells)

    @cached_property
    def boundary(self) -> Boundary:
        """The boundary facets and the side of the model that each one faces."""
        return find_boundary(self.points, self.facets)

    @cached_property
    def jacobians(self) -> Jacobians:
        """The smallest Jacobian and scaled Jacobian of every element."""
        return smallest_jacobians(self.points, self.cells)

    @cached_property
    def volumes(self) -> FloatArray:
        """Area of every quad or volume of every hex, shape (m,), model units**dim."""
        return element_volumes(self.points, self.cells)
