"""The volume mesh that every later step reads."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tusqh.extras import require
from tusqh.grid import FloatArray, IndexArray, IntArray
from tusqh.grid.arrays import as_indices
from tusqh.meshes.element_mesh import ElementMesh
from tusqh.meshes.measure import Measurement, measure
from tusqh.meshes.mfem_mesh import to_mfem

__all__ = ["VolumeMesh"]

#: The kinds of element, indexed by `VolumeMesh.kind`.
KINDS = (
    "grid cell",
    "inner cell",
    "separating template",
    "connecting template",
    "bridge",
    "ball on a side",
    "transition",
)
GRID_CELL, INNER_CELL, SEPARATING, CONNECTING, BRIDGE, SIDE_BALL, TRANSITION = range(7)


@dataclass(frozen=True)
class VolumeMesh(ElementMesh):
    """Quads in the plane or hexes in space.

    Parameters
    ----------
    points
        Coordinates, shape (n, dim), in the units of the model.
    cells
        Corners of every element, shape (m, 2**dim), VTK order, positively oriented; int32, or int64
        where that is too small.
    kind
        Kind of each element (index into `KINDS`), shape (m,), int8.
    grid_cell
        Flat index (C order) of the background-grid cell in which each element lies, shape (m,);
        int32, or int64 where that is too small.
    name
        The model to which it belongs, for messages.
    unit
        Unit of length of the points; empty if it is not known.
    sides
        Edge lengths of a cell of the grid divided by their geometric mean; empty for cubes.
    """

    points: FloatArray
    cells: IndexArray
    kind: NDArray[np.int8]
    grid_cell: IndexArray
    name: str = "mesh"
    unit: str = ""
    sides: tuple[float, ...] = ()

    @cached_property
    def measurement(self) -> Measurement:
        """Checks, Betti numbers, scaled Jacobians and volume."""
        return measure(self)

    @classmethod
    def from_arrays(cls, points: ArrayLike, cells: ArrayLike, *, name: str = "mesh") -> VolumeMesh:
        """Return a mesh of plain grid cells, for meshes that did not come from a grid.

        Parameters
        ----------
        points
            Coordinates, shape (n, dim), in model units.
        cells
            Corners of every element, shape (m, 2**dim), VTK order, positively oriented.
        name
            Name of the model, for messages.

        Examples
        --------
        >>> import numpy as np
        >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        >>> VolumeMesh.from_arrays(square, np.array([[0, 1, 2, 3]])).n_cells
        1
        """
        corners = as_indices(np.asarray(cells))
        kind = np.zeros(len(corners), dtype=np.int8)
        grid_cell = np.full(len(corners), -1, dtype=np.int32)
        places = np.asarray(points, dtype=np.float64)
        return cls(points=places, cells=corners, kind=kind, grid_cell=grid_cell, name=name)

    def take(self, chosen: IntArray, *, name: str) -> VolumeMesh:
        """Return some elements as a mesh with its own points.

        Parameters
        ----------
        chosen
            The elements, shape (r,).
        name
            Name of their mesh.

        Examples
        --------
        >>> import numpy as np
        >>> points = np.array([[x, y] for x in range(3) for y in range(2)], dtype=float)
        >>> two = VolumeMesh.from_arrays(points, [[0, 2, 3, 1], [2, 4, 5, 3]])
        >>> two.take(np.array([1]), name="right").points.tolist()
        [[1.0, 0.0], [1.0, 1.0], [2.0, 0.0], [2.0, 1.0]]
        """
        cells = self.cells[chosen]
        is_used = np.zeros(len(self.points), dtype=bool)
        is_used[cells] = True
        number = np.cumsum(is_used, dtype=np.int64) - 1
        return VolumeMesh(
            points=self.points[is_used],
            cells=number[cells],
            kind=self.kind[chosen],
            grid_cell=self.grid_cell[chosen],
            name=name,
            unit=self.unit,
            sides=self.sides,
        )

    def points_in_space(self) -> FloatArray:
        """Return the points with three coordinates, shape (n, 3); in the plane z is 0."""
        points = np.zeros((len(self.points), 3))
        points[:, : self.dim] = self.points
        return points

    def to_pyvista(self) -> Any:
        """Return the mesh as a `pyvista.UnstructuredGrid`, with `kind` and `grid_cell`."""
        pyvista = require("pyvista", extra="formats")

        cell_type = pyvista.CellType.QUAD if self.dim == 2 else pyvista.CellType.HEXAHEDRON
        grid = pyvista.UnstructuredGrid({cell_type: self.cells}, self.points_in_space())
        grid.cell_data["kind"] = self.kind.astype(np.int8)
        grid.cell_data["grid_cell"] = self.grid_cell
        return grid

    def to_meshio(self) -> Any:
        """Return the mesh as a `meshio.Mesh`, with `kind` and `grid_cell`."""
        import meshio

        cell_type = "quad" if self.dim == 2 else "hexahedron"
        data = {"kind": [self.kind.astype(np.int8)], "grid_cell": [self.grid_cell]}
        return meshio.Mesh(self.points_in_space(), [(cell_type, self.cells)], cell_data=data)

    def to_mfem(self, attributes: IntArray | None = None) -> Any:
        """Return the mesh as an `mfem.ser.Mesh` if it passes our checks.

        Parameters
        ----------
        attributes
            Attribute of every element, from 1, such as its material, shape (m,); None: all 1.

        Raises
        ------
        SimulationError
            Our checks or MFEM reject the mesh.
        """
        return to_mfem(self.measurement, attributes)
