"""What a grid resolves of a surface, and what lies beyond its end, against boxes and sheets."""

import numpy as np
import pytest
import trimesh

import tusqh
from tusqh.fitting import Target, fit_mesh
from tusqh.fitting.distances import nearest_on_surface
from tusqh.fitting.left_out import NO_SURFACE
from tusqh.fitting.pieces import cut_pieces, pick_samples
from tusqh.fitting.resolved import find_beyond, find_resolved
from tusqh.grid import BackgroundGrid

CELLS = 12


def target_of(corners):
    """Return a target with all of the given triangles trusted, in cells."""
    pieces = cut_pieces(corners, np.full(3, float(CELLS)))
    points, normals, sample, _ = pick_samples(pieces)
    grid = BackgroundGrid((CELLS,) * 3, 1.0, (0.0,) * 3)
    level = np.zeros((2 * CELLS + 1,) * 3)
    return Target(grid, level, points, normals, pieces, sample, 1.0)


def box(lower, upper):
    return trimesh.creation.box(bounds=[lower, upper]).triangles


def beyond(target, places):
    return find_beyond(target, places, nearest_on_surface(target, places))


@pytest.mark.parametrize("seed", range(6))
def test_plates_and_gaps_thinner_than_a_cell_are_not_resolved(seed):
    rng = np.random.default_rng(seed)
    first, gap, second = rng.choice([0.3, 0.6, 0.9, 1.2, 2.0], 3)
    z = np.cumsum([1.0 + rng.random(), first, gap, second])
    plates = [box([1, 1, low], [11, 11, high]) for low, high in (z[:2], z[2:])]
    target = target_of(np.concatenate(plates))
    is_resolved, heights = find_resolved(target), target.points[:, 2]
    is_inside = (np.abs(target.points[:, :2] - 6) < 4).all(axis=1)
    beside = {0: (first,), 1: (first, gap), 2: (gap, second), 3: (second,)}
    for k, sizes in beside.items():
        chosen = is_inside & (np.abs(heights - z[k]) < 1e-9)
        assert chosen.sum() > 100
        # Sides of a wide wall may lie beside a thin one, which makes them unresolved, too.
        near = min(sizes) >= 1 and all(
            abs(z[k] - z[m]) > 0.5 for m, other in beside.items() if min(other) < 1
        )
        assert (is_resolved[chosen] == near).all()


@pytest.mark.parametrize("seed", range(3))
def test_nothing_lies_beyond_a_closed_surface(seed):
    rng = np.random.default_rng(seed)
    solid = trimesh.creation.box((4, 5, 6))
    solid.apply_transform(trimesh.transformations.random_rotation_matrix(rng.random(3)))
    target = target_of(solid.triangles + 6.0)
    assert not beyond(target, rng.uniform(0, 12, (3000, 3))).any()


@pytest.mark.parametrize("seed", range(3))
def test_places_beside_a_sheet_lie_beyond_it_and_those_above_do_not(seed):
    rng = np.random.default_rng(seed)
    corners = np.array([[3.0, 3, 5], [9, 3, 5], [9, 9, 5], [3, 9, 5]])
    target = target_of(np.stack([corners[[0, 1, 2]], corners[[0, 2, 3]]]))
    places = rng.uniform(1, 11, (2000, 3))
    over = np.maximum(np.abs(places[:, :2] - 6) - 3, 0)
    far = np.linalg.norm(over, axis=1)
    height = np.abs(places[:, 2] - 5)
    found = beyond(target, places)
    assert not found[far == 0].any()
    assert found[(far > 0.11) & (far > height)].all()
    assert not found[far < 0.1].any()


def test_the_closure_of_an_open_ball_is_a_row_and_does_not_count_as_a_distance():
    ball = trimesh.creation.icosphere(subdivisions=4)
    is_kept = ball.triangles_center[:, 2] < 0.75
    result = tusqh.mesh((ball.vertices, ball.faces[is_kept]), cells=16, placement="corner")
    target = Target.of(result.geometry, result.fractions)
    size = target.grid.cell_size
    fitted = fit_mesh(result.mesh, target, cell_size=size)
    rows = fitted.fell_back[fitted.fell_back["why"] == NO_SURFACE]
    assert len(rows) == 1
    assert rows["z"].iloc[0] > 0.6
    boundary = fitted.mesh.points[np.unique(fitted.mesh.facets.boundary)]
    inside = np.linalg.norm(boundary, axis=1) < 1 - 0.5 * size
    assert (boundary[inside, 2] > 0.5).all()
    assert 0.9 * inside.sum() < rows["points"].sum() < 0.1 * len(boundary) + inside.sum()
    cells = fitted.distances[fitted.distances["unit"] == "cells"].set_index(["from", "at"])
    assert cells.loc[("boundary", "vertices"), "mean"] < 0.05
    assert cells.loc[("boundary", "vertices"), "count"] == len(boundary) - rows["points"].sum()
