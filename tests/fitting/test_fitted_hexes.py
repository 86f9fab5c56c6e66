"""Fitting of hexes: valid by independent judges, the same topology, on the surface."""

import numba
import numpy as np
import pytest
import trimesh
from scipy.ndimage import gaussian_filter

import tusqh
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.fitting import Target, fit_mesh
from tusqh.fitting.crossings import find_crossings
from tusqh.fitting.left_out import LEFT_OUT
from tusqh.fitting.pillow import pillow
from tusqh.fitting.validity import find_unproven
from tusqh.geometry.image import Image
from tusqh.grid import BackgroundGrid
from tusqh.sampling.doubled_grid import combine_half_blocks
from tusqh.sampling.fractions import VolumeFractions

#: Gauss points at which determinants are computed anew.
GAUSS = np.array([0.0, 0.1127, 0.5, 0.8873, 1.0])


def random_case(seed):
    """Return a mesh of a random image of voxels, smooth or not, and its target."""
    rng = np.random.default_rng(seed)
    shape = tuple(int(n) for n in rng.integers(3, 7, 3))
    voxels = rng.random(tuple(2 * n for n in shape))
    smoothing = rng.choice([0.0, 0.7, 1.5])
    if smoothing:
        voxels = gaussian_filter(voxels, smoothing)
    voxels = (voxels - voxels.min()) / np.ptp(voxels)
    grid = BackgroundGrid(shape, float(rng.choice([1e-3, 1.0, 37.0])), (5.0, -3.0, 0.0))
    fractions = VolumeFractions(grid, 4, combine_half_blocks(voxels))
    mesh = build_mesh(CellSets(fractions).at(0.5), grid).mesh
    return mesh, Target.of(Image(voxels), fractions)


def random_soup(seed):
    """Return a mesh of random triangles, and its target; None if nothing is inside."""
    rng = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=1)
    points = ball.vertices * rng.uniform(0.5, 1.0, 3) + rng.normal(0, 0.1, ball.vertices.shape)
    triangles = ball.faces[rng.random(len(ball.faces)) < 0.85]
    extra = rng.integers(0, len(points), (4, 3))
    soup = points, np.concatenate([triangles, extra[(np.diff(np.sort(extra)) > 0).all(axis=1)]])
    result = tusqh.mesh(soup, cells=int(rng.integers(5, 9)), placement="corner", threshold=0.5)
    return result.mesh, Target.of(result.geometry, result.fractions)


def determinants(mesh):
    """Return the least determinant of every hex at many places, by numpy alone."""
    signs = np.array([[i, j, k] for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))])
    corners = mesh.points[mesh.cells]
    least = np.full(len(corners), np.inf)
    for place in np.stack(np.meshgrid(GAUSS, GAUSS, GAUSS), axis=-1).reshape(-1, 3):
        shares = np.where(signs == 1, place, 1 - place)
        slopes = np.stack(
            [(2 * signs[:, a] - 1) * np.delete(shares, a, axis=1).prod(axis=1) for a in range(3)]
        )
        least = np.minimum(least, np.linalg.det(np.einsum("ac,mck->mak", slopes, corners)))
    return least


def crossing_by_pymeshlab(mesh):
    pymeshlab = pytest.importorskip("pymeshlab")
    facets = mesh.facets.boundary
    triangles = np.concatenate([facets[:, [0, 1, 2]], facets[:, [0, 2, 3]]])
    used, local = np.unique(triangles, return_inverse=True)
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(mesh.points[used], local.reshape(-1, 3)))
    meshes.compute_selection_by_self_intersections_per_face()
    return meshes.current_mesh().selected_face_number()


def require_sound(fitted, mesh):
    """Require a valid mesh with the topology of the one before."""
    new = fitted.mesh
    assert (determinants(new) > 0).all()
    assert not find_unproven(new.points, new.cells).any()
    size = new.points[new.cells[0]].max() - new.points[new.cells[0]].min()
    assert not find_crossings(new.points / size, new.facets.boundary).any()
    found = new.measurement
    assert found.by_euler == found.by_boundary == mesh.measurement.by_euler
    assert (new.cells[: mesh.n_cells] == mesh.cells).all()
    assert len(new.kind) == len(new.grid_cell) == new.n_cells


def in_cells(fitted, direction, at):
    rows = fitted.distances[fitted.distances["unit"] == "cells"].set_index(["from", "at"])
    return rows.loc[(direction, at)]


def fit_ball(cells, **settings):
    ball = trimesh.creation.icosphere(subdivisions=5)
    result = tusqh.mesh(
        (ball.vertices, ball.faces), cells=cells, placement="corner", threshold=0.5, **settings
    )
    target = Target.of(result.geometry, result.fractions, sides=settings.get("window"))
    return result, fit_mesh(result.mesh, target, cell_size=result.fractions.grid.cell_size)


@pytest.mark.parametrize("seed", range(4))
def test_random_fields_stay_valid_and_keep_their_topology(seed):
    mesh, target = random_case(seed)
    fitted = fit_mesh(mesh, target, cell_size=target.grid.cell_size)
    require_sound(fitted, mesh)
    assert crossing_by_pymeshlab(fitted.mesh) == 0


@pytest.mark.slow
@pytest.mark.parametrize("block", range(20))
def test_a_thousand_random_fields_stay_valid_and_keep_their_topology(block):
    for seed in range(50 * block, 50 * block + 50):
        mesh, target = random_case(seed)
        require_sound(fit_mesh(mesh, target, cell_size=target.grid.cell_size), mesh)


@pytest.mark.parametrize("seed", range(2))
def test_random_soups_stay_valid_and_keep_their_topology(seed):
    mesh, target = random_soup(seed)
    require_sound(fit_mesh(mesh, target, cell_size=target.grid.cell_size), mesh)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(10))
def test_two_hundred_random_soups_stay_valid_and_keep_their_topology(block):
    for seed in range(100 + 20 * block, 120 + 20 * block):
        mesh, target = random_soup(seed)
        require_sound(fit_mesh(mesh, target, cell_size=target.grid.cell_size), mesh)


def test_the_distance_to_a_ball_falls_with_the_square_of_the_cell_size():
    radii = []
    for cells in (10, 20):
        result, fitted = fit_ball(cells)
        require_sound(fitted, result.mesh)
        assert fitted.mesh.jacobians.scaled.min() > 0.45
        assert len(fitted.fell_back) == 0
        on_boundary = fitted.mesh.points[np.unique(fitted.mesh.facets.boundary)]
        radii.append(np.abs(np.linalg.norm(on_boundary, axis=1) - 1).mean())
        assert radii[-1] / result.fractions.grid.cell_size == pytest.approx(
            in_cells(fitted, "boundary", "vertices")["mean"], abs=5e-3
        )
        for at in ("vertices", "faces"):
            assert in_cells(fitted, "boundary", at)["mean"] < 0.05
    assert radii[0] / radii[1] > 3


def fit_with_threads(mesh, target):
    """Return the points and distances of a fit with one thread and with all."""
    before, found = numba.get_num_threads(), []
    try:
        for n in (1, before):
            numba.set_num_threads(n)
            fitted = fit_mesh(mesh, target, cell_size=target.grid.cell_size)
            found.append((fitted.mesh.points.tobytes(), fitted.distances.to_csv()))
    finally:
        numba.set_num_threads(before)
    return found


def test_the_number_of_threads_changes_nothing(monkeypatch):
    monkeypatch.setattr("tusqh.fitting.moving._FEW", 0)  # Small meshes use one thread otherwise.
    one, all_of_them = fit_with_threads(*random_case(3))
    assert one == all_of_them


@pytest.mark.slow
@pytest.mark.parametrize(
    ("source", "cells"),
    [
        ("data_sources/solids/torus.stl", 32),
        ("package:pymeshlab/tests/sample_meshes/bunny.obj", 48),
    ],
)
def test_the_number_of_threads_changes_nothing_on_default_models(source, cells, repository):
    path = source if source.startswith("package:") else repository / source
    result = tusqh.mesh(path, cells=cells, placement="corner", threshold=0.5)
    target = Target.of(result.geometry, result.fractions)
    one, all_of_them = fit_with_threads(result.mesh, target)
    assert one == all_of_them


def test_the_sides_of_a_window_stay_plane():
    window = [[-1.0, -1.0, -1.0], [1.0, 1.0, 0.25]]
    result, fitted = fit_ball(12, window=window)
    require_sound(fitted, result.mesh)
    top = np.unique(fitted.mesh.facets.boundary)
    at_top = fitted.mesh.points[top][fitted.mesh.points[top][:, 2] == 0.25]
    assert len(at_top) > 50
    assert (fitted.mesh.points[:, 2] <= 0.25).all()
    radii = np.sort(np.hypot(at_top[:, 0], at_top[:, 1]))[-20:]
    assert radii == pytest.approx(np.sqrt(1 - 0.25**2), abs=0.05)


def test_facets_beside_changed_cells_do_not_snap():
    result, _ = fit_ball(12)
    changed = np.zeros(result.fractions.grid.shape, dtype=bool)
    changed[:6] = True
    target = Target.of(result.geometry, result.fractions, changed=changed)
    fitted = fit_mesh(result.mesh, target, cell_size=result.fractions.grid.cell_size)
    require_sound(fitted, result.mesh)
    boundary = np.unique(fitted.mesh.facets.boundary)
    places = fitted.mesh.points[boundary]
    away = np.abs(np.linalg.norm(places, axis=1) - 1)
    size = result.fractions.grid.cell_size
    assert away[places[:, 0] > 2 * size].mean() < 0.05 * size
    assert away[places[:, 0] < -2 * size].mean() > 0.05 * size


def test_fixed_points_do_not_move():
    mesh, target = random_case(5)
    fixed = np.zeros(len(mesh.points), dtype=bool)
    fixed[np.unique(mesh.facets.boundary)[::3]] = True
    fitted = fit_mesh(mesh, target, cell_size=target.grid.cell_size, fixed=fixed)
    boundary = fitted.mesh.points[np.unique(fitted.mesh.facets.boundary)]
    left = {tuple(p) for p in np.round(boundary / target.grid.cell_size, 6)}
    wanted = {tuple(p) for p in np.round(mesh.points[fixed] / target.grid.cell_size, 6)}
    assert wanted <= left


def test_other_programs_accept_a_fitted_mesh():
    pytest.importorskip("pyvista")
    _, fitted = fit_ball(10)
    quality = fitted.mesh.to_pyvista().cell_quality("scaled_jacobian")["scaled_jacobian"]
    assert quality.min() == pytest.approx(fitted.mesh.jacobians.scaled.min(), abs=1e-6)
    assert quality.min() > 0.45
    assert fitted.mesh.to_mfem().CheckElementOrientation(False) == 0
    assert crossing_by_pymeshlab(fitted.mesh) == 0


@pytest.mark.parametrize("seed", range(3))
def test_proven_hexes_have_positive_determinants_everywhere(seed):
    rng = np.random.default_rng(seed)
    cube = np.array([[i, j, k] for k in (0.0, 1) for i, j in ((0.0, 0), (1, 0), (1, 1), (0, 1))])
    points = (cube + rng.uniform(-0.45, 0.45, (400, 8, 3))).reshape(-1, 3)
    mesh = tusqh.meshes.volume_mesh.VolumeMesh.from_arrays(points, np.arange(3200).reshape(-1, 8))
    is_unproven = find_unproven(mesh.points, mesh.cells)
    least = determinants(mesh)
    assert (least[~is_unproven] > 0).all()
    assert is_unproven[least <= 0].all()
    assert 20 < is_unproven.sum() < 380
    assert (least[is_unproven] < 0.05).all()


@pytest.mark.parametrize("seed", range(3))
def test_crossings_are_those_of_pymeshlab(seed):
    rng = np.random.default_rng(seed)
    mesh, _ = random_case(seed)
    moved = mesh.points + rng.normal(0, 0.2 * np.ptp(mesh.points) / 20, mesh.points.shape)
    broken = type(mesh).from_arrays(moved, mesh.cells)
    scale = np.ptp(mesh.points) / 10
    found = find_crossings(moved / scale, broken.facets.boundary)
    assert found.any() == (crossing_by_pymeshlab(broken) > 0)


def test_the_layer_covers_every_facet_once():
    mesh, _ = random_case(2)
    pillowed = pillow(mesh)
    new = type(mesh).from_arrays(pillowed.points, pillowed.cells)
    assert new.n_cells == mesh.n_cells + len(mesh.facets.boundary)
    outer = {tuple(sorted(f)) for f in new.facets.boundary.tolist()}
    assert outer == {tuple(sorted(f)) for f in pillowed.facets.tolist()}


def test_walls_closer_than_a_cell_are_a_row():
    parts = [trimesh.creation.box((2, 2, 0.5)) for _ in range(2)]
    for part, height in zip(parts, (0.27, -0.27), strict=True):
        part.apply_translation([0, 0, height])
    both = trimesh.util.concatenate(parts)
    result = tusqh.mesh((both.vertices, both.faces), cells=12, placement="corner", threshold=0.5)
    target = Target.of(result.geometry, result.fractions)
    fitted = fit_mesh(result.mesh, target, cell_size=target.grid.cell_size)
    require_sound(fitted, result.mesh)
    rows = fitted.fell_back[fitted.fell_back["what"] == LEFT_OUT]
    assert len(rows) == 1
    assert rows[["x", "y", "z"]].to_numpy() == pytest.approx(np.zeros((1, 3)), abs=1e-6)
    assert rows["points"].sum() == 0
