"""Meshes of plain cells whose exact solutions are known."""

import numpy as np

from tusqh.meshes.volume_mesh import VolumeMesh


def unit_square(n, wobble=0.0):
    points = np.array([[x, y] for x in range(n + 1) for y in range(n + 1)], dtype=float) / n
    inner = ((points > 0) & (points < 1)).all(axis=1)
    rng = np.random.default_rng(n)
    points[inner] += rng.uniform(-wobble / n, wobble / n, (int(inner.sum()), 2))
    cells = np.array(
        [[i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1, i * (n + 1) + j + 1]
         for i in range(n) for j in range(n)]
    )  # fmt: skip
    return VolumeMesh.from_arrays(points, cells, name="unit square")


def two_islands():
    one = unit_square(4)
    return VolumeMesh.from_arrays(
        np.concatenate([one.points, one.points + np.array([2.0, 0.0])]),
        np.concatenate([one.cells, one.cells + len(one.points)]),
        name="islands",
    )


def unit_cube(n):
    index = np.arange((n + 1) ** 3).reshape((n + 1,) * 3)
    points = np.argwhere(index >= 0) / n
    low, high = slice(None, -1), slice(1, None)
    ring = [(low, low), (high, low), (high, high), (low, high)]
    corners = [index[x, y, z] for z in (low, high) for x, y in ring]
    return VolumeMesh.from_arrays(points, np.stack([c.ravel() for c in corners], axis=1))
