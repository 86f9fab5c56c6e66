"""Geometries that several tests use."""

import numpy as np

from tusqh.geometry.soup import Soup


def box(low, high):
    """Return the surface of a box, as twelve triangles."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = np.array([t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])])
    points = np.array(low) + corners * np.subtract(high, low)
    return Soup(points, triangles, np.zeros(12, dtype=np.int64))
