"""The bounds that a meshing scheme guarantees for its elements."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from tusqh.antialias.boxes import least_on_boxes
from tusqh.meshes.volume_mesh import SIDE_BALL, VolumeMesh

#: Allowance for rounding in coordinates of up to 1e7 times the cell size.
_ROUNDING = 1e-8


@dataclass(frozen=True)
class Scheme:
    """A meshing scheme and the quality bound of its worst element.

    Parameters
    ----------
    name
        Name of the scheme in messages.
    bounds
        Smallest scaled Jacobian that it can produce, by dimension.
    on_sides
        Smallest scaled Jacobian of meshes with balls on the sides of the grid.
    """

    name: str
    bounds: Mapping[int, float]
    on_sides: float

    def bound_of(self, mesh: VolumeMesh) -> float:
        """Return the smallest scaled Jacobian that a mesh can have.

        In boxes the bound changes by the factor by which that of the worst template does.

        Parameters
        ----------
        mesh
            The mesh.
        """
        has_side_balls = bool((mesh.kind == SIDE_BALL).any())
        on_cubes = self.on_sides if has_side_balls else self.bounds[mesh.dim]
        if not mesh.sides:
            return on_cubes
        cubes, boxes = (
            least_on_boxes(sides, has_side_balls=has_side_balls)
            for sides in ((1.0,) * mesh.dim, mesh.sides)
        )
        return on_cubes * boxes / cubes

    def allows(self, scaled_jacobian: float, mesh: VolumeMesh) -> bool:
        """Return whether a scaled Jacobian is within the bound of a mesh, up to rounding.

        Parameters
        ----------
        scaled_jacobian
            Smallest scaled Jacobian of the mesh, dimensionless; NaN is not within the bound.
        mesh
            The mesh.

        Examples
        --------
        >>> import numpy as np
        >>> square = VolumeMesh.from_arrays(
        ...     np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), np.array([[0, 1, 2, 3]])
        ... )
        >>> PINCH_TEMPLATES.allows(0.70711, square), PINCH_TEMPLATES.allows(0.5, square)
        (True, False)
        """
        return scaled_jacobian >= self.bound_of(mesh) - _ROUNDING


#: The bounds come from the trapezoids of the 1-5 template on square cells, from the frusta of the
#: 1-7 template on cubic cells (paper: Anti-aliasing), and from the balls on the sides of the grid.
PINCH_TEMPLATES = Scheme(
    "pinch templates", {2: math.sqrt(2) / 2, 3: 1 / math.sqrt(3)}, on_sides=0.39
)
