"""Plates with a round hole, as outlines and as surfaces."""

import numpy as np


def plate_outline(length=60.0, width=40.0, radius=8.0, n=128):
    """Return points and segments of a plate with a round hole in its middle."""
    angle = 2 * np.pi * np.arange(n) / n
    middle = np.array([length / 2, width / 2])
    circle = middle + radius * np.column_stack([np.cos(angle), -np.sin(angle)])
    box = np.array([[0, 0], [length, 0], [length, width], [0, width]], dtype=float)
    ring = np.arange(n)
    around = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    holes = np.column_stack([4 + ring, 4 + (ring + 1) % n])
    return np.concatenate([box, circle]), np.concatenate([around, holes])


def plate_surface(size=(60.0, 40.0, 8.0), radius=8.0, n=256):
    """Return points and triangles of a plate with a round hole through its middle."""
    length, width, height = size
    corner = np.arctan2([width, width, -width, -width], [length, -length, -length, length])
    angle = np.unique(np.concatenate([2 * np.pi * np.arange(n) / n - np.pi, corner]))
    ray = np.column_stack([np.cos(angle), np.sin(angle)])
    to_side = np.array([length, width]) / 2 / np.maximum(np.abs(ray), 1e-300)
    ring = np.concatenate([radius * ray, ray * to_side.min(axis=1)[:, None]])
    ring += np.array([length / 2, width / 2])
    k = len(angle)
    points = np.concatenate([np.insert(ring, 2, z, axis=1) for z in (0.0, height)])
    i = np.arange(k)
    j = (i + 1) % k
    quads = [
        (2 * k + i, 3 * k + i, 3 * k + j, 2 * k + j),
        (i, j, k + j, k + i),
        (k + i, k + j, 3 * k + j, 3 * k + i),
        (j, i, 2 * k + i, 2 * k + j),
    ]
    halves = [np.column_stack(three) for a, b, c, d in quads for three in ((a, b, c), (a, c, d))]
    return points, np.concatenate(halves)
