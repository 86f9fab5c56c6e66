"""Measure a solid of hexes or tetrahedra: topology, volume, worst element, boundary fit."""

from __future__ import annotations

from typing import Any

import numpy as np

from studies.methods.digital_topology import closed_betti
from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.measure import measure
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.topology.betti_numbers import BettiNumbers

#: Number of random points on a surface at which distances to another surface are measured.
_N_POINTS = 20_000

_TET_EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])
_TET_FACES = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])


def cut_tets(points: FloatArray, tets: IntArray) -> VolumeMesh:
    """Return the same solid with each tetrahedron cut into four hexes, one per corner.

    The corners of the hex at `a` are `a` and the middles of the edges, faces and tetrahedron that
    contain `a`.  Neighbours are cut consistently, so topology and conformity are preserved.

    Parameters
    ----------
    points
        Coordinates, shape (n, 3).
    tets
        Point indices of each tetrahedron, shape (m, 4).

    Examples
    --------
    >>> mesh = cut_tets(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), [[0, 1, 2, 3]])
    >>> mesh.n_cells, len(mesh.points), round(6 * mesh.measurement.volume, 12)
    (4, 15, 1.0)
    """
    tets = np.asarray(tets, dtype=np.int64)
    blocks, numbers, first = [points], {}, len(points)
    for local in (_TET_EDGES, _TET_FACES, np.arange(4)[None]):
        members = np.sort(tets[:, local], axis=-1).reshape(-1, local.shape[1])
        unique, index = np.unique(members, axis=0, return_inverse=True)
        blocks.append(points[unique].mean(axis=1))
        index = index.reshape(len(tets), len(local)) + first
        for column, corners in enumerate(local.tolist()):
            numbers[frozenset(corners)] = index[:, column]
        first += len(unique)
    hexes = []
    for a, b, c, d in ((0, 1, 2, 3), (1, 0, 3, 2), (2, 0, 1, 3), (3, 0, 2, 1)):
        corner = [{a}, {a, b}, {a, b, c}, {a, c}, {a, d}, {a, b, d}, {a, b, c, d}, {a, c, d}]
        at = [tets[:, a] if len(of) == 1 else numbers[frozenset(of)] for of in corner]
        hexes.append(np.stack(at, axis=1))
    return VolumeMesh.from_arrays(np.concatenate(blocks), np.concatenate(hexes))


def describe_solid(points: FloatArray, cells: IntArray, *, cell_size: float) -> dict[str, Any]:
    """Return whether a solid is manifold, its Betti numbers, volume and worst element.

    Parameters
    ----------
    points
        Coordinates, shape (n, 3).
    cells
        Hexes (m, 8) or tetrahedra (m, 4), VTK order.
    cell_size
        Edge length of the lattice of hexes; used only if they are non-manifold.

    Returns
    -------
    measures
        `elements`, `kind`; `manifold`; `betti_0..2` (missing for non-manifold
        tetrahedra); `volume` in model units cubed; `worst_scaled_jacobian` by VTK, 1 for a cube
        and a regular tetrahedron.
    """
    is_hex = cells.shape[1] == 8
    mesh = VolumeMesh.from_arrays(points, cells) if is_hex else cut_tets(points, cells)
    measured = measure(mesh)
    is_manifold = measured.n_non_manifold == 0
    betti: BettiNumbers | None = None
    if is_manifold:
        betti = measured.by_euler
    elif is_hex:
        middles = points[cells].mean(axis=1)
        index = np.rint((middles - middles.min(axis=0)) / cell_size).astype(np.int64)
        kept = np.zeros(index.max(axis=0) + 1, dtype=bool)
        kept[tuple(index.T)] = True
        betti = closed_betti(kept)
    return {
        "kind": "hexes" if is_hex else "tetrahedra",
        "elements": len(cells),
        "manifold": is_manifold,
        **(betti._asdict() if betti else dict.fromkeys(("betti_0", "betti_1", "betti_2"))),
        "volume": measured.volume,
        "worst_scaled_jacobian": _worst(points, cells),
    }


def measure_fit(points: FloatArray, cells: IntArray, soup: Soup) -> dict[str, float]:
    """Return the distances between the boundary of a solid and a surface, in model units.

    `boundary_mean` and `boundary_max` are distances from the boundary to the surface,
    `surface_mean` and `surface_max` from the surface to the boundary, over random points with a
    fixed seed.

    Parameters
    ----------
    points
        Coordinates of the solid, shape (n, 3).
    cells
        Hexes (m, 8) or tetrahedra (m, 4), VTK order.
    soup
        The surface.
    """
    mesh = VolumeMesh.from_arrays(points, cells) if cells.shape[1] == 8 else cut_tets(points, cells)
    facets = mesh.facets
    quads = facets.corners[facets.on_boundary]
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    there = _distances(mesh.points, triangles, soup.points, soup.triangles)
    back = _distances(soup.points, soup.triangles, mesh.points, triangles)
    return {
        "boundary_mean": float(there.mean()),
        "boundary_max": float(there.max()),
        "surface_mean": float(back.mean()),
        "surface_max": float(back.max()),
    }


def _distances(
    points: FloatArray, triangles: IntArray, others: FloatArray, of_others: IntArray
) -> FloatArray:
    """Return the distances of random points on some triangles to other triangles."""
    import igl

    rng = np.random.default_rng(0)
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    drawn = rng.choice(len(triangles), _N_POINTS, p=areas / areas.sum())
    u, v = rng.random((2, _N_POINTS, 1))
    is_over = u + v > 1
    u, v = np.where(is_over, 1 - u, u), np.where(is_over, 1 - v, v)
    queries = a[drawn] + u * (b - a)[drawn] + v * (c - a)[drawn]
    squared = igl.point_mesh_squared_distance(
        queries, np.ascontiguousarray(others), np.ascontiguousarray(of_others)
    )[0]
    return np.asarray(np.sqrt(np.maximum(squared, 0.0)))


def _worst(points: FloatArray, cells: IntArray) -> float:
    import pyvista

    centred = points - points.mean(axis=0)
    grid = pyvista.UnstructuredGrid({12 if cells.shape[1] == 8 else 10: cells}, centred)
    quality: Any = grid.cell_quality("scaled_jacobian")
    return float(np.min(quality.cell_data["scaled_jacobian"]))
