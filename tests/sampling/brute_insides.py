"""Envelopes and shells by another road: all distances, labels of SciPy, balls one by one."""

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree


def distances(points, corners):
    """Return the distance of each point to the nearest triangle or segment."""
    best = np.full(len(points), np.inf)
    for corner in corners:
        best = np.minimum(best, to_piece(points, corner))
    return best


def to_piece(points, corner):
    n = len(corner)
    sides = [to_segment(points, corner[k], corner[(k + 1) % n]) for k in range(n if n > 2 else 1)]
    best = np.min(sides, axis=0)
    if n == 3:
        normal = np.cross(corner[1] - corner[0], corner[2] - corner[0])
        if np.linalg.norm(normal) > 1e-12:
            normal /= np.linalg.norm(normal)
            height = (points - corner[0]) @ normal
            foot = points - height[:, None] * normal
            turns = [
                np.cross(corner[(k + 1) % 3] - corner[k], foot - corner[k]) @ normal
                for k in range(3)
            ]
            best = np.where(np.min(turns, axis=0) >= 0, np.abs(height), best)
    return best


def to_segment(points, a, b):
    along = b - a
    share = np.clip((points - a) @ along / max(along @ along, 1e-300), 0, 1)
    return np.linalg.norm(points - a - share[:, None] * along, axis=1)


def envelope(corners, shape, radius, growth):
    """Return which samples (i, j, k) lie in the envelope."""
    points = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1)
    points = points.reshape(-1, 3).astype(float)
    distance = distances(points, corners)
    labels, _ = ndimage.label((distance >= radius).reshape(shape))
    is_reached = (labels == labels[0, 0, 0]).ravel()
    is_outside = is_reached.copy()
    is_centre = is_reached & (distance < radius + growth)
    balls = cKDTree(points).query_ball_point(
        points[is_centre], distance[is_centre] * (1 - 1e-12), return_sorted=False
    )
    is_outside[np.unique(np.concatenate([[], *balls]).astype(int))] = True
    return ~is_outside.reshape(shape)
