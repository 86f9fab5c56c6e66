"""The result of fitting: the mesh, how far it lies from the surface, and what fell back."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from tusqh.grid import IntArray
from tusqh.meshes.volume_mesh import VolumeMesh

#: Columns of `Fitted.fell_back`: a place in model units, the number of points that differ from the
#: wish, what happened to them, and why.
FELL_BACK_COLUMNS = ("x", "y", "z", "points", "what", "why")

#: Columns of `Fitted.distances`.
DISTANCE_COLUMNS = ("from", "at", "count", "unit", "mean", "p99", "max")
#: What `from` begins with in rows on places where walls and gaps are at least a cell wide.
RESOLVED = "resolved "


@dataclass(frozen=True)
class Fitted:
    """A fitted mesh.

    Parameters
    ----------
    mesh
        The mesh; the first elements are those of the mesh before, in the same order, and those of
        the layer at the boundary follow, with the kind and grid cell of the element that they
        cover.
    distances
        Distances to the trusted surface, one row for each direction (`from`: ``"boundary"`` or
        ``"surface"``, and each once more after `RESOLVED`, where the grid resolves the surface),
        place (`at`: ``"vertices"``, ``"faces"`` or ``"samples"``) and `unit` (``"cells"`` or
        ``"model"``): `count`, `mean`, `p99` and `max`; NaN if there is nothing to measure.
    fell_back
        One row for each region that could not be fitted as wished, see `FELL_BACK_COLUMNS`.
    facts
        Numbers about the run, such as the seconds of each step.
    patch
        Smooth patch of the surface to which each boundary facet belongs, in the plane the piece of
        the outline between corners, in the order of ``mesh.facets.boundary``, -1 for none,
        shape (f,); None: the boundary has no feature edges or corners.
    edges
        Ends of the feature edges, points of the mesh, shape (e, 2).
    """

    mesh: VolumeMesh
    distances: pd.DataFrame
    fell_back: pd.DataFrame
    facts: dict[str, float] = field(default_factory=dict)
    patch: IntArray | None = None
    edges: IntArray = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int64))
