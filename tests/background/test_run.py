"""Geometries on backgrounds, from sampling to a sound mesh."""

import numpy as np
import pytest
import trimesh
from backgrounds import backgrounds
from test_background_fractions import as_soup, ball, star
from test_background_mesh import random_cells

from tusqh.background.improve import improve
from tusqh.background.makers import make_box, make_cylinder, make_layers
from tusqh.background.mesh import build_mesh
from tusqh.background.run import mesh_on_background
from tusqh.errors import ConfigError, MeshError, TopologyError
from tusqh.meshes.jacobians import smallest_jacobians
from tusqh.pipeline.mesh import mesh as mesh_on_grid
from tusqh.settings.goal import Goal, Target


def pipe():
    """Return a pipe with a branch that overlaps it, as overlapping closed parts."""
    run = trimesh.creation.annulus(0.55, 0.9, 4.0, sections=32)
    branch = trimesh.creation.cylinder(0.3, 1.2, sections=24)
    branch.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, [0, 1, 0]))
    branch.apply_translation([1.1, 0, 0])
    return as_soup(trimesh.util.concatenate([run, branch]))


def test_a_dirty_pipe_on_an_o_grid_has_the_requested_hole():
    background = make_cylinder((0, 0, -2.2), 1.9, 4.4, core=6, rings=6, layers=16)
    result = mesh_on_background(pipe(), background, goal=Goal(target=Target(1, 1, 0)))
    assert tuple(result.mesh.measurement.by_boundary) == (1, 1, 0)
    assert result.mesh.measurement.is_sound
    assert result.mesh.grid_cell.max() < background.n_cells


@pytest.mark.parametrize("threshold", [0.2, 0.5, 0.8])
def test_a_box_as_background_keeps_the_cells_of_the_grid(threshold):
    on_grid = mesh_on_grid(
        (ball().points, ball().triangles), cells=8, threshold=threshold, placement="corner"
    )
    grid = on_grid.fractions.grid
    box = make_box(grid.origin, grid.upper, grid.shape)
    result = mesh_on_background(ball(), box, goal=Goal(threshold=threshold))
    assert (result.cells.kept == on_grid.built.resolved.cells.kept.ravel()).all()
    assert result.mesh.measurement.by_euler == on_grid.mesh.measurement.by_euler


def test_the_threshold_is_chosen_by_volume_and_betti_numbers():
    background = make_layers((-1.3,) * 3, (1.3,) * 3, (10, 10, 12), growth=1.1)
    result = mesh_on_background(ball(), background, goal=Goal(volume="match", target=Target(1)))
    ratio = result.mesh.measurement.volume / result.fractions.volume()
    assert ratio == pytest.approx(1, abs=0.03)
    with pytest.raises(TopologyError, match="no threshold gives"):
        mesh_on_background(ball(), background, goal=Goal(target=Target(7, 5, 3)))
    with pytest.raises(ConfigError, match="persistence"):
        mesh_on_background(ball(), background, goal=Goal(persistence=0.2))
    with pytest.raises(MeshError):
        mesh_on_background(star(), background)


def test_a_star_on_a_disc():
    result = mesh_on_background(star(), make_cylinder((0, 0), 1.2, core=8, rings=6))
    assert tuple(result.mesh.measurement.by_euler) == tuple(result.cells.predicted)
    assert result.mesh.jacobians.scaled.min() > 0.2


@pytest.mark.parametrize("name", ["box", "cylinder", "triangles"])
def test_improving_untangles_elements_and_keeps_the_rim(name):
    background, rng = backgrounds()[name], np.random.default_rng(2)
    cells = random_cells(rng, background)
    while not 0.8 < cells.kept.mean() < 0.95:
        cells = random_cells(rng, background)
    mesh, is_new, on_rim = build_mesh(cells, name=name)
    corners = mesh.cells.astype(np.int64)
    before = mesh.points.copy()
    after = improve(mesh.points, corners, is_new, on_rim)
    assert (mesh.points == before).all()
    assert smallest_jacobians(after, corners).determinant.min() > 0
    if name == "box":
        low, high = background.points.min(axis=0), background.points.max(axis=0)
        on_side = (before <= low + 1e-12) | (before >= high - 1e-12)
        assert (after[on_side & on_rim[:, None]] == before[on_side & on_rim[:, None]]).all()
