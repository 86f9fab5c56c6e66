"""Facts that determine the defects of a soup, each computed once, when it is needed."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from tusqh.geometry.soup import Soup
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.grid.components import label_components

#: A triangle is degenerate if its height is at most this fraction of its longest side.
FLAT_HEIGHT = 1e-12


class SoupFacts:
    """Facts of a soup whose coinciding points are merged.

    Parameters
    ----------
    soup
        The soup.
    """

    def __init__(self, soup: Soup) -> None:
        self.soup = soup
        #: Distinct points, shape (n, 3), and triangles between them, shape (m, 3).
        self.points, self.triangles = soup.matched()

    @cached_property
    def corners(self) -> FloatArray:
        """Coordinates of the corners of every triangle, shape (m, 3, 3)."""
        return np.asarray(self.points[self.triangles])

    @cached_property
    def areas(self) -> FloatArray:
        """Area of every triangle, shape (m,)."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        return np.asarray(np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2)

    @cached_property
    def longest_sides(self) -> FloatArray:
        """Longest side of every triangle, shape (m,)."""
        sides = self.corners - np.roll(self.corners, -1, axis=1)
        return np.asarray(np.linalg.norm(sides, axis=2).max(axis=1))

    @cached_property
    def is_degenerate(self) -> BoolArray:
        """Whether each triangle has no area, shape (m,)."""
        return np.asarray(self.areas * 2 <= FLAT_HEIGHT * self.longest_sides**2)

    @cached_property
    def _sides(self) -> tuple[IntArray, IntArray, IntArray]:
        """Sides of triangles, shape (3m, 2), numbers of distinct edges, and each side's edge."""
        sides = np.concatenate([self.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
        n_points = int(self.triangles.max()) + 1
        key = np.sort(sides, axis=1) @ np.array([n_points, 1])
        unique, edge_of_side = np.unique(key, return_inverse=True)
        edges = np.stack([unique // n_points, unique % n_points], axis=1)
        return sides, edges, edge_of_side

    @cached_property
    def side_to_edge(self) -> IntArray:
        """Edge of side k, from corner k to corner k + 1, of every triangle, shape (m, 3)."""
        return self._sides[2].reshape(3, -1).T

    @cached_property
    def edge_lengths(self) -> FloatArray:
        """Length of every edge, shape (n_edges,)."""
        start, end = self._sides[1].T
        return np.asarray(np.linalg.norm(self.points[start] - self.points[end], axis=1))

    @cached_property
    def n_faces(self) -> IntArray:
        """Number of triangles at every edge, shape (n_edges,)."""
        return np.bincount(self._sides[2])

    @cached_property
    def n_forward(self) -> IntArray:
        """Number of triangles that traverse an edge from its lower point, shape (n_edges,)."""
        sides, _, edge_of_side = self._sides
        forward = np.bincount(edge_of_side, weights=sides[:, 0] < sides[:, 1])
        return forward.astype(np.int64)

    @cached_property
    def n_shells(self) -> int:
        """Number of components of triangles that share edges."""
        m, n_edges = len(self.triangles), len(self.n_faces)
        rows = np.repeat(np.arange(m), 3)
        columns = m + self.side_to_edge.ravel()
        return label_components(rows, columns, m + n_edges)[1]

    @cached_property
    def n_non_manifold_vertices(self) -> int:
        """Number of points whose triangles, joined across edges there, form several fans."""
        triangles, m = self.triangles, len(self.triangles)
        corner = np.arange(3 * m).reshape(m, 3)
        # Side k joins the corners k and k + 1 of its triangle to those of its neighbours; each
        # edge has two nodes, one per end point.
        links = []
        for k in range(3):
            near, far = k, (k + 1) % 3
            for own, other in ((near, far), (far, near)):
                end = 2 * self.side_to_edge[:, k] + (triangles[:, own] > triangles[:, other])
                links.append(np.stack([corner[:, own], 3 * m + end], axis=1))
        pairs = np.concatenate(links)
        size = 3 * m + 2 * len(self.n_faces)
        fan, n_fans = label_components(pairs[:, 0], pairs[:, 1], size)
        point_of_fan = np.full(n_fans, -1, dtype=np.int64)
        point_of_fan[fan[: 3 * m]] = triangles.ravel()
        fans_of_point = np.bincount(point_of_fan[point_of_fan >= 0])
        return int((fans_of_point > 1).sum())

    @cached_property
    def signed_volume(self) -> float:
        """Sixth of the sum of the triple products, about the centre of the bounding box."""
        corners = self.corners
        centred = corners - (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1))) / 2
        triple = np.einsum("mi,mi->m", centred[:, 0], np.cross(centred[:, 1], centred[:, 2]))
        return float(triple.sum() / 6)

    @cached_property
    def n_self_intersecting(self) -> int:
        """Number of triangles that cross another one; -1 if pymeshlab cannot run."""
        try:
            import pymeshlab

            meshes = pymeshlab.MeshSet(verbose=False)
            triangles = self.triangles.astype(np.int32)
            meshes.add_mesh(pymeshlab.Mesh(self.points - self.points[0], triangles))
            meshes.compute_selection_by_self_intersections_per_face()
            return int(meshes.current_mesh().selected_face_number())
        except (ImportError, AttributeError):
            return -1
