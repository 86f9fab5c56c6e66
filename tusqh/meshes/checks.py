"""Checks that a mesh must pass before anything is computed on it (algorithm notes 6).

MFEM accepts pinched, inverted, flat and orphaned input without a word, and an index out of range
can crash the process, so these come first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.errors import MeshError
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.meshes.facets import Facets, find_facets
from tusqh.meshes.hanging_nodes import count_points_in_faces
from tusqh.meshes.jacobians import corner_jacobians
from tusqh.meshes.volume_mesh import VolumeMesh


@dataclass(frozen=True)
class Check:
    """One row of a verdict: what was checked, found and required.

    ``holds`` is None where the check could not be run; ``found`` then says why.
    """

    name: str
    found: object
    required: str
    holds: bool | None


def check_mesh(mesh: VolumeMesh) -> list[Check]:
    """Return the checks of indices, coordinates, conformity, boundary and orientation.

    Later checks need the earlier ones: the list ends at the first group that fails.

    Examples
    --------
    >>> import numpy as np
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> all(check.holds for check in check_mesh(VolumeMesh.from_arrays(square, [[0, 1, 2, 3]])))
    True
    >>> flipped = check_mesh(VolumeMesh.from_arrays(square, [[0, 3, 2, 1]]))
    >>> [check.name for check in flipped if not check.holds]
    ['elements with a non-positive corner Jacobian']
    """
    points, cells = mesh.points, mesh.cells
    n_out = int(((cells < 0) | (cells >= len(points))).sum())
    checks = [_none("corner indices out of range", n_out)]
    if n_out:
        return checks
    checks += [
        _none("points with NaN or infinite coordinates", _count_rows(~np.isfinite(points))),
        _none("unused points", len(points) - len(np.unique(cells))),
        _none("elements that use a point twice", _n_with_repeated_corner(cells)),
    ]
    if not all(check.holds for check in checks):
        return checks
    checks += [
        _none("repeated points", len(points) - len(np.unique(points, axis=0))),
        _none("repeated elements", len(cells) - len(np.unique(np.sort(cells, axis=1), axis=0))),
    ]
    facets = find_facets(cells)
    checks += [
        _none("facets shared by more than two elements", int((facets.n_cells_of > 2).sum())),
        _none("hanging nodes", count_hanging_nodes(points, facets)),
        _none("non-manifold boundary points", len(find_non_manifold_points(facets))),
    ]
    jacobian, _ = corner_jacobians(points, cells)
    checks.append(
        _none("elements with a non-positive corner Jacobian", _count_rows(~(jacobian > 0)))
    )
    return checks


def require_sound(mesh: VolumeMesh) -> None:
    """Raise a `MeshError` that names the model and everything `check_mesh` found wrong."""
    failed = [check for check in check_mesh(mesh) if not check.holds]
    if failed:
        raise MeshError(
            "; ".join(f"{check.name}: {check.found}" for check in failed),
            where=mesh.name,
            expected="a conforming, manifold mesh of valid elements",
            remedy="make the mesh with `tusqh`, or repair it in the tool that wrote it",
        )


def find_non_manifold_points(facets: Facets) -> IntArray:
    """Return the points at which the boundary is no manifold.

    In 2D every boundary point of a manifold mesh lies on exactly two boundary sides.  In 3D every
    boundary edge lies in exactly two boundary faces, and the boundary faces at a point form one
    fan.
    """
    boundary = facets.corners[facets.on_boundary]
    if boundary.shape[1] == 2:
        n_sides = np.bincount(boundary.ravel()) if boundary.size else np.zeros(0, dtype=np.int64)
        return np.flatnonzero((n_sides != 0) & (n_sides != 2)).astype(np.int64)
    if len(boundary) == 0:
        return np.empty(0, dtype=np.int64)
    edges = find_facets(boundary)
    is_bad = edges.n_cells_of[edges.unique] != 2
    # Corner c of a face is one wedge; sides c - 1 and c of the face meet there.
    order = np.argsort(edges.unique[~is_bad], kind="stable")
    rows = np.flatnonzero(~is_bad)[order].reshape(-1, 2)
    wedges = []
    for end in range(2):
        ends = rows + end if end == 0 else rows - rows % 4 + (rows + 1) % 4
        wedges.append(ends)
    # Side r runs from wedge r to the next one of its face; its twin runs the other way or not.
    start = edges.corners[rows[:, 0], 0]
    first_of_twin = np.where(edges.corners[rows[:, 1], 0] == start, 0, 1)
    twin_start = np.where(first_of_twin == 0, wedges[0][:, 1], wedges[1][:, 1])
    twin_end = np.where(first_of_twin == 0, wedges[1][:, 1], wedges[0][:, 1])
    links = np.concatenate(
        [
            np.stack([wedges[0][:, 0], twin_start], axis=1),
            np.stack([wedges[1][:, 0], twin_end], axis=1),
        ]
    )
    n = boundary.size
    graph = coo_array((np.ones(len(links)), tuple(links.T)), shape=(n, n))
    n_fans, fan = connected_components(graph, directed=False)
    point_of_fan = np.empty(n_fans, dtype=np.int64)
    point_of_fan[fan] = boundary.ravel()
    n_fans_of = np.bincount(point_of_fan)
    several = np.flatnonzero(n_fans_of > 1)
    return np.union1d(several, edges.corners[is_bad].ravel()).astype(np.int64)


def count_hanging_nodes(points: FloatArray, facets: Facets) -> int:
    """Return how many boundary points lie inside a boundary side (in 3D a face or its edge)."""
    boundary = facets.corners[facets.on_boundary]
    if len(boundary) == 0:
        return 0
    if boundary.shape[1] == 4:
        return count_points_in_faces(points, boundary)
    import shapely

    sides = shapely.linestrings(points[boundary])
    candidates = np.unique(boundary)
    # A point that hangs on a side was put there on purpose: far closer than any element is small.
    tolerance = 1e-9 * float(shapely.length(sides).max())
    node, side = shapely.STRtree(sides).query(
        shapely.points(points[candidates]), predicate="dwithin", distance=tolerance
    )
    is_end = (boundary[side] == candidates[node][:, None]).any(axis=1)
    return len(np.unique(node[~is_end]))


def _none(name: str, found: int) -> Check:
    return Check(name=name, found=found, required="0", holds=found == 0)


def _count_rows(is_bad: BoolArray) -> int:
    return int(is_bad.any(axis=1).sum())


def _n_with_repeated_corner(cells: IntArray) -> int:
    ordered = np.sort(cells, axis=1)
    return _count_rows(ordered[:, 1:] == ordered[:, :-1])
