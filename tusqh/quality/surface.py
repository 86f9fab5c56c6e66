"""The mesh as a surface, seen by pymeshlab: a second opinion on topology."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tusqh.extras import require
from tusqh.meshes.facets import find_facets
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.quality.system_libraries import SystemLibraryError, describe_missing


@dataclass(frozen=True)
class SurfaceMeasures:
    """What pymeshlab finds on a mesh: the quads of a 2D mesh, or the boundary of a 3D one.

    Quads are split into triangles.  Two flat elements that overlap are not a self-intersection
    to pymeshlab, which looks for crossing triangles; `measure_overlap` finds those.
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

    Raises
    ------
    MissingExtraError
        pymeshlab is not installed; it comes with the extra `verdict`.
    SystemLibraryError
        pymeshlab cannot be loaded because a system library is missing; the message names the
        package to install.

    Notes
    -----
    With a non-manifold vertex pymeshlab gives -1 boundary loops.
    """
    try:
        pymeshlab = require("pymeshlab", extra="verdict")
        meshes = pymeshlab.MeshSet(verbose=False)
        quads = mesh.cells
        if mesh.dim == 3:
            facets = find_facets(mesh.cells)
            quads = facets.corners[facets.on_boundary]
        used, quads = np.unique(quads, return_inverse=True)
        quads = quads.reshape(-1, 4)
        points = np.zeros((len(used), 3))
        points[:, : mesh.dim] = mesh.points[used] - mesh.points[0]
        triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        meshes.add_mesh(pymeshlab.Mesh(points, triangles.astype(np.int32)))
        measures = meshes.get_topological_measures()
        meshes.compute_selection_by_self_intersections_per_face()
    except (ImportError, AttributeError) as reason:
        # Without libGL the filters are missing: attributes of MeshSet that do not exist.
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


def measure_overlap(mesh: VolumeMesh) -> float:
    """Return the area that elements of a 2D mesh cover more than once, over their total area.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [3, 0], [3, 2], [1, 2]])
    >>> measure_overlap(VolumeMesh.from_arrays(points, [[0, 1, 2, 3], [4, 5, 6, 7]]))
    0.25
    """
    import shapely

    quads = shapely.polygons(mesh.points[mesh.cells] - mesh.points[0])
    total = float(shapely.area(quads).sum())
    return (total - float(shapely.union_all(quads).area)) / total
