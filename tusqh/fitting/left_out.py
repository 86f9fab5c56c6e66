"""Parts of the surface that no boundary of a mesh follows, such as walls closer than a cell."""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tusqh.fitting.distances import distances_back
from tusqh.fitting.fitted import FELL_BACK_COLUMNS
from tusqh.fitting.target import Target
from tusqh.meshes.element_mesh import ElementMesh

#: What a row says.
LEFT_OUT = "surface without a boundary near it"
#: Samples farther than this from the boundary are left out; they are one part if this near each
#: other; parts with less area are not listed; in cells and cells squared.
_FAR, _LINK, _LEAST_AREA = 0.5, 1.0, 1.0


def list_left_out(mesh: ElementMesh, target: Target) -> pd.DataFrame:
    """Return one row for each part of the trusted surface far from the boundary of hexes.

    Parameters
    ----------
    mesh
        The fitted mesh.
    target
        The target.

    Returns
    -------
    rows
        See `tusqh.fitting.fitted.Fitted.fell_back`; `points` is 0, because no point of the boundary
        is concerned.
    """
    away = distances_back(mesh, target)
    is_far = np.isfinite(away) & (away > _FAR)
    across = np.cross(
        target.pieces[:, 1] - target.pieces[:, 0], target.pieces[:, 2] - target.pieces[:, 0]
    )
    areas = np.linalg.norm(across, axis=1) / 2
    area = np.bincount(target.sample, weights=areas, minlength=len(away))[is_far]
    places, away = target.points[is_far], away[is_far]
    pairs = cKDTree(places).query_pairs(_LINK, output_type="ndarray") if len(places) else None
    rows = []
    if pairs is not None:
        graph = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(places),) * 2)
        number = connected_components(graph, directed=False)[1]
        for part in np.unique(number):
            chosen = number == part
            if area[chosen].sum() < _LEAST_AREA:
                continue
            centre = places[chosen].mean(axis=0) * target.grid.cell_size
            why = (
                f"{area[chosen].sum():.3g} square cells lie up to {away[chosen].max():.2f} cells "
                "from it: finer than a cell, or left out for the topology"
            )
            rows.append((*(centre + np.array(target.grid.origin)), 0, LEFT_OUT, why))
    return pd.DataFrame(rows, columns=list(FELL_BACK_COLUMNS))
