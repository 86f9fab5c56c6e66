"""Compiled passes number and count as sorting does, also on meshes that are not valid."""

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.meshes.facets import HEX_EDGES, HEX_FACETS, QUAD_FACETS, count_edges, find_facets
from tusqh.meshes.jacobians import smallest_jacobians
from tusqh.meshes.numbering import (
    count_components,
    count_components_by_parts,
    count_different_points,
    count_repeated_corners,
    count_used,
    number_rows,
)


def random_cells(rng, n_corners):
    """Return elements with few points, so that parts, corners and whole elements repeat."""
    return rng.integers(0, int(rng.integers(3, 40)), (int(rng.integers(0, 60)), n_corners))


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("local", [QUAD_FACETS, HEX_FACETS, HEX_EDGES])
def test_parts_are_numbered_as_by_sorting(seed, local):
    cells = random_cells(np.random.default_rng(seed), int(local.max()) + 1)
    rows = np.sort(cells[:, local].reshape(-1, local.shape[1]), axis=1)
    numbers, n = number_rows(cells, local)
    _, expected = np.unique(rows, axis=0, return_inverse=True) if len(rows) else (0, rows[:, 0])
    assert n == len(np.unique(expected))
    assert len(np.unique(np.stack([numbers, expected.ravel()]), axis=1).T) == n
    first = np.sort(np.unique(numbers, return_index=True)[1])
    assert np.array_equal(numbers[first], np.arange(n))


@pytest.mark.parametrize("seed", range(20))
def test_counts_equal_those_by_sorting(seed, monkeypatch):
    rng = np.random.default_rng(100 + seed)
    cells = random_cells(rng, 8)
    monkeypatch.setattr("tusqh.meshes.numbering._POINTS_AT_A_TIME", 1 + 2 * seed)
    assert count_used(cells) == len(np.unique(cells))
    assert count_repeated_corners(cells) == sum(len(set(c)) < 8 for c in cells.tolist())
    assert count_edges(cells) == len(
        {tuple(sorted(e)) for c in cells.tolist() for e in np.array(c)[HEX_EDGES].tolist()}
    )
    points = rng.integers(-1, 2, (len(cells), 3)) * 0.25
    assert count_different_points(points) == len({tuple(p) for p in points.tolist()})
    n_used = len(np.unique(cells))
    ends = (np.repeat(cells[:, 0], 8), cells.ravel())
    graph = coo_array((np.ones(cells.size), ends), shape=(40, 40))
    expected = connected_components(graph, directed=False)[0] - (40 - n_used)
    assert count_components(cells) == expected
    facets = find_facets(cells)
    members = coo_array((np.ones(len(facets.cell)), (facets.cell, facets.unique))).tocsr()
    n = connected_components(members @ members.T, directed=False)[0] if len(cells) else 0
    assert count_components_by_parts(facets.unique, 6) == n


def test_an_edge_without_length_has_no_scaled_jacobian():
    cube = np.array([[x, y, z] for z in (0.0, 1) for x, y in ((0.0, 0), (1, 0), (1, 1), (0, 1))])
    assert smallest_jacobians(cube, np.arange(8)[None]).scaled.tolist() == [1.0]
    cube[1] = cube[0]
    flat = smallest_jacobians(cube, np.arange(8)[None])
    assert flat.determinant[0] <= 0
    assert np.isnan(flat.scaled[0])
    cube[1] = 1e200, -1e200, 1e200
    assert not smallest_jacobians(cube, np.arange(8)[None]).determinant[0] > 0
