"""Measure the surface of a mesh with pymeshlab, as a second opinion on its topology."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tusqh.extras import MissingExtraError, require
from tusqh.meshes.checks import Check
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.quality.system_libraries import SystemLibraryError, describe_missing
from tusqh.topology.betti_numbers import BettiNumbers


@dataclass(frozen=True)
class SurfaceMeasures:
    """Measures by pymeshlab of the quads of a 2D mesh or of the boundary of a 3D mesh.

    Quads are split into triangles.  pymeshlab looks for crossing triangles and does not report flat
    elements that overlap; `tusqh.quality.overlap` finds these.
    """

    non_manifold_edges: int
    non_manifold_vertices: int
    self_intersecting_faces: int
    unreferenced_vertices: int
    connected_components: int
    boundary_loops: int
    genus: int


def surface_measures(mesh: VolumeMesh) -> SurfaceMeasures:
    """Return pymeshlab's topological measures of a 2D mesh or of the boundary of a 3D mesh.

    Parameters
    ----------
    mesh
        The mesh.

    Raises
    ------
    MissingExtraError
        pymeshlab is not installed; it comes with the extra `verdict`.
    SystemLibraryError
        pymeshlab cannot be loaded because a system library is missing; the message names the
        package to install.

    Notes
    -----
    pymeshlab reports -1 boundary loops for a mesh with a non-manifold vertex.
    """
    try:
        pymeshlab = require("pymeshlab", extra="verdict")
        meshes = pymeshlab.MeshSet(verbose=False)
        quads = mesh.cells if mesh.dim == 2 else mesh.facets.boundary
        used, quads = np.unique(quads, return_inverse=True)
        quads = quads.reshape(-1, 4)
        points = np.zeros((len(used), 3))
        points[:, : mesh.dim] = mesh.points[used] - mesh.points[0]
        triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        meshes.add_mesh(pymeshlab.Mesh(points, triangles.astype(np.int32)))
        measures = meshes.get_topological_measures()
        meshes.compute_selection_by_self_intersections_per_face()
    except (ImportError, AttributeError) as reason:
        # Without libGL the filters, which are attributes of MeshSet, do not exist.
        raise SystemLibraryError(
            f"pymeshlab cannot run: {reason}",
            where="quality",
            expected="pymeshlab and the system libraries it is linked to",
            remedy=describe_missing() or "install pymeshlab again",
        ) from reason
    return SurfaceMeasures(
        non_manifold_edges=int(measures["non_two_manifold_edges"]),
        non_manifold_vertices=int(measures["non_two_manifold_vertices"]),
        self_intersecting_faces=int(meshes.current_mesh().selected_face_number()),
        unreferenced_vertices=int(measures["unreferenced_vertices"]),
        connected_components=int(measures["connected_components_number"]),
        boundary_loops=int(measures["number_holes"]),
        genus=int(measures["genus"]),
    )


def judge_surface(
    mesh: VolumeMesh,
    predicted: BettiNumbers,
    measure: Callable[[VolumeMesh], object] = surface_measures,
) -> list[Check]:
    """Return pymeshlab's checks of the mesh as a surface.

    Parameters
    ----------
    mesh
        The mesh.
    predicted
        Betti numbers that it must have.
    measure
        Function that measures the surface.

    Returns
    -------
    checks
        One check per measure; "not run" if pymeshlab or a system library is missing.
    """
    required = {
        "non_manifold_edges": 0,
        "non_manifold_vertices": 0,
        "self_intersecting_faces": 0,
        "unreferenced_vertices": 0,
        "connected_components": predicted.betti_0 + predicted.betti_2,
        "boundary_loops": predicted.betti_0 + predicted.betti_1,
    }
    if mesh.dim == 3:  # The boundary of a volume is closed, and its handles are the holes.
        required |= {"boundary_loops": 0, "genus": predicted.betti_1}
    measures, missing = None, ""
    try:
        measures = measure(mesh)
    except MissingExtraError as reason:
        missing = f"not run: {reason.where} is not installed"
    except SystemLibraryError as reason:
        missing = f"not run: {reason.found}"
    return [
        Check(
            id=f"pymeshlab_{key}",
            name=f"{key.replace('_', ' ')} (pymeshlab)",
            found=missing or getattr(measures, key),
            required=str(value),
            holds=None if missing else getattr(measures, key) == value,
        )
        for key, value in required.items()
    ]
