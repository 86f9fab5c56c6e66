"""`placement: auto` is reproducible, and its volume is never worse than at the corner."""

import itertools
import json

import numpy as np
import pytest
import trimesh
from scipy import ndimage

import tusqh
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.pipeline.sample import sample
from tusqh.sampling import place
from tusqh.sampling.fractions import sample_fractions
from tusqh.sampling.io import load_fractions, save_fractions
from tusqh.sampling.layout import lay_grid
from tusqh.sampling.place import _count, move_grid, place_grid
from tusqh.sampling.placement import Placement
from tusqh.sampling.reference import find_reference
from tusqh.settings.grid import Grid, Window
from tusqh.settings.sampling import Sampling


def solid(*meshes):
    return Soup.from_parts([(np.asarray(m.vertices), np.asarray(m.faces)) for m in meshes])


def enclosure(sides, wall):
    """Return a closed box with a wall, and the volume of the wall."""
    outer = trimesh.creation.box(bounds=[[0, 0, 0], sides])
    inner = trimesh.creation.box(bounds=[[wall] * 3, np.subtract(sides, wall)])
    inner.invert()
    volume = np.prod(sides) - np.prod(np.subtract(sides, 2 * wall))
    return solid(outer, inner), volume


def kept_volume(fractions, threshold=0.5):
    return (fractions.cells >= threshold).sum() * fractions.grid.cell_size**fractions.grid.dim


def samples_in(grid, low, high):
    """Count the samples of each cell inside an axis-aligned box along each axis, independently."""
    counts = []
    for axis in range(grid.dim):
        places = np.arange(4 * grid.shape[axis]) + 0.5
        places = grid.origin[axis] + grid.cell_size / 4 * places
        inside = (places > low[axis]) & (places < high[axis])
        counts.append(inside.reshape(-1, 4).sum(axis=1))
    return np.einsum("i,j,k->ijk", *counts)


@pytest.mark.parametrize("seed", range(25))
def test_the_volume_of_random_boxes_is_never_worse_than_at_the_corner(seed):
    rng = np.random.default_rng(seed)
    sides = rng.uniform(2, 10, 3)
    cells = int(rng.integers(4, 16))
    geometry = solid(trimesh.creation.box(bounds=[[0, 0, 0], sides]))
    corner, auto = (
        sample(geometry, grid=Grid(cells=cells, placement=p)) for p in ("corner", "auto")
    )
    errors = [abs(kept_volume(f) / np.prod(sides) - 1) for f in (corner, auto)]
    assert errors[1] <= errors[0] + 1e-12
    assert errors[1] <= auto.placement.error + 1e-9
    for fractions in (corner, auto):
        counted = samples_in(fractions.grid, np.zeros(3), sides)
        assert np.array_equal(np.rint(64 * fractions.cells), counted)


@pytest.mark.parametrize("cells_of_wall", [1.45, 1.5, 2.5, 3.5])
def test_an_enclosure_whose_walls_end_within_cells_has_its_volume(cells_of_wall):
    sides, cells = (40.0, 30.0, 20.0), 40
    geometry, volume = enclosure(sides, cells_of_wall)
    corner = sample(geometry, grid=Grid(cells=cells, placement="corner"))
    auto = sample(geometry, grid=Grid(cells=cells))
    assert abs(kept_volume(corner) / volume - 1) > 0.1
    assert kept_volume(auto) == pytest.approx(volume, rel=0.05)
    assert auto.placement.is_moved
    counted = samples_in(auto.grid, [0] * 3, sides)
    counted -= samples_in(auto.grid, [cells_of_wall] * 3, np.subtract(sides, cells_of_wall))
    assert np.array_equal(np.rint(64 * auto.cells), counted)


def test_a_tie_of_many_cells_loses():
    geometry, volume = enclosure((40.0, 30.0, 20.0), 1.5)
    corner = sample(geometry, grid=Grid(cells=40, placement="corner"))
    ratios = [kept_volume(corner, t) / volume for t in (0.5, 0.501)]
    assert ratios[0] > 1.25
    assert ratios[1] < 0.75
    auto = sample(geometry, grid=Grid(cells=40))
    for threshold in (0.47, 0.5, 0.53):
        assert kept_volume(auto, threshold) == pytest.approx(volume, rel=0.05)


@pytest.mark.parametrize("rule", ["average", "clamped"])
@pytest.mark.parametrize("is_solid", [False, True])
@pytest.mark.parametrize("domain", ["inside", "outside"])
def test_one_pass_counts_what_sampling_every_placement_does(rule, is_solid, domain, monkeypatch):
    monkeypatch.setattr(place, "SAMPLES_AT_A_TIME", 1000)  # Several slabs.
    sampling = Sampling(samples=2, rule=rule, domain=domain)
    if is_solid:
        geometry = solid(
            trimesh.creation.icosphere(1, 1.0),
            trimesh.creation.icosphere(1, 1.0).apply_translation([0.7, 0.3, 0.2]),
        )
        window = ((-0.8, -1.2, -1.1), (1.6, 1.3, 1.2))
    else:
        angle = np.linspace(0, 2 * np.pi, 8)
        ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        ring[-1] = ring[0]
        geometry = Outline.from_chains([ring, 0.8 * ring + [0.7, 0.3]])
        window = ((-0.8, -1.2), (1.6, 1.3))
    grid = lay_grid(geometry, window, cells=5)
    counts = _count(geometry, grid, sampling, window, 0.3)
    for moved in itertools.product(range(2), repeat=grid.dim):
        there_in = moved if is_solid else (moved[0], 0, moved[1])
        there = move_grid(grid, window, Placement(moved, 2))
        cells = sample_fractions(geometry, there, sampling=sampling, window=window).cells
        assert counts.kept[1][there_in] == (cells >= 0.3).sum()
        assert counts.near[there_in] == ((cells > 0) & (abs(cells - 0.3) < 0.125)).sum()
        around = ndimage.maximum_filter(
            cells, footprint=ndimage.generate_binary_structure(grid.dim, 1), mode="constant"
        )
        lost = cells[around < 0.3].clip(0).sum()
        assert counts.lost[there_in] == pytest.approx(lost, rel=1e-3)


@pytest.mark.parametrize("moved", [(0, 0), (1, 0), (3, 2)])
@pytest.mark.parametrize("cells", [4, (7, 5)])
def test_a_moved_grid_covers_the_box_with_at_most_one_more_cell(moved, cells):
    outline = Outline.from_chains([np.array([[0, 0], [9.0, 0], [9, 5.3], [0, 5.3], [0, 0]])])
    box = outline.bounding_box()
    grid = lay_grid(outline, None, cells=cells)
    there = move_grid(grid, box, Placement(moved, 4))
    assert there.cell_size == grid.cell_size
    assert (np.array(there.origin) <= np.array(box[0]) + 1e-9).all()
    assert (np.array(there.upper) >= np.array(box[1]) - 1e-9).all()
    assert (np.subtract(there.shape, grid.shape) <= 1).all()
    steps = np.subtract(there.origin, grid.origin) / grid.cell_size * 4
    assert np.rint(steps).astype(int) % 4 == pytest.approx(moved)


def test_no_wall_is_given_up_for_the_volume():
    geometry, _ = enclosure((40.0, 30.0, 20.0), 0.75)
    fractions = sample(geometry, grid=Grid(cells=40))
    kept = np.pad(fractions.cells >= 0.5, 1)
    assert ndimage.label(~kept)[1] == 2


def test_the_corner_stays_where_the_volume_is_right(square):
    fractions = sample(square, grid=Grid(cells=8))
    assert fractions.grid == lay_grid(square, None, cells=8)
    assert "at the corner: volume error 0.0 %" in str(fractions.placement)


def test_a_grid_that_cannot_be_moved_says_why(square):
    image = sample(tusqh.Image(np.ones((4, 4, 4))), grid=Grid(cells=4))
    assert str(image.placement) == "at the corner: its cells are whole voxels"
    frame = Outline.from_chains([0.3 * square.points[[0, 1, 2, 3, 0]], square.points + 0.0])
    fractions = sample_fractions(frame, lay_grid(frame, None, cells=5))
    same, placement = place_grid(frame, fractions, 1.0, sampling=Sampling(domain="outside"))
    assert same is fractions.grid
    assert "without a window" in str(placement)


def test_the_volume_of_an_open_surface_hardly_depends_on_the_lattice(monkeypatch):
    ball = trimesh.creation.icosphere(subdivisions=3)
    ball.update_faces(np.arange(len(ball.faces)) > 12)
    ball, window = solid(ball), ((-0.9, -0.8, -1.0), (1.0, 0.9, 0.7))
    fractions = sample_fractions(ball, lay_grid(ball, None, cells=20))
    for settings in (Sampling(), Sampling(domain="outside")):
        volumes = []
        for n_samples in (2**23, 2**17, 2**14):  # Finer than, like, and coarser than the fractions.
            monkeypatch.setattr("tusqh.sampling.reference._SAMPLES", n_samples)
            found = find_reference(ball, fractions, sampling=settings, window=window)
            volumes.append(found.volume)
        assert volumes == pytest.approx([volumes[0]] * 3, rel=0.05)


def test_a_window_stays_the_end_of_the_material(square):
    window = Window(lower=(0.0, 0.0), upper=(0.85, 1.0))
    grids = [Grid(cell_size=0.1, placement=p) for p in ("corner", "auto")]
    corner, auto = (sample(square, grid=grid, window=window) for grid in grids)
    assert kept_volume(corner) == pytest.approx(0.9)
    assert auto.volume() == pytest.approx(0.85, rel=0.05)
    assert kept_volume(auto) == pytest.approx(0.85, rel=0.06)


def test_where_the_grid_is_is_reported_stored_and_the_same_again(tmp_path):
    geometry, _ = enclosure((12.0, 9.0, 6.0), 1.5)
    results = [tusqh.mesh((geometry.points, geometry.triangles), cells=12) for _ in range(2)]
    placement = results[0].fractions.placement
    assert results[1].fractions.placement == placement
    assert results[0].report.lines()["grid"] == str(placement)
    assert "moved by (" in str(placement)
    assert "rather than" in str(placement)
    assert results[0].report.verdict.set_index("id").loc["volume", "holds"] == "yes"
    results[0].save(tmp_path)
    for name in ("certificate", "facts"):
        stored = json.loads((tmp_path / f"{name}.json").read_text())["placement"]
        assert Placement.from_dict(stored) == placement
    save_fractions(tmp_path / "again.npz", load_fractions(tmp_path / "fractions.npz"))
    assert (tmp_path / "again.npz").read_bytes() == (tmp_path / "fractions.npz").read_bytes()
