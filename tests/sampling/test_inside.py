"""Insides that are made: envelopes and shells, against exact distances, SciPy and shapely."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
import trimesh

from tests.sampling import brute_insides as brute
from tusqh.errors import SamplingError
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid
from tusqh.sampling.envelope import GROWTH, corners_of, make_envelope
from tusqh.sampling.flood import COVERED, REACHED
from tusqh.sampling.fractions import sample_fractions
from tusqh.sampling.inside import EnvelopeField, ShellField
from tusqh.sampling.inside_lengths import seal_of
from tusqh.sampling.lattice import Lattice
from tusqh.sampling.layout import lay_grid
from tusqh.sampling.offset_scan import mark_near
from tusqh.settings.sampling import Sampling


def soup_of(mesh):
    return Soup(
        np.array(mesh.vertices, dtype=np.float64),
        np.array(mesh.faces, dtype=np.int64),
        np.zeros(len(mesh.faces), dtype=np.int64),
    )


def random_pieces(rng, corners):
    """Random triangles or segments, some of which are degenerate or lie on lattice planes."""
    m = int(rng.integers(1, 9))
    pieces = rng.uniform(2, 11, (m, 1, 3)) + rng.normal(0, rng.choice([0.3, 2.5]), (m, corners, 3))
    if rng.random() < 0.3:
        pieces = np.round(pieces)
    if rng.random() < 0.3:
        pieces[0, -1] = pieces[0, 0]
    if rng.random() < 0.3:
        pieces[-1, 1] = pieces[-1, 0] + [0, 0, 3]
    return pieces


def is_inside(envelope):
    return envelope.marks & (REACHED | COVERED) == 0


@pytest.mark.parametrize("corners", [2, 3])
def test_samples_near_pieces_are_those_whose_distance_is_less(corners):
    rng = np.random.default_rng(corners)
    n_near = 0
    for _ in range(60):
        pieces, shape = random_pieces(rng, corners), tuple(rng.integers(5, 14, 3))
        radius = rng.uniform(0.3, 4)
        marks = np.zeros(shape, dtype=np.uint8)
        mark_near(pieces, radius, 1, marks)
        places = np.argwhere(marks >= 0).astype(float)
        distance = brute.distances(places, pieces).reshape(shape)
        is_tie = np.abs(distance - radius) < 1e-8
        np.testing.assert_array_equal((marks == 1)[~is_tie], (distance < radius)[~is_tie])
        n_near += int(marks.sum())
    assert n_near > 3_000


def test_envelopes_are_those_of_labels_and_single_balls():
    rng = np.random.default_rng(0)
    n_inside, n_closed = 0, 0
    for trial in range(13):
        if trial % 2:
            box = trimesh.creation.box(rng.uniform(2, 5, 3))
            box.apply_transform(trimesh.transformations.random_rotation_matrix(rng.random(3)))
            gap = rng.uniform(0, 1.5)  # The faces move apart, so gaps open along the edges.
            corners = box.triangles + gap * box.face_normals[:, None]
            points = corners.reshape(-1, 3)
            soup = Soup(points, np.arange(len(points)).reshape(-1, 3), np.zeros(12, dtype=int))
        else:
            pieces = 0.5 * random_pieces(rng, 3)
            points = pieces.reshape(-1, 3)
            soup = Soup(
                points, np.arange(len(points)).reshape(-1, 3), np.zeros(len(pieces), dtype=int)
            )
        seal, step = rng.uniform(0.9, 2.0), 0.4
        envelope = make_envelope(soup, seal, origin=rng.normal(size=3), step=step)
        corners = (corners_of(soup) - envelope.origin) / step
        expected = brute.envelope(corners, envelope.marks.shape, envelope.radius, GROWTH)
        n_other = int((is_inside(envelope) != expected).sum())
        assert n_other == 0, trial
        n_inside += int(expected.sum())
        n_closed += bool(expected.any())
    assert n_inside > 1_000
    assert n_closed >= 4


def test_a_closed_surface_is_its_own_envelope():
    ball = soup_of(trimesh.creation.icosphere(3))
    grid = lay_grid(ball, None, cells=16)
    wound = sample_fractions(ball, grid)
    made = sample_fractions(ball, grid, sampling=Sampling(inside="envelope"))
    assert made.volume() == pytest.approx(wound.volume(), rel=0.005)
    assert (made.multiples >= wound.multiples).all()
    doubled = Soup(
        ball.points,
        np.concatenate([ball.triangles, ball.triangles[:, ::-1]]),
        np.zeros(2 * len(ball.triangles), dtype=np.int64),
    )
    again = sample_fractions(doubled, grid, sampling=Sampling(inside="envelope"))
    np.testing.assert_array_equal(again.multiples, made.multiples)


@pytest.mark.parametrize("seed", range(6))
def test_a_slit_is_closed_below_the_size_of_the_ball_and_open_above(seed):
    """Two half boxes face each other with a slit between them, in any direction."""
    rng = np.random.default_rng(seed)
    turn = trimesh.transformations.random_rotation_matrix(rng.random(3))
    turn[:3, 3] = rng.random(3)
    seal, step = 0.5, 0.25
    volumes = {}
    for width in (0.0, 0.9 * seal, 0.98 * seal, seal + 2 * step, 2 * seal):
        half = trimesh.creation.box((4, 4, 2))
        half.apply_translation([0, 0, 1 + width / 2])
        half.update_faces(half.face_normals[:, 2] > -0.5)
        other = half.copy()
        other.apply_transform(np.diag([1.0, 1, -1, 1]))
        both = trimesh.util.concatenate([half, other])
        both.apply_transform(turn)
        made = make_envelope(soup_of(both), seal, origin=np.zeros(3), step=step)
        volumes[width] = is_inside(made).sum() * step**3
    closed = [volumes[w] for w in (0.0, 0.9 * seal, 0.98 * seal)]
    assert min(closed) > 0.95 * 64
    assert max(volumes[w] for w in (seal + 2 * step, 2 * seal)) < 0.1 * 64


def test_shells_and_envelopes_in_the_plane_are_those_of_shapely():
    rng = np.random.default_rng(3)
    for _ in range(4):
        lines = [rng.uniform(0, 6, (1, 2)) + np.cumsum(rng.normal(0, 0.8, (9, 2)), axis=0)
                 for _ in range(3)]  # fmt: skip
        outline, drawn = Outline.from_chains(lines), shapely.MultiLineString([*lines])
        low, high = (np.array(b) for b in outline.bounding_box())
        step = 0.05
        shape = tuple(int(n) for n in np.ceil((high - low + 4) / step))
        grid = BackgroundGrid(shape, 2 * step, tuple((low - 2).tolist()))
        lattice = Lattice.over_grid(grid, 2).of_samples()
        area = step * step
        for radius in (0.11, 0.4):
            found = ShellField(corners_of(outline), radius).sums(lattice, 0, 2 * shape[0])
            assert found.sum() * area == pytest.approx(
                drawn.buffer(radius, quad_segs=64).area, rel=0.02
            )
            hull = shapely.box(*(low - 9), *(high + 9))
            beyond = hull.difference(drawn.buffer(radius, quad_segs=64))
            beyond = max(shapely.get_parts(beyond), key=lambda part: part.area)
            reached = beyond.buffer(radius - 1e-6, quad_segs=64)
            closed = shapely.box(*(low - 2), *(high + 2)).difference(reached)
            made = EnvelopeField(outline, 2 * radius).sums(lattice, 0, 2 * shape[0])
            slack = 0.35 * step * closed.length + 40 * area
            assert closed.area - slack <= made.sum() * area <= closed.area + slack


def test_samples_between_those_of_a_coarse_lattice_keep_the_ball_small():
    side = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    outline = Outline.from_chains([side])
    grid = lay_grid(outline, None, cells=4)
    lattice = Lattice.over_grid(grid, 2)
    field = EnvelopeField(outline, 0.1)
    assert field.sums(lattice, 0, 8).sum() == 64
    assert field.on(lattice).step == pytest.approx(0.05)
    assert field.on(Lattice.over_grid(grid.padded(), 2)) is field.on(lattice)


@pytest.mark.parametrize(
    ("sampling", "message"),
    [
        (Sampling(inside="envelope", seal=2.5), "a seal of 2.5, and the longest side"),
        (Sampling(inside="shell", thickness=0.06), "a thickness of 0.06, and the cells are 0.25"),
        (Sampling(inside="shell", thickness="3 parsec"), "the unit 'parsec'"),
    ],
)
def test_lengths_that_do_not_fit_are_refused(sampling, message):
    ball = soup_of(trimesh.creation.icosphere(1))
    grid = BackgroundGrid((8, 8, 8), 0.25, (-1.0, -1.0, -1.0))
    with pytest.raises(SamplingError, match=message):
        sample_fractions(ball, grid, sampling=sampling)


def test_lengths_have_units_and_count_in_cells():
    ball = soup_of(trimesh.creation.icosphere(1))
    known = replace(ball, unit="cm")
    for text, geometry, expected in (
        ("5 mm", known, 0.5),
        ("0.25 cm", known, 0.25),
        ("1e-2 m", known, 1.0),
        ("1.5 millimetres", known, 0.15),
        ("2 cells", ball, 0.5),
        (0.3, ball, 0.3),
        ("0.3", known, 0.3),
        (None, ball, 0.125),
    ):
        found = seal_of(geometry, Sampling(inside="envelope", seal=text), 0.25)
        assert found == pytest.approx(expected)
    with pytest.raises(SamplingError, match="the unit of the geometry is not known") as error:
        seal_of(ball, Sampling(inside="envelope", seal="2 mm"), 0.25)
    assert "--unit mm" in str(error.value)


def test_an_envelope_that_is_empty_says_what_to_do():
    sheet = Soup(
        np.array([[0.0, 0, 0], [4, 0, 1], [4, 4, 2], [0, 4, 1]]),
        np.array([[0, 1, 2], [0, 2, 3]]),
        np.zeros(2, dtype=np.int64),
    )
    with pytest.raises(SamplingError, match="reaches all places") as error:
        sample_fractions(
            sheet, lay_grid(sheet, None, cells=8), sampling=Sampling(inside="envelope")
        )
    assert "--inside shell --thickness 0.5" in str(error.value)
