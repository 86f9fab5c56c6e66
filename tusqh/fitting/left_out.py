"""Parts of the surface that no boundary follows, and parts of a boundary that follow no surface."""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tusqh.fitting.distances import distances_back, nearest_on_surface
from tusqh.fitting.fitted import FELL_BACK_COLUMNS
from tusqh.fitting.pieces import sizes_of
from tusqh.fitting.resolved import find_beyond, find_resolved
from tusqh.fitting.target import Target
from tusqh.grid import BoolArray, FloatArray
from tusqh.meshes.element_mesh import ElementMesh

#: What rows say of a boundary that follows no surface, and why.
LOOSE, NO_SURFACE, CHANGED = (
    "follows the volume fraction 1/2",
    "no surface within reach",
    "topology was changed on purpose",
)
#: What a row says of a surface that no boundary follows.
LEFT_OUT = "surface without a boundary near it"
#: Why, for parts whose walls and gaps are mostly thinner than a cell, and for others.
_FINE, _TOPOLOGY = "finer than a cell", "left out for the topology, or the end of a tip"
#: Samples farther than this from the boundary are left out; they are one part if this near each
#: other; parts with less area or length are not listed; in cells and cells squared.
_FAR, _LINK, _LEAST_SIZE = 0.5, 1.0, 1.0


def find_loose(places: FloatArray, target: Target) -> BoolArray:
    """Return which places of a boundary lie where no trusted surface is, shape (n,).

    Parameters
    ----------
    places
        Places in cells, shape (n, dim).
    target
        The target; without any surface, as of an image, no place is loose.
    """
    if len(target.pieces) == 0:
        return np.zeros(len(places), dtype=np.bool_)
    return find_beyond(target, places, nearest_on_surface(target, places))


def list_left_out(mesh: ElementMesh, target: Target) -> pd.DataFrame:
    """Return one row for each part of the trusted surface far from the boundary of a mesh.

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
    columns = [c for c in FELL_BACK_COLUMNS if c != "z" or mesh.dim == 3]
    away = distances_back(mesh, target)
    is_far = np.isfinite(away) & (away > _FAR)
    sizes = sizes_of(target.pieces)
    size = np.bincount(target.sample, weights=sizes, minlength=len(away))
    is_resolved = find_resolved(target)[is_far]
    places, away, size = target.points[is_far], away[is_far], size[is_far]
    if len(places) == 0:
        return pd.DataFrame(columns=columns)
    pairs = cKDTree(places).query_pairs(_LINK, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(places),) * 2)
    number = connected_components(graph, directed=False)[1]
    measure = "square cells" if mesh.dim == 3 else "cells"
    rows = []
    for part in np.unique(number):
        chosen = number == part
        total = size[chosen].sum()
        if total < _LEAST_SIZE:
            continue
        centre = target.grid.to_points(places[chosen].mean(axis=0)[None])[0]
        is_coarse = size[chosen & is_resolved].sum() > total / 2
        why = (
            f"{total:.3g} {measure}, {100 * total / sizes.sum():.2g} % of the surface, lie up to "
            f"{away[chosen].max():.2f} cells from it: {_TOPOLOGY if is_coarse else _FINE}"
        )
        rows.append((*centre, 0, LEFT_OUT, why))
    return pd.DataFrame(rows, columns=columns)
