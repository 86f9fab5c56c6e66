"""Runs of samples against single samples: the same half-block means."""

import igl
import numba
import numpy as np
import pytest
import trimesh

from tusqh.geometry.files import locate, read_geometry
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid
from tusqh.sampling import fractions as fractions_module
from tusqh.sampling.blocks import block_means
from tusqh.sampling.crossings import close_soup, wind_on_lattice
from tusqh.sampling.fractions import sample_fractions
from tusqh.sampling.layout import lay_grid


def noisy_ball(seed, share_lost=0.0):
    rng = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=2)
    points = np.asarray(ball.vertices) + rng.normal(0, 0.05, ball.vertices.shape)
    faces = np.asarray(ball.faces, dtype=np.int64)
    faces = faces[rng.random(len(faces)) >= share_lost]
    return Soup(points, faces, np.zeros(len(faces), dtype=np.int64))


def lattice(soup, n, half):
    low, high = map(np.array, soup.bounding_box())
    step = (high - low).max() * 1.1 / (n * half)
    return [m + step * (np.arange(n * half) - (n * half - 1) / 2) for m in (low + high) / 2]


def everything(axes):
    return np.zeros(3, dtype=np.int64), np.array([len(a) for a in axes])


def by_samples(soup, axes, half):
    winding = wind_on_lattice(soup, axes)
    n = winding.shape[0] // half
    return winding.reshape(n, half, n, half, n, half).mean(axis=(1, 3, 5))


@pytest.mark.parametrize("half", [1, 2, 3])
@pytest.mark.parametrize("seed", range(5))
def test_closed_soups_agree_to_the_last_bit(seed, half):
    soup = noisy_ball(seed)
    axes = lattice(soup, 10, half)
    assert np.array_equal(
        block_means(soup, axes, half, *everything(axes)), by_samples(soup, axes, half)
    )


@pytest.mark.parametrize("n", [9, 36])
def test_open_soups_agree_within_the_tolerance(n):
    """Few holes, so that much of the lattice is far from the cap and interpolated."""
    soup = noisy_ball(1)
    soup = Soup(soup.points, soup.triangles[6:], soup.parts[6:])
    assert len(close_soup(soup)[1].corners) > 0
    axes = lattice(soup, n, 2)
    means = block_means(soup, axes, 2, *everything(axes))
    assert np.abs(means - by_samples(soup, axes, 2)).max() < 1e-6


def test_the_airplane_within_the_tolerance_of_the_exact_winding_number():
    soup = read_geometry(locate("package:pyvista/examples/airplane.ply"))
    axes = lattice(soup, 24, 2)
    means = block_means(soup, axes, 2, *everything(axes))
    rng = np.random.default_rng(0)
    index = rng.integers(0, 24, (300, 3))
    offsets = list(np.ndindex(2, 2, 2))
    queries = np.stack(
        [np.stack([axes[k][2 * index[:, k] + o[k]] for k in range(3)], -1) for o in offsets], 1
    )
    exact = igl.winding_number(soup.points, soup.triangles, queries.reshape(-1, 3))
    assert np.abs(means[tuple(index.T)] - exact.reshape(300, 8).mean(axis=1)).max() < 1e-6


@pytest.mark.parametrize("share_lost", [0.0, 0.05])
def test_ranges_of_samples_count_as_if_the_others_were_zero(share_lost):
    soup = noisy_ball(3, share_lost)
    axes = lattice(soup, 8, 2)
    first, last = np.array([3, 0, 5]), np.array([13, 15, 12])
    winding = wind_on_lattice(soup, axes)
    inside = np.zeros(winding.shape, dtype=bool)
    inside[tuple(slice(f, t) for f, t in zip(first, last, strict=True))] = True
    expected = np.where(inside, winding, 0.0).reshape(8, 2, 8, 2, 8, 2).mean(axis=(1, 3, 5))
    assert np.allclose(block_means(soup, axes, 2, first, last), expected, atol=1e-12)


@pytest.mark.parametrize(
    ("domain", "orientation"),
    [(d, o) for d in ("inside", "outside") for o in ("auto", "as-is")] + [("outside", "flip")],
)
def test_fractions_are_the_same_by_both_roads(monkeypatch, domain, orientation):
    soup = noisy_ball(4)
    window = ((-0.7, -1.0, -0.9), (0.93, 0.8, 1.0))
    grid = BackgroundGrid.over_box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0), cells=9)
    how = {"window": window, "domain": domain, "orientation": orientation}
    by_runs = sample_fractions(soup, grid, **how)
    monkeypatch.setattr(fractions_module, "has_small_cap", lambda *_: False)
    assert np.array_equal(by_runs.values, sample_fractions(soup, grid, **how).values)


def test_the_number_of_threads_changes_no_bit():
    soup = noisy_ball(5, share_lost=0.02)
    axes = lattice(soup, 20, 2)
    before = numba.get_num_threads()
    try:
        results = []
        for n_threads in range(1, before + 1):
            numba.set_num_threads(n_threads)
            results.append(block_means(soup, axes, 2, *everything(axes)))
    finally:
        numba.set_num_threads(before)
    assert all(np.array_equal(result, results[0]) for result in results)


def test_a_fine_grid_of_a_solid_has_its_volume(repository):
    soup = read_geometry(repository / "data_sources/solids/torus.stl")
    fractions = sample_fractions(soup, lay_grid(soup, None, cells=128))
    corners = soup.points[soup.triangles]
    exact = np.einsum("mi,mi->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert fractions.volume() == pytest.approx(exact, rel=1e-3)
