"""Fitting of quads: valid, the same topology, on the outline, with its corners."""

import numpy as np
import pytest
import shapely
from scipy.ndimage import gaussian_filter

import tusqh
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.fitting import fit_mesh
from tusqh.fitting.of_geometry import target_of
from tusqh.fitting.planar.outline_target import target_of_level
from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid
from tusqh.quality.overlap import measure_overlap
from tusqh.sampling.fractions import VolumeFractions


def circle(radius=1.0, centre=(0.0, 0.0), n=720):
    turns = np.linspace(0, 2 * np.pi, n + 1)
    return radius * np.stack([np.cos(turns), np.sin(turns)], axis=1) + centre


def rectangle(angle=0.0, half=(1.0, 0.6)):
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * half
    turn = [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    return corners @ turn


def fit(*chains, window=None, **settings):
    outline = Outline.from_chains(list(chains))
    result = tusqh.mesh((outline.points, outline.segments), window=window, **settings)
    target = target_of(result.geometry, result.fractions, sides=window)
    size = result.fractions.grid.cell_size
    return result, fit_mesh(result.mesh, target, cell_size=size)


def in_cells(fitted, direction, at):
    rows = fitted.distances[fitted.distances["unit"] == "cells"].set_index(["from", "at"])
    return rows.loc[(direction, at)]


def random_mesh(seed):
    """Return a mesh of random fractions, smooth or not, with its fractions."""
    rng = np.random.default_rng(seed)
    shape = tuple(int(n) for n in rng.integers(3, 16, 2))
    values = rng.random(tuple(2 * n + 1 for n in shape))
    smoothing = rng.choice([0.0, 0.7, 1.5])
    if smoothing:
        values = gaussian_filter(values, smoothing)
    values = (values - values.min()) / np.ptp(values)
    grid = BackgroundGrid(shape, float(rng.choice([1e-3, 1.0, 37.0])), (5.0, -3.0))
    fractions = VolumeFractions.from_values(grid, 4, values)
    cells = CellSets(fractions).at(float(rng.choice([0.3, 0.5, 0.6])))
    return build_mesh(cells, grid).mesh, fractions


def require_sound(fitted, mesh):
    measured = fitted.mesh.measurement
    assert measured.is_sound, measured.failed
    assert measured.by_euler == measured.by_boundary == mesh.measurement.by_euler
    assert measure_overlap(fitted.mesh) <= 1e-9


@pytest.mark.parametrize("seed", range(8))
def test_random_fields_stay_valid_with_their_topology(seed):
    mesh, fractions = random_mesh(seed)
    fitted = fit_mesh(mesh, target_of_level(fractions), cell_size=fractions.grid.cell_size)
    require_sound(fitted, mesh)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8, 1008))
def test_many_random_fields_stay_valid_with_their_topology(seed):
    test_random_fields_stay_valid_with_their_topology(seed)


@pytest.mark.parametrize("seed", range(3))
def test_a_soup_of_segments_gives_a_valid_mesh(seed):
    rng = np.random.default_rng(seed)
    ends = rng.random((40, 1, 2)) + rng.normal(size=(40, 2, 2)) * 0.15
    chains = [circle(0.3, (0.5, 0.5), 60)[:-5], *ends]
    result, fitted = fit(*chains, cells=14, threshold=0.4)
    require_sound(fitted, result.mesh)


def test_a_disk_is_round_and_finer_grids_are_nearer_by_the_square_of_the_cell():
    far = []
    for cells in (12, 24, 48):
        result, fitted = fit(circle(), cells=cells)
        require_sound(fitted, result.mesh)
        assert fitted.mesh.measurement.smallest_scaled_jacobian > 0.6
        assert len(fitted.fell_back) == 0
        # Measured without the code of the distances: by radius, in model units.
        sides = fitted.mesh.points[fitted.mesh.facets.boundary]
        far.append(np.abs(np.linalg.norm(sides.mean(axis=1), axis=1) - 1).mean())
        assert in_cells(fitted, "boundary", "vertices")["max"] < 0.03
    assert far[2] < far[1] / 2.5 < far[0] / 6


@pytest.mark.parametrize("angle", [0.0, 0.2, 0.5, 0.785, 1.1])
def test_corners_and_sides_of_a_turned_rectangle_are_sharp_and_straight(angle):
    hole = rectangle(angle + 0.3, (0.4, 0.3))[::-1]
    result, fitted = fit(rectangle(angle), hole, cells=40)
    require_sound(fitted, result.mesh)
    assert fitted.mesh.measurement.smallest_scaled_jacobian >= 0.4
    size = result.fractions.grid.cell_size
    points = fitted.mesh.points[np.unique(fitted.mesh.facets.boundary)]
    for corner in (*rectangle(angle)[:4], *hole[:4]):
        assert np.linalg.norm(points - corner, axis=1).min() < 0.1 * size
    exact = shapely.Polygon(rectangle(angle), [hole])
    quads = shapely.union_all(shapely.polygons(fitted.mesh.points[fitted.mesh.cells]))
    assert exact.symmetric_difference(quads).area < 1e-3 * exact.area
    assert exact.boundary.hausdorff_distance(quads.boundary) < 0.06 * size


def test_crossing_and_doubled_outlines_have_the_corners_of_their_union():
    first, second = rectangle(0.3, (1.0, 0.5)), rectangle(1.2, (0.9, 0.4))
    result, fitted = fit(first, second, second, cells=48, rule="clamped")
    require_sound(fitted, result.mesh)
    union = shapely.union_all([shapely.Polygon(first), shapely.Polygon(second)])
    size = result.fractions.grid.cell_size
    points = fitted.mesh.points[np.unique(fitted.mesh.facets.boundary)]
    for corner in union.exterior.coords:
        assert np.linalg.norm(points - corner, axis=1).min() < 0.1 * size


def test_sides_of_the_window_stay_exactly_straight():
    window = [[-0.55, -0.7], [0.6, 0.7]]
    result, fitted = fit(circle(), window=window, cells=[23, 28], placement="corner")
    require_sound(fitted, result.mesh)
    points = fitted.mesh.points[np.unique(fitted.mesh.facets.boundary)]
    staircase = result.mesh.points[np.unique(result.mesh.facets.boundary)]
    for axis in range(2):
        for end in range(2):
            at = staircase[:, axis].min() if end == 0 else staircase[:, axis].max()
            near = np.abs(points[:, axis] - at) < 1e-3
            assert near.sum() > 10
            assert np.ptp(points[near, axis]) == 0


def test_fixed_points_do_not_move():
    outline = Outline.from_chains([circle()])
    result = tusqh.mesh((outline.points, outline.segments), cells=16)
    target = target_of(result.geometry, result.fractions)
    fixed = result.mesh.points[:, 0] > 0
    fitted = fit_mesh(result.mesh, target, cell_size=result.fractions.grid.cell_size, fixed=fixed)
    on_boundary = np.unique(result.mesh.facets.boundary)
    held = result.mesh.points[on_boundary[fixed[on_boundary]]]
    apart = np.linalg.norm(fitted.mesh.points[:, None] - held[None], axis=2).min(axis=0)
    assert apart.max() < 1e-12
    require_sound(fitted, result.mesh)


def test_cells_that_topology_left_out_give_a_smoothed_staircase():
    # The gap is narrower than a cell: cells that were left out between the squares have no surface.
    square, apart = rectangle(0, (0.5, 0.5)), np.array([0.52, 0.0])
    outline = Outline.from_chains([square - apart, square + apart])
    arrays = (outline.points, outline.segments)
    result = tusqh.mesh(arrays, cells=22, betti=(2,), scope="local", placement="corner")
    cells = result.built.resolved.cells
    changed = cells.kept != cells.in_base
    assert changed.any()
    target = target_of(result.geometry, result.fractions, changed=changed)
    fitted = fit_mesh(result.mesh, target, cell_size=result.fractions.grid.cell_size)
    require_sound(fitted, result.mesh)
    assert "topology was changed on purpose" in set(fitted.fell_back["why"])


def test_the_same_bytes_each_time():
    first, second = (fit(rectangle(0.4), cells=20)[1].mesh.points for _ in range(2))
    assert first.tobytes() == second.tobytes()
