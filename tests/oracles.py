"""Slow, independent counts that the tests compare the library with."""

from __future__ import annotations

import itertools

import numpy as np


def gf2_rank(columns: list[int]) -> int:
    """Return the rank over GF(2) of a matrix whose columns are the bits of integers."""
    pivots: dict[int, int] = {}
    for column in columns:
        while column:
            low = column & -column
            if low not in pivots:
                pivots[low] = column
                break
            column ^= pivots[low]
    return len(pivots)


def betti_by_rank(cells) -> tuple[int, int, int]:
    """Return Betti numbers of quads from the ranks of their boundary matrices over GF(2)."""
    edges: dict[tuple[int, int], int] = {}
    vertices: dict[int, int] = {}
    faces = []
    for quad in np.asarray(cells).tolist():
        column = 0
        for a, b in zip(quad, quad[1:] + quad[:1], strict=True):
            column ^= 1 << edges.setdefault((min(a, b), max(a, b)), len(edges))
        faces.append(column)
    sides = []
    for a, b in edges:
        bits = [vertices.setdefault(v, len(vertices)) for v in (a, b)]
        sides.append((1 << bits[0]) ^ (1 << bits[1]))
    rank_1, rank_2 = gf2_rank(sides), gf2_rank(faces)
    return (
        len(vertices) - rank_1,
        len(edges) - rank_1 - rank_2,
        len(faces) - rank_2,
    )


def simplicial_betti_by_rank(simplices: list[np.ndarray]) -> list[int]:
    """Return the Betti numbers of a simplicial complex given by its k-simplices, over GF(2)."""
    index = [{tuple(sorted(row)): i for i, row in enumerate(level.tolist())} for level in simplices]
    ranks = [0]
    for k in range(1, len(simplices)):
        columns = []
        for simplex in index[k]:
            column = 0
            for face in itertools.combinations(simplex, k):
                column ^= 1 << index[k - 1][face]
            columns.append(column)
        ranks.append(gf2_rank(columns))
    ranks.append(0)
    return [len(index[k]) - ranks[k] - ranks[k + 1] for k in range(len(simplices))]


def gudhi_pairs(filtration) -> list[tuple[int, float, float]]:
    """Return all pairs (dimension, birth, death) of the filtration; essential ones die at 0.

    Pairs with equal birth and death are among them.
    """
    import gudhi

    tree = gudhi.SimplexTree()
    for k, simplices in enumerate(filtration.simplices):
        if len(simplices):
            tree.insert_batch(simplices.T.astype(np.int32), -filtration.simplex_values(k))
    pairs = tree.persistence(homology_coeff_field=2, min_persistence=-1, persistence_dim_max=True)
    return sorted((k, -birth, max(0.0, -death)) for k, (birth, death) in pairs)


def gudhi_betti(hexes) -> tuple[int, int, int]:
    """Return the Betti numbers of a hex mesh, after cutting every hex into simplices.

    A chain of faces of a hex (vertex < edge < face < hex) is a simplex of the barycentric
    subdivision, whose vertices are the distinct faces of all dimensions.
    """
    import gudhi

    faces = [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]]
    number: dict[tuple[int, ...], int] = {}
    tree = gudhi.SimplexTree()
    for hexahedron in np.asarray(hexes).tolist():
        body = number.setdefault(tuple(sorted(hexahedron)), len(number))
        for local in faces:
            corners = [hexahedron[c] for c in local]
            face = number.setdefault(tuple(sorted(corners)), len(number))
            for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
                edge = number.setdefault(tuple(sorted((a, b))), len(number))
                for point in (a, b):
                    vertex = number.setdefault((point,), len(number))
                    tree.insert([vertex, edge, face, body])
    tree.compute_persistence(persistence_dim_max=True)
    betti = [*tree.betti_numbers(), 0, 0, 0]
    return tuple(betti[:3])
