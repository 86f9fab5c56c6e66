"""Fractions of solids: known volumes, orientation, windows, slabs, bad grids."""

import numpy as np
import pytest
import trimesh

from tusqh.errors import SamplingError
from tusqh.geometry.packaged import locate
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid
from tusqh.readers.files import read_file
from tusqh.sampling import half_blocks
from tusqh.sampling.fractions import sample_fractions
from tusqh.sampling.layout import lay_grid
from tusqh.settings.sampling import Sampling


def soup_of(mesh, name="soup"):
    faces = np.asarray(mesh.faces, dtype=np.int64)
    return Soup(np.asarray(mesh.vertices), faces, np.zeros(len(faces), dtype=np.int64), name)


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
        soup = read_file(repository / f"data_sources/solids/{name}.stl").geometry
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


@pytest.mark.parametrize("rule", ["average", "clamped"])
def test_slabs_do_not_change_the_result(monkeypatch, rule):
    ball = soup_of(trimesh.creation.icosphere(subdivisions=2))
    grid = lay_grid(ball, None, cells=20)
    whole = sample_fractions(ball, grid, sampling=Sampling(rule=rule))
    monkeypatch.setattr(half_blocks, "SAMPLES_AT_A_TIME", 1)
    assert np.array_equal(
        whole.multiples, sample_fractions(ball, grid, sampling=Sampling(rule=rule)).multiples
    )
    opened = Soup(ball.points, ball.triangles[5:], ball.parts[5:])
    by_slabs = sample_fractions(opened, grid, sampling=Sampling(rule=rule))
    monkeypatch.undo()
    difference = (
        by_slabs.values - sample_fractions(opened, grid, sampling=Sampling(rule=rule)).values
    )
    assert np.abs(difference).max() < 2e-6


@pytest.mark.parametrize(
    ("domain", "orientation"),
    [(d, o) for d in ("inside", "outside") for o in ("auto", "as-is")] + [("outside", "flip")],
)
def test_clamping_changes_nothing_where_nothing_overlaps(domain, orientation):
    """Runs of samples give the same result as every sample evaluated separately."""
    soup = soup_of(trimesh.creation.icosphere(subdivisions=3))
    window = ((-0.7, -1.0, -0.9), (0.93, 0.8, 1.0))
    grid = BackgroundGrid.over_box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0), cells=9)
    if orientation == "flip":
        domain, soup = "outside", Soup(soup.points, soup.triangles[:, ::-1], soup.parts)
    by_runs, by_samples = (
        sample_fractions(
            soup,
            grid,
            window=window,
            sampling=Sampling(domain=domain, orientation=orientation, rule=rule),
        )
        for rule in ("average", "clamped")
    )
    assert np.array_equal(by_runs.values, by_samples.values)


def test_libigl_gives_the_same_to_its_precision():
    soup = read_file(locate("package:pyvista/examples/airplane.ply")).geometry
    grid = lay_grid(soup, None, cells=24)
    ours = sample_fractions(soup, grid)
    theirs = sample_fractions(soup, grid, sampling=Sampling(sampler="libigl"))
    assert np.abs(ours.values - theirs.values).max() < 0.02


def test_a_flat_geometry_is_refused_and_a_single_triangle_has_no_volume():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    flat = Soup(points, np.array([[0, 1, 2], [1, 3, 2]]), np.zeros(2, dtype=np.int64), "flat")
    with pytest.raises(SamplingError, match="zero extent along an axis"):
        lay_grid(flat, None, cells=8)
    points[1, 2] = 1.0
    tilted = Soup(points, flat.triangles[:1], np.zeros(1, dtype=np.int64))
    fractions = sample_fractions(tilted, lay_grid(tilted, None, cells=8))
    assert np.abs(fractions.cells).max() < 1  # Sampling works; the surface is open.


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


def test_a_fine_grid_of_a_solid_has_its_volume(repository):
    soup = read_file(repository / "data_sources/solids/torus.stl").geometry
    fractions = sample_fractions(soup, lay_grid(soup, None, cells=128))
    corners = soup.points[soup.triangles]
    exact = np.einsum("mi,mi->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert fractions.volume() == pytest.approx(exact, rel=1e-3)


def test_opposite_windings_of_equal_volume_are_not_nothing():
    ball = trimesh.creation.icosphere(subdivisions=2)
    other = ball.copy()
    other.apply_translation([3.0, 0, 0])
    other.invert()
    both = soup_of(trimesh.util.concatenate([ball, other]))
    cells = sample_fractions(both, lay_grid(both, None, cells=20)).cells
    assert cells.max() == 1.0
    assert cells.min() == -1.0
