"""Say what is dirty about a triangle soup: measured, never repaired."""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray, IntArray

_NO_MEASURE = float("nan")
_LENGTH, _AREA, _VOLUME, _PLAIN = "model units", "model units^2", "model units^3", "-"

#: A triangle is degenerate when its height is below this part of its longest side.
_FLAT = 1e-12


def describe_surface_defects(soup: Soup) -> pd.DataFrame:
    """Return one row for each kind of defect, always the same rows in the same order.

    Dirty geometry is input, not an error; every kind is reported, found or not.

    Returns
    -------
    pandas.DataFrame
        Columns ``defect``, ``count``, ``measure`` (what it means is said in ``explanation``; NaN
        where there is nothing to measure), ``unit`` and ``explanation``.

    Notes
    -----
    Points are the same when their coordinates are equal in every bit.  Self-intersections are
    counted by pymeshlab; -1 where it cannot run.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> faces = np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3]])     # a tetrahedron without its base
    >>> table = describe_surface_defects(Soup(points, faces, np.zeros(3, dtype=np.int64)))
    >>> int(table.set_index("defect")["count"]["boundary_edges"])
    3
    """
    points, triangles = soup.matched()
    corners = points[triangles]
    sides = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1) / 2
    is_degenerate = areas * 2 <= _FLAT * sides.max(axis=1) ** 2
    edges, n_faces, n_forward, of_edge = _edges(triangles)
    is_boundary = n_faces == 1
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    n_copies = len(triangles) - len(np.unique(np.sort(triangles, axis=1), axis=0))
    is_inconsistent = (n_faces == 2) & (n_forward != 1)
    low, high = soup.bounding_box()
    rows: list[tuple[str, int, float, str, str]] = [
        ("triangles", len(triangles), float(areas.sum()), _AREA, "all triangles; their total area"),
        (
            "parts",
            len(np.unique(soup.parts)),
            float(max(h - b for h, b in zip(high, low, strict=True))),
            _LENGTH,
            "objects or solids of the file; longest side of the bounding box",
        ),
        (
            "shells",
            _count_shells(of_edge, len(edges)),
            _NO_MEASURE,
            _PLAIN,
            "components of triangles that share edges",
        ),
        (
            "boundary_edges",
            int(is_boundary.sum()),
            float(lengths[is_boundary].sum()),
            _LENGTH,
            "edges of one triangle only; their total length",
        ),
        (
            "non_manifold_edges",
            int((n_faces > 2).sum()),
            float(lengths[n_faces > 2].sum()),
            _LENGTH,
            "edges of more than two triangles; their total length",
        ),
        (
            "non_manifold_vertices",
            _count_non_manifold_vertices(triangles, of_edge, n_faces),
            _NO_MEASURE,
            _PLAIN,
            "points at which the triangles form more than one fan",
        ),
        (
            "inconsistent_edges",
            int(is_inconsistent.sum()),
            float(lengths[is_inconsistent].sum()),
            _LENGTH,
            "edges that both of their triangles walk in the same direction",
        ),
        (
            "duplicate_triangles",
            n_copies,
            _NO_MEASURE,
            _PLAIN,
            "triangles with the same corners as an earlier one, in any order",
        ),
        (
            "degenerate_triangles",
            int(is_degenerate.sum()),
            float(sides[is_degenerate].max(initial=0.0)),
            _LENGTH,
            "triangles without an area; their longest side",
        ),
        (
            "self_intersecting_triangles",
            _count_self_intersections(points, triangles),
            _NO_MEASURE,
            _PLAIN,
            "triangles that cross another one (pymeshlab)",
        ),
        (
            "unbalanced_edges",
            int((2 * n_forward != n_faces).sum()),
            _NO_MEASURE,
            _PLAIN,
            "edges not walked equally often both ways: the boundary that the winding number sees",
        ),
        (
            "signed_volume",
            int(np.sign(_signed_volume(corners)) < 0),
            _signed_volume(corners),
            _VOLUME,
            "volume enclosed, negative (count 1) where the normals point inwards",
        ),
    ]
    columns = ["defect", "count", "measure", "unit", "explanation"]
    return pd.DataFrame(rows, columns=columns)


def _edges(triangles: IntArray) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """Return edges, their numbers of triangles and of forward walks, and each side's edge."""
    sides = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    n = int(triangles.max()) + 1
    key = np.sort(sides, axis=1) @ np.array([n, 1])
    unique, of_side = np.unique(key, return_inverse=True)
    n_faces = np.bincount(of_side)
    n_forward = np.bincount(of_side, weights=sides[:, 0] < sides[:, 1]).astype(np.int64)
    edges = np.stack([unique // n, unique % n], axis=1)
    return edges, n_faces, n_forward, of_side.reshape(3, -1).T


def _count_shells(of_edge: IntArray, n_edges: int) -> int:
    """Return how many components the triangles form that share edges."""
    m = len(of_edge)
    rows = np.repeat(np.arange(m), 3)
    graph = coo_array((np.ones(3 * m), (rows, m + of_edge.ravel())), shape=(m + n_edges,) * 2)
    return int(connected_components(graph, directed=False, return_labels=False))


def _count_non_manifold_vertices(triangles: IntArray, of_edge: IntArray, n_faces: IntArray) -> int:
    """Count the points whose triangles, joined across edges at the point, form several fans."""
    m = len(triangles)
    wedge = np.arange(3 * m).reshape(m, 3)
    # Side k of a triangle joins its wedges k and k + 1 with those of its neighbours.
    end_of_edge = np.concatenate(
        [
            np.stack([wedge[:, k], 2 * of_edge[:, k] + (triangles[:, k] > triangles[:, m_])], 1)
            for k, m_ in ((0, 1), (1, 2), (2, 0))
        ]
        + [
            np.stack([wedge[:, m_], 2 * of_edge[:, k] + (triangles[:, m_] > triangles[:, k])], 1)
            for k, m_ in ((0, 1), (1, 2), (2, 0))
        ]
    )
    size = 3 * m + 2 * len(n_faces)
    places = (end_of_edge[:, 0], 3 * m + end_of_edge[:, 1])
    graph = coo_array((np.ones(len(end_of_edge)), places), shape=(size, size))
    n_fans, fan = connected_components(graph, directed=False)
    point_of_fan = np.full(n_fans, -1, dtype=np.int64)
    point_of_fan[fan[: 3 * m]] = triangles.ravel()
    fans_of = np.bincount(point_of_fan[point_of_fan >= 0])
    return int((fans_of > 1).sum())


def _count_self_intersections(points: FloatArray, triangles: IntArray) -> int:
    try:
        import pymeshlab

        meshes = pymeshlab.MeshSet(verbose=False)
        meshes.add_mesh(pymeshlab.Mesh(points - points[0], triangles.astype(np.int32)))
        meshes.compute_selection_by_self_intersections_per_face()
        return int(meshes.current_mesh().selected_face_number())
    except (ImportError, AttributeError):
        return -1


def _signed_volume(corners: FloatArray) -> float:
    """Return a sixth of the sum of the triple products, about the middle of the box."""
    centred = corners - (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1))) / 2
    triple = np.einsum("mi,mi->m", centred[:, 0], np.cross(centred[:, 1], centred[:, 2]))
    return float(triple.sum() / 6)
