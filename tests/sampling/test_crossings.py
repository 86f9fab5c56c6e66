"""Counting crossings and caps against libigl's sum of angles, on clean and on dirty geometry."""

import igl
import numba
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from tusqh.geometry.outline import Outline
from tusqh.geometry.packaged import locate
from tusqh.geometry.soup import Soup
from tusqh.readers.files import read_file
from tusqh.sampling.field import make_field, wind_on_lattice
from tusqh.sampling.lattice import Lattice


def soup_of(points, faces, name="soup"):
    faces = np.asarray(faces, dtype=np.int64)
    return Soup(
        np.asarray(points, dtype=np.float64), faces, np.zeros(len(faces), dtype=np.int64), name
    )


def lattice_over(geometry, n, half=1, margin=0.1):
    """Return a lattice of n half-blocks along the longest side of the box with a margin."""
    low, high = (np.array(corner) for corner in geometry.bounding_box())
    dim = len(low)
    step = (high - low).max() * (1 + 2 * margin) / (n * half)
    blocks = np.maximum(1, np.ceil((high - low) * (1 + 2 * margin) / step / half)).astype(np.int64)
    origin = (low + high) / 2 - step * (blocks * half - 1) / 2
    halves = np.full(dim, half)
    zero = np.zeros(dim, dtype=np.int64)
    parts = [origin, halves, blocks, zero, blocks * half]
    if dim == 2:
        parts = [np.insert(p, 1, f) for p, f in zip(parts, (0, 1, 1, 0, 1), strict=True)]
    return Lattice(parts[0], step, *parts[1:])


def exact(geometry, lattice):
    """Return libigl's sum over all triangles or segments, at every sample."""
    axes = [lattice.places(k) for k in range(3)]
    queries = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    if isinstance(geometry, Outline):
        origin = lattice.origin[[0, 2]]
        queries = np.ascontiguousarray(queries[:, [0, 2]] - origin)
        winding = igl.winding_number(geometry.points - origin, geometry.segments, queries)
    else:
        winding = igl.winding_number(
            geometry.points - lattice.origin, geometry.triangles, queries - lattice.origin
        )
    return winding.reshape([len(axis) for axis in axes])


def noisy_ball(seed, share_lost=0.0, share_flipped=0.0):
    rng = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=2)
    points = np.asarray(ball.vertices) + rng.normal(0, 0.05, ball.vertices.shape)
    faces = np.array(ball.faces, dtype=np.int64)
    is_flipped = rng.random(len(faces)) < share_flipped
    faces[is_flipped] = faces[is_flipped][:, ::-1]
    return soup_of(points, faces[rng.random(len(faces)) >= share_lost])


@pytest.fixture(scope="module")
def bunny():
    return read_file(locate("package:pymeshlab/tests/sample_meshes/bunny.obj")).geometry


def test_the_bunny_is_closed_and_its_winding_number_an_integer(bunny):
    lattice = lattice_over(bunny, 12)
    winding = wind_on_lattice(make_field(bunny), lattice)
    assert set(np.unique(winding)) == {0.0, 1.0}
    assert np.array_equal(winding, exact(bunny, lattice).round())


@pytest.mark.parametrize("seed", range(8))
def test_random_soups_with_every_kind_of_dirt(seed):
    rng = np.random.default_rng(seed)
    one = noisy_ball(seed, 0.15, 0.1)
    other = noisy_ball(seed + 100, 0.02)
    faces = np.concatenate(
        [
            one.triangles,
            one.triangles[rng.random(len(one.triangles)) < 0.1],
            one.triangles[:3, [0, 0, 1]],
            other.triangles + len(one.points),
        ]
    )
    moved = other.points * rng.uniform(0.3, 1.0, 3) + rng.normal(0, 0.4, 3)
    soup = soup_of(np.concatenate([one.points, moved]), faces)
    lattice = lattice_over(soup, 18)
    assert np.abs(wind_on_lattice(make_field(soup), lattice) - exact(soup, lattice)).max() < 1e-6


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("share_lost", [0.003, 0.3])
def test_the_tolerance_is_kept_far_from_the_cap_and_near(share_lost, tolerance):
    """With 144 samples along the longest side there are blocks of all sizes; compare a subset."""
    soup = noisy_ball(1, share_lost, share_lost)
    lattice = lattice_over(soup, 72, half=2)
    field = make_field(soup, tolerance=tolerance)
    means = field.sums(lattice, 0, int(lattice.n_blocks[0])) / 8
    rng = np.random.default_rng(0)
    blocks = rng.integers(0, lattice.n_blocks, (600, 3))
    offsets = np.indices((2, 2, 2)).reshape(3, -1).T
    queries = lattice.origin + lattice.step * (2 * blocks[:, None] + offsets).reshape(-1, 3)
    expected = igl.winding_number(soup.points, soup.triangles, queries).reshape(600, 8).mean(axis=1)
    assert np.abs(means[tuple(blocks.T)] - expected).max() < tolerance


def test_the_tolerance_is_kept_in_a_soup_that_fills_space():
    """The farther away, the more sheets there are, and the fewer nodes they get."""
    rng = np.random.default_rng(1)
    start, sides = rng.random((400, 1, 3)), rng.normal(size=(2, 400, 1, 3)) * 0.1
    points = np.concatenate([start, start + sides[0], start + sides[1]], axis=1).reshape(-1, 3)
    soup = soup_of(points, np.arange(1200).reshape(-1, 3))
    lattice = lattice_over(soup, 64, half=2)
    means = make_field(soup).sums(lattice, 0, int(lattice.n_blocks[0])) / 8
    blocks = np.random.default_rng(0).integers(0, lattice.n_blocks, (600, 3))
    offsets = np.indices((2, 2, 2)).reshape(3, -1).T
    queries = lattice.origin + lattice.step * (2 * blocks[:, None] + offsets).reshape(-1, 3)
    expected = igl.winding_number(soup.points, soup.triangles, queries).reshape(600, 8).mean(axis=1)
    assert np.abs(means[tuple(blocks.T)] - expected).max() < 1e-6


def test_the_airplane_within_the_tolerance_at_its_half_blocks():
    soup = read_file(locate("package:pyvista/examples/airplane.ply")).geometry
    lattice = lattice_over(soup, 24, half=2)
    means = make_field(soup).sums(lattice, 0, int(lattice.n_blocks[0])) / 8
    n = lattice.n_blocks
    winding = exact(soup, lattice).reshape(n[0], 2, n[1], 2, n[2], 2)
    assert np.abs(means - winding.mean(axis=(1, 3, 5))).max() < 1e-6


def test_samples_on_faces_edges_and_corners_agree_along_each_line():
    """If the lattice hits the faces of a box exactly, every line enters as often as it leaves."""
    box = trimesh.creation.box(extents=(2.0, 2.0, 2.0))
    ones, zero = np.ones(3, dtype=np.int64), np.zeros(3, dtype=np.int64)
    lattice = Lattice(np.full(3, -2.0), 0.5, ones, 9 * ones, zero, 9 * ones)
    winding = wind_on_lattice(make_field(soup_of(box.vertices, box.faces)), lattice)
    assert set(np.unique(winding)) == {0.0, 1.0}
    assert (winding[3:6, 3:6, 3:6] == 1).all()
    assert winding[0].sum() == winding[-1].sum() == winding[:, :, 0].sum() == 0
    # Half of the boundary belongs to the box, so the number of samples matches its volume.
    assert winding.sum() == 4**3


@pytest.mark.parametrize("missing", range(12))
def test_samples_in_the_plane_of_an_opening_see_half_of_it(missing):
    """A box lacks one of its twelve triangles, and lattice planes contain the opening exactly."""
    box = trimesh.creation.box(extents=(2.0, 2.0, 2.0))
    faces = np.delete(np.asarray(box.faces), missing, axis=0)
    soup = soup_of(box.vertices, faces)
    ones, zero = np.ones(3, dtype=np.int64), np.zeros(3, dtype=np.int64)
    lattice = Lattice(np.full(3, -2.0), 0.25, ones, 17 * ones, zero, 17 * ones)
    winding, expected = wind_on_lattice(make_field(soup), lattice), exact(soup, lattice)
    far = distance_to(soup, lattice) > 1e-9
    assert np.abs(winding - expected)[far].max() < 1e-9
    corners = np.asarray(box.vertices)[np.asarray(box.faces)[missing]]
    opening = np.all(np.isclose(corners, corners[0]), axis=0).argmax()
    index = [slice(None)] * 3
    index[opening] = round((corners[0, opening] + 2) / 0.25)
    in_plane = far[tuple(index)]
    assert in_plane.any()


def distance_to(geometry, lattice):
    axes = [lattice.places(k) for k in range(3)]
    queries = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    if isinstance(geometry, Outline):
        import shapely

        lines = shapely.multilinestrings(shapely.linestrings(geometry.points[geometry.segments]))
        return shapely.distance(shapely.points(queries[:, [0, 2]]), lines).reshape(
            [len(a) for a in axes]
        )
    squared, _, _ = igl.point_mesh_squared_distance(queries, geometry.points, geometry.triangles)
    return np.sqrt(squared).reshape([len(a) for a in axes])


coordinate = st.one_of(
    st.integers(0, 6).map(float),  # These are on samples, lattice lines and planes.
    st.floats(0, 6, allow_nan=False, width=32),
    st.sampled_from([1e-7, 2.0 + 1e-9, 3.5]),  # These make needles and slivers.
)


@st.composite
def chains(draw, dim):
    """Return points and simplices that share, repeat and collapse their corners."""
    points = draw(st.lists(st.tuples(*[coordinate] * dim), min_size=dim, max_size=9))
    corner = st.integers(0, len(points) - 1)
    simplices = draw(st.lists(st.tuples(*[corner] * dim), min_size=1, max_size=12))
    copies = draw(st.lists(st.sampled_from(simplices), max_size=4))
    flipped = [s[::-1] for s in draw(st.lists(st.sampled_from(simplices), max_size=2))]
    scale, shift = draw(st.sampled_from([(1.0, 0.0), (0.25, 2.0**20), (1024.0, 0.0)]))
    return np.array(points) * scale + shift, np.array(simplices + copies + flipped), scale, shift


def check_chain(geometry, dim, scale, shift):
    ones, zero = np.ones(3, dtype=np.int64), np.zeros(3, dtype=np.int64)
    shape = 9 * ones
    origin = np.full(3, shift - scale)
    if dim == 2:
        origin[1], shape[1] = 0.0, 1
    lattice = Lattice(origin, scale, ones, shape, zero, shape)
    winding, expected = wind_on_lattice(make_field(geometry), lattice), exact(geometry, lattice)
    is_off = distance_to(geometry, lattice) > 1e-6 * scale
    assert np.abs(winding - expected)[is_off].max(initial=0.0) < 1e-6


def check_triangles(case):
    points, triangles, scale, shift = case
    if np.ptp(points[np.unique(triangles)], axis=0).max() > 0:
        check_chain(soup_of(points, triangles), 3, scale, shift)


def check_segments(case):
    points, segments, scale, shift = case
    if np.ptp(points[np.unique(segments)], axis=0).max() > 0:
        numbers = np.zeros(len(segments), dtype=np.int64)
        check_chain(Outline(points, segments, numbers), 2, scale, shift)


EXAMPLES = [150, pytest.param(1000, marks=pytest.mark.slow)]


@pytest.mark.parametrize("n", EXAMPLES)
@pytest.mark.parametrize(("dim", "check"), [(3, check_triangles), (2, check_segments)])
def test_random_chains_on_and_off_the_lattice(n, dim, check):
    how = settings(max_examples=n, deadline=None, derandomize=True)
    how(given(chains(dim))(check))()


def test_the_number_of_threads_and_slabs_changes_no_bit():
    soup = noisy_ball(5, share_lost=0.2)
    lattice = lattice_over(soup, 40, half=2)
    field = make_field(soup)
    n = int(lattice.n_blocks[0])
    before = numba.get_num_threads()
    try:
        results = []
        for n_threads in range(1, before + 1):
            numba.set_num_threads(n_threads)
            results.append(field.sums(lattice, 0, n))
    finally:
        numba.set_num_threads(before)
    assert all(np.array_equal(result, results[0]) for result in results)
    slabs = [field.sums(lattice, k, min(k + 16, n)) for k in range(0, n, 16)]
    assert np.abs(np.concatenate(slabs) - results[0]).max() < 8e-6


@pytest.mark.parametrize("share_lost", [0.0, 0.05])
def test_ranges_of_samples_count_as_if_the_others_were_zero(share_lost):
    soup = noisy_ball(3, share_lost)
    whole = lattice_over(soup, 14, half=2)
    shape = whole.n_blocks * 2
    first, last = np.array([3, 0, 5]), np.array([19, 25, 22])
    part = Lattice(whole.origin, whole.step, whole.half, whole.n_blocks, first, last)
    counts = np.zeros(shape, dtype=bool)
    counts[tuple(slice(f, t) for f, t in zip(first, last, strict=True))] = True
    expected = np.where(counts, exact(soup, whole), 0.0)
    n = whole.n_blocks
    expected = expected.reshape(n[0], 2, n[1], 2, n[2], 2).sum(axis=(1, 3, 5))
    assert np.abs(make_field(soup).sums(part, 0, int(n[0])) - expected).max() < 8e-6


def test_libigl_is_the_other_sampler(bunny):
    lattice = lattice_over(bunny, 10, half=2)
    ours = make_field(bunny).sums(lattice, 2, 7)
    theirs = make_field(bunny, "libigl").sums(lattice, 2, 7)
    assert np.abs(ours - theirs).max() / 8 < 0.02
