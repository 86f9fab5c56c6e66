"""The bounds that a meshing scheme guarantees for its elements."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

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
    """

    name: str
    bounds: Mapping[int, float]

    def allows(self, scaled_jacobian: float, dim: int) -> bool:
        """Return whether a scaled Jacobian is within the bound, up to rounding.

        Parameters
        ----------
        scaled_jacobian
            Smallest scaled Jacobian of a mesh, dimensionless; NaN is not within the bound.
        dim
            Dimension of the mesh.

        Examples
        --------
        >>> PINCH_TEMPLATES.allows(0.70711, 2), PINCH_TEMPLATES.allows(0.5, 2)
        (True, False)
        """
        return scaled_jacobian >= self.bounds[dim] - _ROUNDING


#: The bounds come from the trapezoids of the 1-5 template on square cells, and from the balls on
#: the sides of the grid on cubic cells; no other element in space is below the frusta of the 1-7
#: template, which have 1 / sqrt(3) (paper: Anti-aliasing).
PINCH_TEMPLATES = Scheme("pinch templates", {2: math.sqrt(2) / 2, 3: 0.39})
