"""Check a mesh before anything is computed on it (algorithm 6).

MFEM silently accepts pinched, inverted, flat and orphaned input, and an index out of range can
crash the process, so these checks come first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tusqh.grid import BoolArray
from tusqh.meshes.element_mesh import ElementMesh
from tusqh.meshes.hanging_nodes import count_hanging_nodes
from tusqh.meshes.manifold import find_non_manifold_points
from tusqh.meshes.numbering import (
    count_different_points,
    count_repeated_corners,
    count_used,
    number_rows,
)

#: The checks that a conforming mesh passes, by `Check.id`.
CONFORMITY = frozenset(
    {
        "indices_out_of_range",
        "unused_points",
        "repeated_points",
        "repeated_elements",
        "overfull_facets",
        "hanging_nodes",
    }
)


@dataclass(frozen=True)
class Check:
    """One check of a mesh: its subject, the finding and the requirement.

    Parameters
    ----------
    id
        Identifier, which does not change when the wording does.
    name
        What was checked, in words.
    found, required
        The value of the mesh, and the value that it must have.
    holds
        Whether the mesh passed; None if the check could not be run, in which case `found` gives the
        reason.
    is_warning
        Whether the mesh may be used even if the check fails.
    remedy
        What the user can do if the check fails.
    material
        The material that was checked; "all" for the mesh as a whole.
    """

    id: str
    name: str
    found: object
    required: str
    holds: bool | None
    is_warning: bool = False
    remedy: str = ""
    material: str = "all"


def check_mesh(mesh: ElementMesh) -> list[Check]:
    """Return the checks of indices, coordinates, conformity, boundary and orientation.

    Later checks need the earlier ones, so the list ends at the first group that fails.
    `tusqh.meshes.volume_mesh.VolumeMesh.measurement` caches them.

    Parameters
    ----------
    mesh
        The mesh.

    Examples
    --------
    >>> from tusqh.meshes.volume_mesh import VolumeMesh
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> all(check.holds for check in check_mesh(VolumeMesh.from_arrays(square, [[0, 1, 2, 3]])))
    True
    >>> flipped = check_mesh(VolumeMesh.from_arrays(square, [[0, 3, 2, 1]]))
    >>> [check.id for check in flipped if not check.holds]
    ['non_positive_jacobians']
    """
    points, cells = mesh.points, mesh.cells
    n_out = 0
    if cells.min(initial=0) < 0 or cells.max(initial=-1) >= len(points):
        n_out = int(((cells < 0) | (cells >= len(points))).sum())
    checks = [_none("indices_out_of_range", "corner indices out of range", n_out)]
    if n_out:
        return checks
    n_infinite, n_used = _count_rows(~np.isfinite(points)), count_used(cells)
    checks += [
        _none("non_finite_points", "points with NaN or infinite coordinates", n_infinite),
        _none("unused_points", "unused points", len(points) - n_used),
        _none("repeated_corners", "elements that use a point twice", count_repeated_corners(cells)),
    ]
    if not all(check.holds for check in checks):
        return checks
    n_points = count_different_points(points)
    _, n_cells = number_rows(cells, np.arange(cells.shape[1])[None])
    facets = mesh.facets
    n_overfull = int((facets.n_cells_of > 2).sum())
    n_bad = len(find_non_manifold_points(facets))
    n_inverted = int((~(mesh.jacobians.determinant > 0)).sum())
    return [
        *checks,
        _none("repeated_points", "repeated points", len(points) - n_points),
        _none("repeated_elements", "repeated elements", len(cells) - n_cells),
        _none("overfull_facets", "facets shared by more than two elements", n_overfull),
        _none("hanging_nodes", "hanging nodes", count_hanging_nodes(points, facets.boundary)),
        _none("non_manifold_points", "non-manifold boundary points", n_bad),
        _none("non_positive_jacobians", "elements with a non-positive corner Jacobian", n_inverted),
    ]


def _none(identifier: str, name: str, found: int) -> Check:
    return Check(id=identifier, name=name, found=found, required="0", holds=found == 0)


def _count_rows(is_bad: BoolArray) -> int:
    return int(is_bad.any(axis=1).sum())
