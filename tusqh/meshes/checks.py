"""Check a mesh before anything is computed on it (algorithm 6).

MFEM silently accepts pinched, inverted, flat and orphaned input, and an index out of range can
crash the process, so these checks come first.
"""

from __future__ import annotations

from collections.abc import Mapping
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

#: What `check_mesh` counts, in words, by `Check.id`.
_NAMES = {
    "indices_out_of_range": "corner indices out of range",
    "non_finite_points": "points with NaN or infinite coordinates",
    "unused_points": "unused points",
    "repeated_corners": "elements that use a point twice",
    "repeated_points": "repeated points",
    "repeated_elements": "repeated elements",
    "overfull_facets": "facets shared by more than two elements",
    "hanging_nodes": "hanging nodes",
    "non_manifold_points": "non-manifold boundary points",
    "non_positive_jacobians": "elements with a non-positive corner Jacobian",
    "misplaced_points": "points at different places in two pieces",
}


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
    counts = {"indices_out_of_range": 0}
    if cells.min(initial=0) < 0 or cells.max(initial=-1) >= len(points):
        counts["indices_out_of_range"] = int(((cells < 0) | (cells >= len(points))).sum())
        return to_checks(counts)
    counts |= {
        "non_finite_points": count_rows(~np.isfinite(points)),
        "unused_points": len(points) - count_used(cells),
        "repeated_corners": count_repeated_corners(cells),
    }
    if any(counts.values()):
        return to_checks(counts)
    n_points = count_different_points(points)
    _, n_cells = number_rows(cells, np.arange(cells.shape[1])[None])
    facets = mesh.facets
    return to_checks(
        counts
        | {
            "repeated_points": len(points) - n_points,
            "repeated_elements": len(cells) - n_cells,
            "overfull_facets": int((facets.n_cells_of > 2).sum()),
            "hanging_nodes": count_hanging_nodes(points, facets.boundary),
            "non_manifold_points": len(find_non_manifold_points(facets)),
            "non_positive_jacobians": int((~(mesh.jacobians.determinant > 0)).sum()),
        }
    )


def to_checks(counts: Mapping[str, int]) -> list[Check]:
    """Return the checks that some counts are 0, in the order of the counts.

    Parameters
    ----------
    counts
        Numbers of faults by `Check.id`.
    """
    return [
        Check(id=key, name=_NAMES[key], found=found, required="0", holds=found == 0)
        for key, found in counts.items()
    ]


def count_rows(is_bad: BoolArray) -> int:
    """Return the number of rows with a True entry.

    Parameters
    ----------
    is_bad
        Truth values, shape (n, k).
    """
    return int(is_bad.any(axis=1).sum())
