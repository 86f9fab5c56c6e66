"""Background meshes of irregular valence, and values for their nodes."""

from itertools import combinations

import numpy as np
from scipy.spatial import Delaunay

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.background.checks import require_background
from tusqh.background.makers import make_box, make_cylinder
from tusqh.background.node_values import NodeValues
from tusqh.meshes.jacobians import smallest_jacobians
from tusqh.topology.clamping import FULL


def weld(points, corners, name):
    """Return the background of cells with their own corners, merged where these are equal."""
    rounded, number = np.unique(np.round(points, 10), axis=0, return_inverse=True)
    cells = number.ravel()[np.asarray(corners)]
    turned = smallest_jacobians(rounded, cells).determinant < 0
    cells[turned] = cells[turned][
        :, [0, 3, 2, 1] if cells.shape[1] == 4 else [*range(4, 8), *range(4)]
    ]
    return BackgroundMesh(rounded, cells, name)


def split_tetrahedra(points, tetrahedra, name):
    """Return the background of tetrahedra, each of which is split into four hexes."""
    a, b, c, d = np.moveaxis(points[tetrahedra], 1, 0)
    volume = np.abs(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a))
    found = []
    for corners in points[tetrahedra[volume > 0.4 * np.median(volume)]]:
        for i in range(4):
            j, k, m = (q for q in range(4) if q != i)
            parts = [[i], [i, j], [i, j, k], [i, k], [i, m], [i, j, m], [0, 1, 2, 3], [i, k, m]]
            found += [corners[part].mean(axis=0) for part in parts]
    return weld(np.array(found), np.arange(len(found)).reshape(-1, 8), name)


def split_lattice(n=2, jitter=0.03, seed=0):
    """Return the tetrahedra of a body-centred cubic lattice, split into hexes (valences 3 to 6)."""
    rng = np.random.default_rng(seed)
    at = [
        np.stack(np.meshgrid(*[np.arange(m) + s] * 3), -1).reshape(-1, 3)
        for m, s in ((n + 1, 0.0), (n, 0.5))
    ]
    points = np.concatenate(at)
    points = points + jitter * (2 * rng.random(points.shape) - 1)
    return split_tetrahedra(points, Delaunay(points).simplices, "lattice")


def split_triangles(n=35, seed=0):
    """Return a random Delaunay triangulation, split into quads (valences 3 to 10)."""
    rng = np.random.default_rng(seed)
    points = rng.random((n, 2))
    found = []
    for corners in points[Delaunay(points).simplices]:
        if abs(np.linalg.det(corners[1:] - corners[0])) > 3e-3:
            for i in range(3):
                parts = [[i], [i, (i + 1) % 3], [0, 1, 2], [i, i - 1]]
                found += [corners[part].mean(axis=0) for part in parts]
    return weld(np.array(found), np.arange(len(found)).reshape(-1, 4), "triangles")


def ring_of_three():
    """Return three hexes around a hole; each touches both others in a face."""
    turn = np.arange(3) * (2 * np.pi / 3)
    way = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    found = []
    for k in range(3):
        a, b = way[k], way[(k + 1) % 3]
        for z in (0.0, 1.0):
            found += [[*a, z], [*(3 * a), z], [*(3 * b), z], [*b, z]]
    return weld(np.array(found), np.arange(24).reshape(3, 8), "ring")


def backgrounds():
    """Return the backgrounds of the design note by name."""
    found = [
        make_box((0, 0, 0), (1, 1, 1), (5, 5, 5)),
        make_cylinder((0, 0, 0), 1.0, 1.5, core=2, rings=2, layers=4),
        split_lattice(),
        split_triangles(),
    ]
    for background in found:
        require_background(background)
    return {background.name: background for background in found}


def random_values(rng, background):
    """Return random values of all nodes, with ties, plateaus, zeros and ones."""
    n_levels = int(rng.integers(2, 9))
    sizes = background.n_cells, background.n_edges, background.n_points
    parts = [rng.integers(0, n_levels, n) * FULL // (n_levels - 1) for n in sizes]
    if rng.random() < 0.3:
        parts[0][: len(parts[0]) // 3] = rng.integers(0, 2) * FULL
    return NodeValues(*[part.astype(np.int32) for part in parts])


def faces_of(simplex):
    """Return all non-empty subsets of a simplex."""
    return [c for k in range(1, len(simplex) + 1) for c in combinations(simplex, k)]
