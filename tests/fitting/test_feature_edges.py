"""Feature edges: creases of boxes at any rotation are captured, balls have none."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

import tusqh
from studies.methods.creased_solids import SOLIDS
from tusqh.fitting import Target, fit_mesh
from tusqh.fitting.chains import NO_EDGE, _length, find_creases, list_chains
from tusqh.fitting.features import Features, _gaps, find_features
from tusqh.fitting.patches import find_patches
from tusqh.fitting.skin import Skin
from tusqh.fitting.target import to_cells
from tusqh.sampling.nearest_triangle import find_nearest, make_tree


def turned_box(seed):
    box = trimesh.creation.box((2, 1.4, 1))
    turn = np.random.default_rng(seed).random(3)
    box.apply_transform(trimesh.transformations.random_rotation_matrix(turn))
    return box


def mesh_of(body, cells):
    result = tusqh.mesh((body.vertices, body.faces), cells=cells, placement="corner", threshold=0.5)
    return result.mesh, Target.of(result.geometry, result.fractions)


def features_of(mesh, target):
    skin = Skin.of(mesh.facets.boundary)
    places = to_cells(mesh.points[skin.vertices], target.grid)
    owned = np.ones(len(skin.facets), dtype=bool)
    return skin, find_features(target, skin, places, owned)


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_the_edges_of_a_turned_box_are_captured(seed):
    box = turned_box(seed)
    mesh, target = mesh_of(box, 16)
    fitted = fit_mesh(mesh, target, cell_size=target.grid.cell_size)
    assert fitted.mesh.jacobians.scaled.min() > 0.3
    facets = to_cells(fitted.mesh.points, target.grid)[fitted.mesh.facets.boundary]
    edges = np.stack([facets, np.roll(facets, -1, axis=1)], axis=2).reshape(-1, 2, 3)
    drawn = make_tree(edges[:, [0, 1, 1]])
    corners = to_cells(box.vertices, target.grid)
    assert find_nearest(drawn, corners).distance.max() < 0.1
    creases = corners[box.face_adjacency_edges[box.face_adjacency_angles > 0.5]]
    shares = np.linspace(0, 1, 40)[None, :, None]
    along = (creases[:, :1] * (1 - shares) + creases[:, 1:] * shares).reshape(-1, 3)
    assert (find_nearest(drawn, along).distance < 0.1).mean() >= 0.99
    cells = fitted.distances[fitted.distances["unit"] == "cells"]
    assert cells["mean"].max() < 0.03
    chains = list_chains(fitted, target)
    sides = np.linalg.norm(creases[:, 1] - creases[:, 0], axis=1)
    assert np.allclose(np.sort(chains["cells"]), np.sort(sides), rtol=0.03)
    assert (chains["captured"] * chains["cells"]).sum() >= 0.98 * sides.sum()
    assert (chains["why"] == "").eq(chains["captured"] == 1).all()
    assert len(chains[["patch_a", "patch_b"]].drop_duplicates()) == 12
    without = replace(fitted, edges=fitted.edges[:0], patch=None)
    assert (list_chains(without, target)["captured"] == 0).all()
    assert set(list_chains(without, target)["why"]) == {NO_EDGE}


@pytest.mark.parametrize("seed", range(3))
def test_the_labels_of_a_box_have_its_corners(seed):
    mesh, target = mesh_of(turned_box(seed), 14)
    assert set(find_patches(target, 35.0)) == set(range(6))
    _, found = features_of(mesh, target)
    _, features = found
    n_patches = np.bincount(features.vertex)
    assert (n_patches == 3).sum() == 8
    assert n_patches.max() == 3


def test_a_ball_has_no_features():
    ball = trimesh.creation.icosphere(subdivisions=4)
    mesh, target = mesh_of(ball, 14)
    assert features_of(mesh, target)[1] is None
    assert len(find_creases(target).places) == 0


@pytest.mark.parametrize("name", ["cylinder", "two_boxes", "bracket"])
def test_creases_of_samples_are_the_true_ones(name):
    """Also where two parts overlap, so that the crease is not an edge of the file."""
    solid = SOLIDS[name][0]().turned(5)
    result = tusqh.mesh((solid.points, solid.triangles), cells=18, threshold=0.5)
    target = Target.of(result.geometry, result.fractions)
    found = find_creases(target)
    true = to_cells(solid.creases.reshape(-1, 3), target.grid).reshape(-1, 2, 3)
    away = find_nearest(make_tree(true[:, [0, 1, 1]]), found.places).distance
    assert away.max() < 0.2
    assert away.mean() < 0.01
    lengths = np.linalg.norm(true[:, 1] - true[:, 0], axis=1)
    of_chains = [_length(found.places[found.chain == k]) for k in np.unique(found.chain)]
    assert sum(of_chains) == pytest.approx(lengths.sum(), rel=0.03)


def test_a_short_gap_between_creases_of_two_patches_is_filled():
    edges = np.array([[0, 1], [1, 2], [2, 3], [3, 4], [5, 6], [6, 7]])
    pair = np.array([[0, 1]] * 4 + [[2, 3]] * 2)
    is_crease = np.array([True, False, False, True, False, False])
    assert _gaps(edges, pair, is_crease).tolist() == [False, True, True, False, False, False]


def test_a_row_that_ends_in_no_corner_is_not_filled():
    edges = np.array([[0, 1], [1, 2], [2, 3]])
    pair = np.zeros((3, 2), dtype=int)
    is_crease = np.array([True, False, False])
    assert not _gaps(edges, pair, is_crease).any()
    other = np.array([[0, 1], [1, 2], [2, 3], [3, 4]])  # At 3 another pair of patches begins.
    pair = np.array([[0, 1], [0, 1], [0, 1], [1, 2]])
    is_crease = np.array([True, False, False, True])
    assert _gaps(other, pair, is_crease).tolist() == [False, True, True, False]


def test_vertices_are_spread_towards_the_middle_of_their_neighbours():
    edges = np.array([[0, 1], [1, 2], [2, 3], [3, 4], [4, 5]])
    vertex, patch = np.repeat(np.arange(6), 2), np.tile([0, 1], 6)
    features = Features(np.zeros(1, dtype=int), edges, vertex, patch)
    places = np.array([[0.0, 0, 0], [0.2, 0, 0], [2.0, 0, 0], [3, 0, 0], [4, 0, 0], [5, 0, 0]])
    planes = features.spread(places)
    assert planes.row.tolist() == [1, 2, 3, 4]
    assert planes.points[:, 0].tolist() == [1.0, 1.6, 3.0, 4.0]
    assert np.abs(planes.normals[:, 0]).tolist() == [1.0] * 4
    assert planes.weight[0] == planes.weight[3] > planes.weight[1] == planes.weight[2]


def test_a_fitted_mesh_says_which_facets_belong_to_which_patch():
    mesh, target = mesh_of(turned_box(0), 14)
    fitted = fit_mesh(mesh, target, cell_size=target.grid.cell_size)
    facets = fitted.mesh.facets.boundary
    assert set(fitted.patch) == set(range(6))
    corners = fitted.mesh.points[facets]
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    for patch in range(6):
        own = normals[fitted.patch == patch]
        assert (own @ own.mean(axis=0) > 0.8).mean() > 0.98
    assert np.isin(fitted.edges, facets).all()
