"""Fractions of several surfaces: each sample has one owner, overlaps are given to the earlier."""

import numpy as np
import pytest
import trimesh
from shapes import box

from tusqh.contacts import mesh_materials
from tusqh.contacts.pairs import find_gaps, tabulate_pairs
from tusqh.contacts.surface_fractions import fractions_of_surfaces
from tusqh.errors import SamplingError
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.geometry.split_parts import split_parts
from tusqh.grid import BackgroundGrid, doubled
from tusqh.sampling.fractions import sample_fractions


def ball(centre, radius):
    """Return a ball as a soup."""
    solid = trimesh.creation.icosphere(subdivisions=2, radius=radius)
    return Soup.from_parts([(solid.vertices + centre, solid.faces.astype(np.int64))])


def ring(points):
    """Return a closed outline."""
    return Outline.from_chains([np.array([*points, points[0]], dtype=float)])


GRID = BackgroundGrid((5, 6, 7), 1.0, (-2.5, -3.0, -3.5))


def test_random_balls_share_no_sample():
    """What a later one loses is what the earlier ones take; all by one count and by a mask."""
    rng = np.random.default_rng(5)
    for _ in range(6):
        balls = [(rng.uniform(-1, 1, 3), rng.uniform(1.0, 1.6)) for _ in range(3)]
        surfaces = {f"ball {k}": ball(*at) for k, at in enumerate(balls)}
        # The first one is turned inside out, which orientation corrects.
        first = surfaces["ball 0"]
        surfaces["ball 0"] = Soup(first.points, first.triangles[:, ::-1], first.parts)
        found = fractions_of_surfaces(surfaces, GRID)
        places = [
            (np.arange(4 * n) + 0.5) / 4 + o for n, o in zip(GRID.shape, GRID.origin, strict=True)
        ]
        samples = np.stack(np.meshgrid(*places, indexing="ij"), -1).reshape(-1, 3)
        inside = [lies_in(samples, ball(*at)) for at in balls]
        taken = np.zeros(len(samples), dtype=bool)
        volumes = found.fractions.volumes()
        for name, mine in zip(surfaces, inside, strict=True):
            assert abs(volumes[name] - (mine & ~taken).sum() / 64) < 0.1
            taken |= mine
        own = np.array([volumes[name] for name in surfaces])
        assert np.allclose(found.alone, own + found.overlaps.sum(axis=0), atol=1e-4)
        assert (np.tril(found.overlaps) == 0).all()


def lies_in(points, soup):
    """Return which points lie behind every face of a convex solid."""
    a, b, c = np.moveaxis(soup.points[soup.triangles], 1, 0)
    normals = np.cross(b - a, c - a)
    return (points @ normals.T < (a * normals).sum(axis=1)).all(axis=1)


def test_one_surface_has_the_fractions_of_the_sampler():
    solid = ball((0.1, 0.2, 0.3), 1.7)
    found = fractions_of_surfaces({"ball": solid}, GRID).fractions
    expected = sample_fractions(solid, GRID).multiples
    decides = doubled.place_dimensions(expected.shape) != 2
    places = np.flatnonzero(decides)
    multiples = found.multiples_at(places, np.zeros((len(places), 1), dtype=np.int32))
    assert np.abs(multiples[:, 0] - expected.ravel()[places]).max() <= 1


def test_priority_is_the_order():
    one, other = box((-2, -2, -2), (1, 1, 1)), box((-1, -1, -1), (2, 2, 2))
    first = fractions_of_surfaces({"one": one, "other": other}, GRID)
    second = fractions_of_surfaces({"other": other, "one": one}, GRID)
    assert first.fractions.volumes()["one"] == second.fractions.volumes()["other"] == 27
    assert first.overlaps[0, 1] == second.overlaps[0, 1] == 8


@pytest.mark.parametrize("threshold", [1.0, 0.2])
def test_a_gap_thinner_than_a_cell_is_closed_or_opened_by_the_threshold_of_the_void(threshold):
    left, right = (
        ring([(0, 0), (2.4, 0), (2.4, 4), (0, 4)]),
        ring([(2.7, 0), (5, 0), (5, 4), (2.7, 4)]),
    )
    grid = BackgroundGrid((5, 4), 1.0, (0.0, 0.0))
    fractions = fractions_of_surfaces({"left": left, "right": right}, grid).fractions
    pairs, volumes = find_gaps(fractions)
    assert pairs.tolist() == [[0, 1]]
    assert volumes[0] == pytest.approx(0.25 * 4)  # Three samples of four are inside a part.
    found = mesh_materials(fractions, thresholds={"void": threshold})
    table = tabulate_pairs(found, fractions)
    assert table["area"].sum() == (4 if threshold == 1 else 0)
    assert found.is_as_predicted


def test_the_rest_fills_the_window():
    island = ring([(1, 1), (3, 1), (3, 3), (1, 3)])
    grid = BackgroundGrid((6, 6), 1.0, (0.0, 0.0))
    window = ((0.0, 0.0), (5.0, 6.0))
    found = fractions_of_surfaces({"island": island}, grid, window=window, rest="water")
    assert found.fractions.volumes() == {"island": 4.0, "water": 26.0, "void": 6.0}
    mesh = mesh_materials(found.fractions)
    assert str(mesh.measured["water"].by_euler) == "(1, 1, 0)"
    assert mesh.is_as_predicted


def test_wrong_parts_are_named():
    large, small = box((-2, -2, -2), (2, 2, 2)), box((-1, -1, -1), (1, 1, 1))
    with pytest.raises(SamplingError, match="'small' lies wholly inside 'large'") as caught:
        fractions_of_surfaces({"large": large, "small": small}, GRID)
    assert "list 'small' before 'large'" in str(caught.value)
    fractions_of_surfaces({"small": small, "large": large}, GRID)
    speck = box((0.01, 0.01, 0.01), (0.02, 0.02, 0.02))
    with pytest.raises(SamplingError, match="no sample lies in the material 'speck'"):
        fractions_of_surfaces({"large": large, "speck": speck}, GRID)


def test_parts_are_objects_or_connected_pieces_with_their_cavities():
    shell = trimesh.creation.icosphere(radius=2.0)
    cavity = trimesh.Trimesh(shell.vertices / 2, shell.faces[:, ::-1])
    core = trimesh.Trimesh(shell.vertices / 4, shell.faces)
    whole = trimesh.util.concatenate([core, shell, cavity])
    soup = Soup(
        whole.vertices, whole.faces.astype(np.int64), np.zeros(len(whole.faces), dtype=np.int64)
    )
    pieces = split_parts(soup)
    assert [len(p.triangles) for p in pieces] == [len(core.faces), 2 * len(shell.faces)]
    objects = split_parts(Soup(soup.points, soup.triangles, np.arange(len(soup.parts)) % 3))
    assert [len(p.triangles) for p in objects] == [len(core.faces)] * 3
