"""Fit the boundary of hexes to its target."""

from __future__ import annotations

import logging
from time import perf_counter

import numpy as np
import pandas as pd
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.fitting.distances import measure_distances
from tusqh.fitting.fitted import Fitted
from tusqh.fitting.left_out import CHANGED, LOOSE, NO_SURFACE, find_loose, list_left_out
from tusqh.fitting.repair import CROSSING, FOLD, Faults, list_regions, pull_back, put_back
from tusqh.fitting.rounds import Rounds
from tusqh.fitting.skin import rows_of_facets
from tusqh.fitting.target import Target
from tusqh.grid import BoolArray, IntArray
from tusqh.meshes.element_mesh import ElementMesh
from tusqh.meshes.volume_mesh import VolumeMesh

_LOG = logging.getLogger("tusqh")

#: Feature edges are given up if the least scaled Jacobian is below this, and larger without them.
_LEAST_WITH_FEATURES = 0.3
#: Weights that hold a boundary that was pulled apart, one for each round; the first gives way.
_HOLDS = (10.0, 50.0, 200.0)

#: What happens to the boundary where it cannot be pulled apart.
PUT_BACK = "put back towards the staircase"


def fit_hexes(
    mesh: VolumeMesh,
    target: Target,
    *,
    fixed: BoolArray | None = None,
    threshold: float = 0.5,
) -> Fitted:
    """Return a mesh of hexes whose boundary lies on the surface where that is possible.

    Every hex of the result is proven to be free of folds and no boundary facets cross, if that
    holds for the given mesh.

    Parameters
    ----------
    mesh
        The mesh of a threshold.
    target
        Where its boundary should lie.
    fixed
        Points that do not move, shape (n,).
    threshold
        The threshold of the mesh: the boundary first follows the level sets from it to 1/2.
    """
    begin = perf_counter()
    grid = target.grid
    rounds, regions = _run(mesh, target, fixed, threshold, True)
    if rounds.features is not None and _badness(rounds, regions) > 0:
        others = _run(mesh, target, fixed, threshold, False)
        if _badness(*others) < _badness(rounds, regions):
            is_on = np.zeros(len(rounds.moving.points), dtype=np.bool_)
            is_on[rounds.skin.vertices[rounds.features.vertex]] = True
            least, plain = (float(r.moving.quality.scaled.min()) for r in (rounds, others[0]))
            why = f"worst scaled Jacobian {least:.2f} with and {plain:.2f} without them"
            if least >= _LEAST_WITH_FEATURES:
                why = CROSSING
            row = list_regions(rounds.moving, is_on, "feature edges given up", why, grid)
            rounds, regions = others[0], [*others[1], row]
    moving = rounds.moving
    covers = rounds.covers
    new = VolumeMesh(
        points=grid.to_points(moving.points),
        cells=moving.cells,
        kind=np.concatenate([mesh.kind, mesh.kind[covers]]),
        grid_cell=np.concatenate([mesh.grid_cell, mesh.grid_cell[covers]]),
        name=mesh.name,
        unit=mesh.unit,
    )
    rows = rows_of_facets(new.facets.boundary, rounds.skin.vertices[rounds.skin.facets])
    distances = measure_distances(new, target, rounds.is_owned[rows])
    regions += _list_loose(rounds)
    fell_back = pd.concat([*regions, list_left_out(new, target)], ignore_index=True)
    features = rounds.features
    patch = None if features is None else features.label[rows]
    edges = rounds.skin.vertices[np.zeros((0, 2), int) if features is None else features.edges]
    return Fitted(new, distances, fell_back, {"seconds": perf_counter() - begin}, patch, edges)


def _list_loose(rounds: Rounds) -> list[pd.DataFrame]:
    """Return rows on the parts of the boundary that belong to no surface."""
    moving, skin, target = rounds.moving, rounds.skin, rounds.target
    grid = target.grid
    rows = []
    is_loose = rounds.is_own & find_loose(rounds.places, target)
    for chosen, what, why in (
        (is_loose, LOOSE, NO_SURFACE),
        (rounds.is_beside_change, "smoothed staircase", CHANGED),
    ):
        is_in = np.zeros(len(moving.points), dtype=np.bool_)
        is_in[skin.vertices] = chosen
        rows.append(list_regions(moving, is_in, what, why, grid))
    return rows


def _badness(rounds: Rounds, regions: list[pd.DataFrame]) -> float:
    """Return how much is wrong with a fitted mesh: what its worst hex lacks, and what was put back.

    0 for a mesh whose feature edges may stay.
    """
    least = float(rounds.moving.quality.scaled.min(initial=1.0))
    rows = pd.concat(regions, ignore_index=True)
    n_back = int(rows.loc[rows["what"] == PUT_BACK, "points"].sum())
    return max(0.0, _LEAST_WITH_FEATURES - least) + n_back / max(rounds.skin.n_vertices, 1)


def _run(
    mesh: ElementMesh,
    target: Target,
    fixed: BoolArray | None,
    threshold: float,
    has_features: bool,
) -> tuple[Rounds, list[pd.DataFrame]]:
    """Return the fitted hexes, and the regions that fell back."""
    grid = target.grid
    rounds, regions = _cover(mesh, target, fixed, has_features)
    moving, skin = rounds.moving, rounds.skin
    safe = moving.points.copy()
    rounds.fit(threshold)
    faults = Faults(moving, skin)
    why = CROSSING if faults.crossed.any() else FOLD
    pulled = _pull_apart(rounds)
    regions.append(list_regions(moving, pulled, "pulled towards the staircase", why, grid))
    faults = Faults(moving, skin)
    touched = put_back(moving, skin, safe)
    if touched.any():
        _polish_again(rounds, touched)
    why = CROSSING if faults.crossed.any() else FOLD
    regions.append(list_regions(moving, touched, PUT_BACK, why, grid))
    return rounds, regions


def _pull_apart(rounds: Rounds) -> BoolArray:
    """Pull boundary vertices around faults towards the smoothed staircase, and polish there.

    Returns
    -------
    pulled
        Whether each vertex of the mesh was pulled, shape (n,).
    """
    moving, skin = rounds.moving, rounds.skin
    pulled = np.zeros(len(moving.points), dtype=np.bool_)
    for weight in _HOLDS:
        now = pull_back(moving, skin, rounds.calm.place)
        if not now.any():
            return pulled
        pulled |= now
        rounds.hold(pulled, weight, gives_way=weight == _HOLDS[0])
        rounds.polish()
    return pulled


def _polish_again(rounds: Rounds, touched: BoolArray) -> None:
    """Polish around vertices that were put back, and undo that where it causes faults."""
    moving, skin = rounds.moving, rounds.skin
    safe = moving.points.copy()
    rounds.hold(touched)
    rounds.polish()
    put_back(moving, skin, safe)


def _cover(
    mesh: ElementMesh,
    target: Target,
    fixed: BoolArray | None,
    has_features: bool,
) -> tuple[Rounds, list[pd.DataFrame]]:
    """Return the mesh with a layer that has no fault, on as much of the boundary as possible.

    Whole surfaces of the boundary lose the layer if it cannot be untangled on them.
    """
    grid = target.grid
    surface = _surfaces(mesh)
    is_covered = np.ones(len(surface), dtype=np.bool_)
    regions: list[pd.DataFrame] = []
    while True:
        rounds = Rounds.of(mesh, target, fixed, is_covered, has_features)
        if not is_covered.any():
            return rounds, regions
        rounds.untangle()
        pulled = pull_back(rounds.moving, rounds.skin, rounds.calm.place)
        faults = Faults(rounds.moving, rounds.skin)
        if not faults.any.any():
            if pulled.any():
                _polish_again(rounds, pulled)
            return rounds, regions
        _LOG.debug("a layer has faults at %d points", faults.any.sum())
        why = CROSSING if faults.crossed.any() else FOLD
        regions.append(list_regions(rounds.moving, faults.any, "without the layer", why, grid))
        facets = rounds.skin.vertices[rounds.skin.facets]
        is_near = rounds.moving.spread(faults.any, 1)[facets].any(axis=1) & is_covered
        lost = surface[is_near] if is_near.any() else surface
        is_covered &= ~np.isin(surface, lost)


def _surfaces(mesh: ElementMesh) -> IntArray:
    """Return the number of the surface to which every boundary facet belongs, shape (f,)."""
    facets = mesh.facets.boundary
    pairs = np.stack([facets.ravel(), np.roll(facets, 1, axis=1).ravel()])
    graph = coo_array((np.ones(pairs.shape[1]), tuple(pairs)), shape=(len(mesh.points),) * 2)
    number = connected_components(graph, directed=False)[1]
    return np.asarray(number[facets[:, 0]], dtype=np.int64)
