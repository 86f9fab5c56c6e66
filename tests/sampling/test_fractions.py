import igl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tusqh.errors import SamplingError
from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid
from tusqh.sampling import half_blocks
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.fractions import sample_fractions
from tusqh.sampling.io import load_fractions, save_fractions
from tusqh.settings.sampling import Sampling

GRID = BackgroundGrid(shape=(4, 3), cell_size=0.5, origin=(-0.5, -0.25))


def loop(points):
    return np.array([*points, points[0]], dtype=float)


def random_outline(rng, n_chains=3):
    # Every outline winds positively somewhere: its last chain is a counter-clockwise square.
    chains = [rng.uniform(-0.5, 1.5, (rng.integers(3, 6), 2)) for _ in range(n_chains)]
    chains = [loop(c) if rng.random() < 0.5 else c for c in chains]
    big = loop([[-0.4, -0.2], [1.4, -0.2], [1.4, 1.2], [-0.4, 1.2]])
    return Outline.from_chains([*chains, big, big, big])


def brute_force_fraction(outline, grid, samples, doubled):
    """Return the mean over the fictitious cell centred at a primal cell, as in the paper."""
    half = samples // 2
    total = 0.0
    offsets = (np.arange(samples) - half + 0.5) / samples
    for dx in offsets:
        for dy in offsets:
            place = np.array([doubled[0] / 2 + dx, doubled[1] / 2 + dy])
            if ((place < 0) | (place > grid.shape)).any():
                continue  # Nothing outside the grid counts.
            query = grid.to_points(place[None])
            total += igl.winding_number(outline.points, outline.segments, query)[0]
    return total / samples**2


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), samples=st.sampled_from([2, 4, 6]))
def test_every_fraction_is_the_mean_over_its_fictitious_cell(seed, samples):
    rng = np.random.default_rng(seed)
    outline = random_outline(rng)
    fractions = sample_fractions(
        outline, GRID, sampling=Sampling(samples=samples, orientation="as-is")
    )
    for _ in range(6):
        doubled = tuple(rng.integers(0, 2 * np.array(GRID.shape) + 1))
        expected = brute_force_fraction(outline, GRID, samples, doubled)
        assert fractions.values[doubled] == pytest.approx(expected, abs=RESOLUTION)


def test_fractions_are_multiples_of_the_resolution_and_views_are_right(square):
    fractions = sample_fractions(square, GRID)
    assert np.array_equal(fractions.values / RESOLUTION, np.rint(fractions.values / RESOLUTION))
    assert fractions.values.shape == (9, 7)
    assert fractions.cells.shape == (4, 3)
    assert fractions.vertices.shape == (5, 4)
    # The square's side x in [0, 1] covers cell columns 1 and 2; y in [0, 1] half of rows 0 and 2.
    assert fractions.cells[1].tolist() == [0.5, 1.0, 0.5]
    assert fractions.cells[0].tolist() == [0.0, 0.0, 0.0]
    assert fractions.volume() == 1.0


def test_clockwise_outlines_are_flipped_unless_told_otherwise():
    clockwise = Outline.from_chains([loop([[0, 0], [0, 1], [1, 1], [1, 0]])])
    assert sample_fractions(clockwise, GRID).cells.max() == 1.0
    assert (
        sample_fractions(clockwise, GRID, sampling=Sampling(orientation="flip")).cells.max() == 1.0
    )
    with pytest.raises(SamplingError, match="positive fraction"):
        sample_fractions(clockwise, GRID, sampling=Sampling(orientation="as-is"))


def test_the_outside_is_one_minus_the_inside_within_the_window(square):
    inside = sample_fractions(square, GRID)
    outside = sample_fractions(square, GRID, sampling=Sampling(domain="outside"))
    assert np.array_equal(outside.cells, 1 - inside.cells)
    window = ((0.0, -0.25), (1.5, 1.25))
    windowed = sample_fractions(square, GRID, sampling=Sampling(domain="outside"), window=window)
    assert np.array_equal(windowed.cells[1:], outside.cells[1:])
    assert (windowed.cells[0] == 0).all()


def test_overlaps_wind_twice_and_clamping_caps_them(square):
    twice = Outline.from_chains([square.points, square.points])
    assert sample_fractions(twice, GRID).cells.max() == 2.0
    clamped = sample_fractions(twice, GRID, sampling=Sampling(rule="clamped"))
    assert np.array_equal(clamped.values, sample_fractions(square, GRID).values)


def test_far_from_the_origin_nothing_changes(square):
    shift = np.array([4.0e6, -3.0e6])
    far = Outline.from_chains([square.points + shift])
    grid = BackgroundGrid(GRID.shape, GRID.cell_size, tuple(np.add(GRID.origin, shift)))
    assert np.array_equal(sample_fractions(far, grid).values, sample_fractions(square, GRID).values)


@pytest.mark.parametrize("samples", [0, 1, 3, -2, 2.0, True])
def test_samples_must_be_even_and_positive(square, samples):
    with pytest.raises(SamplingError, match="even"):
        sample_fractions(square, GRID, sampling=Sampling(samples=samples))


def test_double_sided_sheets_have_no_inside(square):
    both = Outline.from_chains([square.points, square.points[::-1]], name="sheet.svg")
    with pytest.raises(SamplingError, match=r"sheet\.svg: the winding number is zero everywhere"):
        sample_fractions(both, GRID)


def test_a_window_or_grid_that_misses_the_geometry_is_named(square):
    with pytest.raises(SamplingError, match=r"the window .* misses the geometry"):
        sample_fractions(square, GRID, window=((5.0, 5.0), (6.0, 6.0)))
    far = BackgroundGrid(shape=(2, 2), cell_size=1.0, origin=(50.0, 0.0))
    with pytest.raises(SamplingError, match=r"the background grid .* misses"):
        sample_fractions(square, far)


def test_fractions_survive_the_disk_bit_for_bit(square, tmp_path):
    fractions = sample_fractions(Outline.from_chains([square.points[:-1]]), GRID)
    path = tmp_path / "fractions.npz"
    save_fractions(path, fractions)
    again = load_fractions(path)
    assert again.grid == fractions.grid
    assert np.array_equal(again.values, fractions.values)
    first = path.read_bytes()
    save_fractions(path, fractions)
    assert path.read_bytes() == first
    path.write_bytes(first[:50])
    with pytest.raises(SamplingError, match="cannot be read"):
        load_fractions(path)


def test_progress_is_reported_to_the_end(square, monkeypatch):
    monkeypatch.setattr(half_blocks, "SAMPLES_AT_A_TIME", 1)
    calls = []
    grid = BackgroundGrid.over_box((0.0, 0.0), (1.0, 1.0), cells=100)
    sample_fractions(square, grid, progress=lambda done, total: calls.append((done, total)))
    assert len(calls) > 1
    assert calls[-1] == (160_000, 160_000)


def test_the_sampler_libigl_agrees(square):
    outline = random_outline(np.random.default_rng(3))
    ours = sample_fractions(outline, GRID).values
    theirs = sample_fractions(outline, GRID, sampling=Sampling(sampler="libigl")).values
    assert np.abs(ours - theirs).max() < 2e-6
    assert np.array_equal(
        sample_fractions(square, GRID).values,
        sample_fractions(square, GRID, sampling=Sampling(sampler="libigl")).values,
    )


@pytest.mark.parametrize("tolerance", [0.0, -1e-6, 0.5, float("nan")])
def test_tolerances_that_nothing_can_keep_are_refused(square, tolerance):
    with pytest.raises(SamplingError, match=r"from 1e-12 to 0\.01"):
        sample_fractions(square, GRID, sampling=Sampling(tolerance=tolerance))
