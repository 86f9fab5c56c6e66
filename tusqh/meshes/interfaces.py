"""Find the facets between every two regions of a mesh, and the points at which three meet."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.element_mesh import ElementMesh


@dataclass(frozen=True)
class Interface:
    """The facets between two materials.

    Parameters
    ----------
    first, second
        The materials; ``second`` is the void on the boundary of the mesh.
    facets
        Corners of the facets, with normals from first to second, shape (r, 2**(dim - 1)).
    elements
        The element of the first material at each facet, shape (r,).
    local
        Number of each facet within its element, shape (r,).
    """

    first: str
    second: str
    facets: IntArray
    elements: IntArray
    local: IntArray


def find_interfaces(
    mesh: ElementMesh, material: IntArray, names: tuple[str, ...]
) -> dict[tuple[str, str], Interface]:
    """Return the facets between every two materials, in both directions, sorted by pair.

    Parameters
    ----------
    mesh
        The mesh.
    material
        Number of the material of every element, shape (m,).
    names
        The materials; the last one is the void, which lies outside the mesh.
    """
    facets = mesh.facets
    order = np.argsort(facets.unique, kind="stable")
    sorted_unique = facets.unique[order]
    is_pair = np.append(sorted_unique[1:] == sorted_unique[:-1], False)
    low, high = order[is_pair], order[np.flatnonzero(is_pair) + 1]
    other = np.full(len(order), len(names) - 1, dtype=np.int64)
    other[low], other[high] = material[facets.cell[high]], material[facets.cell[low]]
    own = material[facets.cell]
    rows = np.flatnonzero(own != other)
    key = own[rows] * len(names) + other[rows]
    rows, key = rows[np.argsort(key, kind="stable")], np.sort(key)
    found = {}
    for mine in np.split(rows, np.flatnonzero(np.diff(key)) + 1) if len(rows) else []:
        pair = names[own[mine[0]]], names[other[mine[0]]]
        local = mine % (2 * mesh.dim)
        found[pair] = Interface(*pair, facets.corners[mine], facets.cell[mine], local)
    return found


def find_junctions(
    mesh: ElementMesh, material: IntArray, names: tuple[str, ...]
) -> dict[tuple[str, str, str], IntArray]:
    """Return the points at which three materials meet, by the names of the three.

    In 3D the points lie on curves; a point of four materials belongs to four sets.

    Parameters
    ----------
    mesh, material, names
        See `find_interfaces`.

    Examples
    --------
    >>> from tusqh.meshes.volume_mesh import VolumeMesh
    >>> points = np.array([[x, y] for x in range(3) for y in range(2)], dtype=float)
    >>> two = VolumeMesh.from_arrays(points, [[0, 2, 3, 1], [2, 4, 5, 3]])
    >>> junctions = find_junctions(two, np.array([0, 1]), ("a", "b", "void"))
    >>> {pair: at.tolist() for pair, at in junctions.items()}
    {('a', 'b', 'void'): [2, 3]}
    """
    m = len(names)
    outside = np.unique(mesh.facets.boundary).astype(np.int64) * m + m - 1
    keys = np.unique(
        np.concatenate([(mesh.cells.astype(np.int64) * m + material[:, None]).ravel(), outside])
    )
    point, of_point = np.divmod(keys, m)
    counts = np.bincount(point, minlength=len(mesh.points))
    chosen = counts[point] > 2
    point, of_point = point[chosen], of_point[chosen]
    found: dict[tuple[int, ...], list[int]] = {}
    breaks = np.flatnonzero(np.diff(point)) + 1
    for group in np.split(np.arange(len(point)), breaks) if len(point) else []:
        for three in combinations(of_point[group].tolist(), 3):
            found.setdefault(three, []).append(int(point[group[0]]))
    return {
        (names[a], names[b], names[c]): np.array(at, dtype=np.int64)
        for (a, b, c), at in sorted(found.items())
    }


def find_junction_edges(mesh: ElementMesh, material: IntArray) -> IntArray:
    """Return the edges of a hex mesh at which three or more materials meet, shape (r, 2).

    The outside counts as a material.

    Parameters
    ----------
    mesh
        The hexes.
    material
        Number of the material of every element, shape (m,).

    Examples
    --------
    Two cubes side by side meet the outside along the sides of their common face:

    >>> from tusqh.meshes.volume_mesh import VolumeMesh
    >>> points = np.array([[x, y, z] for x in range(3) for y in range(2) for z in range(2)], float)
    >>> cube = np.array([0, 4, 6, 2, 1, 5, 7, 3])
    >>> two = VolumeMesh.from_arrays(points, [cube, cube + 4])
    >>> find_junction_edges(two, np.array([0, 1])).tolist()
    [[4, 5], [4, 6], [5, 7], [6, 7]]
    """
    facets, n = mesh.facets, len(mesh.points)
    outside = int(material.max(initial=-1)) + 1
    low = np.full(facets.n_unique, outside + 1, dtype=np.int64)
    high = np.full(facets.n_unique, -1, dtype=np.int64)
    own = material[facets.cell]
    np.minimum.at(low, facets.unique, own)
    np.maximum.at(high, facets.unique, own)
    high[facets.n_cells_of == 1] = outside
    rows = np.flatnonzero((low != high)[facets.unique])
    corners = facets.corners[rows].astype(np.int64)
    other = np.roll(corners, -1, axis=1)
    edges = (np.minimum(corners, other) * n + np.maximum(corners, other)).ravel()
    # Every edge with each material on both sides of its facets, once.
    sides = np.repeat(np.stack([low, high])[:, facets.unique[rows]], corners.shape[1], axis=1)
    edge = np.unique(edges * (outside + 1) + sides, axis=None) // (outside + 1)
    found, counts = np.unique(edge, return_counts=True)
    return np.stack(np.divmod(found[counts > 2], n), axis=1)


def facet_areas(points: FloatArray, facets: IntArray) -> FloatArray:
    """Return the length of sides or the area of faces, shape (r,).

    The area of a face that is not plane is the mean over the two ways to cut it into triangles.

    Parameters
    ----------
    points
        Coordinates, shape (n, dim), in the units of the model.
    facets
        Corners, shape (r, 2**(dim - 1)).
    """
    corners = points[facets]
    if facets.shape[1] == 2:
        return np.asarray(np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1))
    sides = np.roll(corners, -1, axis=1) - corners
    # At every corner, the triangle with the two sides that meet there; each area counts twice.
    triangles = np.cross(np.roll(sides, 1, axis=1), sides)
    return np.asarray(np.linalg.norm(triangles, axis=2).sum(axis=1) / 4)
