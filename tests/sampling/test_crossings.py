"""Counting crossings against libigl's sum of solid angles, on clean and on dirty soups."""

import igl
import numpy as np
import pytest
import trimesh

from tusqh.errors import SamplingError
from tusqh.geometry.files import locate, read_geometry
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid
from tusqh.sampling import crossings
from tusqh.sampling.crossings import close_soup, wind_on_lattice
from tusqh.sampling.fractions import sample_fractions
from tusqh.sampling.layout import lay_grid


def soup_of(mesh, name="soup"):
    faces = np.asarray(mesh.faces, dtype=np.int64)
    return Soup(np.asarray(mesh.vertices), faces, np.zeros(len(faces), dtype=np.int64), name)


def lattice_over(soup, n):
    low, high = map(np.array, soup.bounding_box())
    size = (high - low).max() * 1.2 / n
    middle = (low + high) / 2
    return [m + size * (np.arange(n) - n / 2 + 0.5) for m in middle]


def compare(soup, n=14, tolerance=1e-12):
    axes = lattice_over(soup, n)
    winding = wind_on_lattice(soup, axes)
    queries = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    exact = igl.winding_number(soup.points, soup.triangles, queries).reshape(winding.shape)
    assert np.abs(winding - exact).max() < tolerance
    return winding


@pytest.fixture(scope="module")
def bunny():
    return read_geometry(locate("package:pymeshlab/tests/sample_meshes/bunny.obj"))


def test_the_bunny_is_closed_and_its_winding_number_an_integer(bunny):
    axes = lattice_over(bunny, 12)
    winding = wind_on_lattice(bunny, axes)
    assert set(np.unique(winding)) == {0.0, 1.0}
    queries = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    exact = igl.winding_number(bunny.points, bunny.triangles, queries).reshape(winding.shape)
    assert np.array_equal(winding, exact.round())


def test_a_bunny_without_a_tenth_of_its_triangles(bunny):
    rng = np.random.default_rng(0)
    left = rng.random(len(bunny.triangles)) > 0.1
    holed = Soup(bunny.points, bunny.triangles[left], bunny.parts[left])
    assert len(close_soup(holed)[1].corners) > 1000
    compare(holed, n=6)


@pytest.mark.parametrize("seed", range(12))
def test_random_soups_with_every_kind_of_dirt(seed):
    rng = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=2)
    faces = np.asarray(ball.faces)
    faces = faces[rng.random(len(faces)) > 0.15]  # Holes.
    flipped = rng.random(len(faces)) < 0.1
    faces[flipped] = faces[flipped][:, ::-1]
    faces = np.concatenate([faces, faces[rng.random(len(faces)) < 0.1], faces[:3, [0, 0, 1]]])
    points = np.asarray(ball.vertices) + rng.normal(0, 0.05, ball.vertices.shape)
    other = points * rng.uniform(0.3, 1.0, 3) + rng.normal(0, 0.4, 3)
    soup = Soup(
        np.concatenate([points, other]),
        np.concatenate([faces, np.asarray(ball.faces) + len(points)]),
        np.zeros(len(faces) + len(ball.faces), dtype=np.int64),
    )
    compare(soup)


def test_samples_on_faces_edges_and_corners_agree_along_each_line():
    """A box whose faces the lattice hits exactly: every line enters as often as it leaves."""
    box = trimesh.creation.box(extents=(2.0, 2.0, 2.0))
    axes = [np.linspace(-2.0, 2.0, 9)] * 3
    winding = wind_on_lattice(soup_of(box), axes)
    assert set(np.unique(winding)) == {0.0, 1.0}
    inside = winding[3:6, 3:6, 3:6]
    assert (inside == 1).all()
    assert winding[0].sum() == winding[-1].sum() == winding[:, :, 0].sum() == 0
    # One half of the boundary belongs to the box: as many samples as its volume has.
    assert winding.sum() == 4**3


def test_a_large_cap_falls_back_to_the_tree(monkeypatch):
    monkeypatch.setattr(crossings, "EXACT_ANGLES", 0)
    ball = trimesh.creation.icosphere(subdivisions=2)
    faces = np.asarray(ball.faces)[20:]
    compare(Soup(np.asarray(ball.vertices), faces, np.zeros(len(faces), int)), tolerance=0.02)


@pytest.mark.parametrize(("scale", "shift"), [(1e-9, 0.0), (1e9, 0.0), (1.0, 1e7), (1e-3, 1e4)])
def test_size_and_place_of_a_model_lose_no_precision(scale, shift):
    ball = trimesh.creation.icosphere(subdivisions=3)
    reference = soup_of(ball)
    expected = sample_fractions(reference, lay_grid(reference, None, cells=10))
    # A power of two keeps every coordinate exact, so that every bit of the result must agree.
    scale, shift = 2.0 ** np.round(np.log2(scale)), np.round(shift)
    points = reference.points * scale
    if shift:
        points = np.round(points * 2**20) / 2**20 + shift if scale == 1 else points + shift
    moved = Soup(points, reference.triangles, reference.parts)
    found = sample_fractions(moved, lay_grid(moved, None, cells=10))
    assert np.abs(found.values - expected.values).max() <= (0.0 if not shift else 1 / 32)
    assert found.volume() / scale**3 == pytest.approx(expected.volume(), rel=2e-3)


def test_fractions_of_solids_with_known_volumes(repository):
    for name, volume in [
        ("torus", 2 * np.pi**2 * 10 * 9),
        ("hollow_sphere", 4 / 3 * np.pi * (10**3 - 6**3)),
        ("nested_spheres", 4 / 3 * np.pi * (10**3 - 6**3 + 3**3)),
    ]:
        soup = read_geometry(repository / f"data_sources/solids/{name}.stl")
        fractions = sample_fractions(soup, lay_grid(soup, None, cells=40))
        assert fractions.volume() == pytest.approx(volume, rel=0.01)


def test_inside_out_is_turned_and_double_sided_sheets_are_refused():
    ball = trimesh.creation.icosphere(subdivisions=2)
    outward = soup_of(ball)
    inward = Soup(outward.points, outward.triangles[:, ::-1], outward.parts)
    grid = lay_grid(outward, None, cells=8)
    assert np.array_equal(
        sample_fractions(inward, grid).values, sample_fractions(outward, grid).values
    )
    both = Soup(
        outward.points,
        np.concatenate([outward.triangles, inward.triangles]),
        np.concatenate([outward.parts, inward.parts]),
        name="double_sided_sheet",
    )
    with pytest.raises(SamplingError, match=r"double_sided_sheet: .*no inside"):
        sample_fractions(both, grid)


@pytest.mark.parametrize("slab", [1_000, 10_000_000])
def test_slabs_do_not_change_the_result(monkeypatch, slab):
    monkeypatch.setitem(sample_fractions.__globals__["_SLAB"], 3, slab)
    ball = soup_of(trimesh.creation.icosphere(subdivisions=2))
    faces = ball.triangles[5:]
    opened = Soup(ball.points, faces, ball.parts[5:])
    grid = lay_grid(opened, None, cells=9)
    values = sample_fractions(opened, grid, rule="clamped").values
    monkeypatch.undo()
    assert np.array_equal(values, sample_fractions(opened, grid, rule="clamped").values)


def test_a_flat_geometry_is_refused_and_a_single_triangle_has_no_volume():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    flat = Soup(points, np.array([[0, 1, 2], [1, 3, 2]]), np.zeros(2, dtype=np.int64), "flat")
    with pytest.raises(SamplingError, match="zero extent along an axis"):
        lay_grid(flat, None, cells=8)
    points[1, 2] = 1.0
    tilted = Soup(points, flat.triangles[:1], np.zeros(1, dtype=np.int64))
    fractions = sample_fractions(tilted, lay_grid(tilted, None, cells=8))
    assert np.abs(fractions.cells).max() < 1  # Works: open, so fractions of a winding number.


def test_a_grid_too_large_for_memory_is_refused_beforehand():
    ball = soup_of(trimesh.creation.icosphere(subdivisions=1), name="ball")
    with pytest.raises(SamplingError, match=r"needs about .* GB") as caught:
        sample_fractions(ball, lay_grid(ball, None, cells=20_000))
    assert "grid.cell_size" in str(caught.value)
    with pytest.raises(SamplingError, match="3 numbers, one for each axis"):
        lay_grid(ball, None, cells=[4, 5])


def test_a_window_in_space_cuts_the_model():
    ball = soup_of(trimesh.creation.icosphere(subdivisions=3))
    window = ((-1.0, -1.0, 0.0), (1.0, 1.0, 1.0))
    grid = BackgroundGrid.over_box(*window, cells=16)
    half = sample_fractions(ball, grid, window=window)
    whole = sample_fractions(ball, lay_grid(ball, None, cells=16))
    assert half.volume() == pytest.approx(whole.volume() / 2, rel=0.02)
