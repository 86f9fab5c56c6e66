"""The creases of a surface, chain by chain, and how well the feature edges of a mesh hold them.

A crease is where two smooth patches of the surface meet at an angle.  Whether the surface has an
edge there does not matter: each two samples of different patches that are near give the place
where their planes cross.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, minimum_spanning_tree
from scipy.spatial import cKDTree

from tusqh.fitting.distances import distances_to_boundary
from tusqh.fitting.features import CREASE, SHORTEST, SMOOTH
from tusqh.fitting.fitted import Fitted
from tusqh.fitting.patches import LEAST_AREA, link_samples
from tusqh.fitting.target import Target, to_cells
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.patches import number_patches
from tusqh.sampling.nearest_triangle import find_nearest, make_tree

#: Columns of the table of chains.
CHAIN_COLUMNS = (
    *("patch_a", "patch_b", "length", "cells", "captured", "mean_distance", "max_distance"),
    *("from_boundary", "min_scaled_jacobian", "x", "y", "z", "why"),
)

#: What is said of a crease without any feature edge.
NO_EDGE = "no feature edge beside it: the boundary has no border of the two patches there"

#: A crease counts as captured within this distance of a feature edge, in cells.
CAPTURED = 0.1
#: Samples of two patches whose planes may cross in a crease are at most this far apart, and no
#: farther from the crease; places on it are at least about this far apart, and those of one chain
#: at most that far; in cells.
_NEAR, _SPACING, _LINK = 0.5, 0.25, 0.8
#: Shortest chain that is listed, in cells.
_LISTED = 2.0
#: Reach of what lies beside a crease, and distance from the boundary that says it is absent, in
#: cells.
_BESIDE, _ABSENT = 1.0, 0.5


class Creases(NamedTuple):
    """Places on the creases of a surface, in cells.

    Parameters
    ----------
    places
        The places, shape (c, 3).
    pair
        The two patches that meet at each, shape (c, 2).
    chain
        The chain of each, shape (c,).
    area
        Area of each patch, in cells squared, shape (patches,).
    """

    places: FloatArray
    pair: IntArray
    chain: IntArray
    area: FloatArray


def find_creases(target: Target) -> Creases:
    """Return places on all creases of the trusted surface.

    Parameters
    ----------
    target
        The target, of a geometry in space.
    """
    number, area = link_samples(target, SMOOTH)
    nothing = Creases(np.zeros((0, 3)), np.zeros((0, 2), int), np.zeros(0, int), area)
    if len(area) < 2:
        return nothing
    i, j = cKDTree(target.points).query_pairs(_NEAR, output_type="ndarray").T
    bend = np.einsum("pk,pk->p", target.normals[i], target.normals[j])
    chosen = (number[i] != number[j]) & (bend < np.cos(np.radians(CREASE)))
    i, j, bend = i[chosen], j[chosen], bend[chosen]
    # The place nearest to the middle of both samples that lies in the planes of both.
    middle = (target.points[i] + target.points[j]) / 2
    one = np.einsum("pk,pk->p", target.points[i] - middle, target.normals[i])
    other = np.einsum("pk,pk->p", target.points[j] - middle, target.normals[j])
    rest = np.maximum(1 - bend**2, 1e-9)
    a, b = (one - bend * other) / rest, (other - bend * one) / rest
    places = middle + a[:, None] * target.normals[i] + b[:, None] * target.normals[j]
    away = [np.linalg.norm(places - target.points[k], axis=1) for k in (i, j)]
    is_near = np.maximum(*away) <= _NEAR
    pair = np.sort(np.stack([number[i], number[j]], axis=1), axis=1)[is_near]
    places, pair = _thin(places[is_near], pair)
    if len(places) == 0:
        return nothing
    links = cKDTree(places).query_pairs(_LINK, output_type="ndarray")
    links = links[(pair[links[:, 0]] == pair[links[:, 1]]).all(axis=1)]
    graph = coo_array((np.ones(len(links)), tuple(links.T)), shape=(len(places),) * 2)
    return Creases(places, pair, connected_components(graph, directed=False)[1], area)


def list_chains(fitted: Fitted, target: Target) -> pd.DataFrame:
    """Return one row for each chain of the creases of a surface, the longest first.

    Parameters
    ----------
    fitted
        The fitted mesh.
    target
        Its target.

    Returns
    -------
    rows
        The columns `CHAIN_COLUMNS`: the numbers of both patches as in `tusqh.meshes.patches`, empty
        where the mesh does not have it; the length in model units and in cells; the share within
        `CAPTURED` cells of a feature edge; the mean and largest distance from the feature edges
        and the largest from the boundary, in cells; the smallest scaled Jacobian of the elements
        with a boundary facet within a cell; the middle; and why a part was not captured.
    """
    if target.grid.dim == 2:
        return pd.DataFrame(columns=[name for name in CHAIN_COLUMNS if name != "z"])
    creases = find_creases(target)
    mesh = fitted.mesh
    points = to_cells(mesh.points, target.grid)
    off = np.full(len(creases.places), np.inf)
    if len(fitted.edges) and len(off):
        off = find_nearest(make_tree(points[fitted.edges][:, [0, 1, 1]]), creases.places).distance
    depth = distances_to_boundary(mesh, target, creases.places)
    scaled = mesh.jacobians.scaled[mesh.boundary.element]
    facets = cKDTree(points[mesh.boundary.corners].mean(axis=1))
    name = _names_of_patches(fitted, creases.area)
    given_up = fitted.fell_back.loc[fitted.fell_back["what"].str.startswith("feature edges"), "why"]
    rows = []
    for chain in range(int(creases.chain.max(initial=-1)) + 1):
        mine = np.flatnonzero(creases.chain == chain)
        places = creases.places[mine]
        length = _length(places)
        if length < _LISTED:
            continue
        two = creases.pair[mine[0]]
        beside = np.unique(np.concatenate([[], *facets.query_ball_point(places, _BESIDE)]))
        worst = float(scaled[beside.astype(np.int64)].min(initial=np.inf))
        captured = float((off[mine] <= CAPTURED).mean())
        why = "" if captured == 1 else _why(creases, mine, length, off, depth, given_up.tolist())
        far = [np.nan, np.nan] if np.isinf(off[mine]).any() else [off[mine].mean(), off[mine].max()]
        middle = target.grid.to_points(places.mean(axis=0)[None])[0]
        size = (length * target.grid.cell_size, length)
        at = (depth[mine].max(), worst if np.isfinite(worst) else np.nan)
        both = sorted((name[k] for k in two), key=lambda number: (number is None, number))
        rows.append((*both, *size, captured, *far, *at, *middle, why))
    rows.sort(key=lambda row: (-round(row[3], 6), *np.round(row[9:12], 6)))
    table = pd.DataFrame(rows, columns=list(CHAIN_COLUMNS))
    return table.astype({"patch_a": "Int64", "patch_b": "Int64"})


def _why(
    creases: Creases,
    mine: IntArray,
    length: float,
    off: FloatArray,
    depth: FloatArray,
    given_up: list[str],
) -> str:
    """Return why a part of a chain was not captured."""
    lost = mine[off[mine] > CAPTURED]
    smallest = float(creases.area[creases.pair[mine[0]]].min())
    if given_up:
        return f"feature edges given up: {given_up[0]}"
    if smallest < LEAST_AREA:
        return f"a patch of {smallest:.1f} square cells; at least {LEAST_AREA:g} are needed"
    if length < SHORTEST:
        return f"shorter than {SHORTEST} edges of cells"
    if (depth[lost] > _ABSENT).mean() > 0.5:
        return "no boundary near it: finer than a cell, or left out for the topology"
    if (off[lost] <= _BESIDE).mean() > 0.5:
        return "the edge gives way at single points, so that elements stay good"
    return NO_EDGE


def _names_of_patches(fitted: Fitted, area: FloatArray) -> list[int | None]:
    """Return the number in tables and sets of each patch of the surface, None for none."""
    of_large: dict[int, int] = {}
    if fitted.patch is not None:
        numbered = number_patches(fitted.mesh, fitted.patch) + 1
        of_large = dict(zip(fitted.patch.tolist(), numbered.tolist(), strict=True))
    large = np.where(area >= LEAST_AREA, np.cumsum(area >= LEAST_AREA) - 1, -2)
    return [of_large.get(k) for k in large.tolist()]


def _thin(places: FloatArray, pair: IntArray) -> tuple[FloatArray, IntArray]:
    """Return the mean place of each small box and pair of patches."""
    box = np.floor(places / _SPACING).astype(np.int64)
    keys, group = np.unique(np.concatenate([pair, box], axis=1), axis=0, return_inverse=True)
    count = np.bincount(group.ravel(), minlength=len(keys))
    sums = [np.bincount(group.ravel(), weights=x, minlength=len(keys)) for x in places.T]
    return np.stack(sums, axis=1) / count[:, None], keys[:, :2]


def _length(places: FloatArray) -> float:
    """Return the length of a curve through places, closed where both ends are near."""
    if len(places) < 2:
        return 0.0
    pairs = cKDTree(places).query_pairs(_LINK, output_type="ndarray")
    away = np.linalg.norm(places[pairs[:, 0]] - places[pairs[:, 1]], axis=1)
    graph = coo_array((away, tuple(pairs.T)), shape=(len(places),) * 2).tocsr()
    return float(minimum_spanning_tree(graph).sum()) + _SPACING
