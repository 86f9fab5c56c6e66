"""The bounds that a meshing scheme guarantees for its elements."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

#: Room for rounding in coordinates of 1e7 times the cell size.
_ROUNDING = 1e-8


@dataclass(frozen=True)
class Scheme:
    """A way to make elements, and how bad its worst element is.

    Parameters
    ----------
    name
        What messages call it.
    bounds
        Smallest scaled Jacobian that it can make, by dimension.
    """

    name: str
    bounds: Mapping[int, float]

    def allows(self, scaled_jacobian: float, dim: int) -> bool:
        """Return whether a scaled Jacobian is within the bound, up to rounding.

        Parameters
        ----------
        scaled_jacobian
            The smallest one of a mesh, dimensionless; NaN is not allowed.
        dim
            Dimension of the mesh.

        Examples
        --------
        >>> PINCH_TEMPLATES.allows(0.70711, 2), PINCH_TEMPLATES.allows(0.5, 2)
        (True, False)
        """
        return scaled_jacobian >= self.bounds[dim] - _ROUNDING


#: The trapezoids of the 1-5 template on square cells, the frusta of the 1-7 template on cubic
#: ones (paper: Anti-aliasing).
PINCH_TEMPLATES = Scheme("pinch templates", {2: math.sqrt(2) / 2, 3: 1 / math.sqrt(3)})
