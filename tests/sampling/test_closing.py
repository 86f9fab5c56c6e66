"""Caps have the same boundary as the soup and consist of few and small triangles."""

import numpy as np
import pytest
import trimesh
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tusqh.geometry.boundary_chain import boundary_edges, boundary_points, match_points
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.sampling.closing import close


def boundary_of(chain):
    """Return the boundary of a chain as a dictionary from coordinates to multiplicities, slowly."""
    total = {}
    for corners, times in zip(chain.corners.tolist(), chain.multiplicity.tolist(), strict=True):
        n = len(corners)
        for k in range(n if n == 3 else 1):
            a, b = tuple(corners[k]), tuple(corners[(k + 1) % n])
            if n == 2:
                total[a] = total.get(a, 0) - times
                total[b] = total.get(b, 0) + times
            elif a != b:
                key, sign = ((a, b), 1) if a < b else ((b, a), -1)
                total[key] = total.get(key, 0) + sign * times
    return {key: value for key, value in total.items() if value}


def soup_of(points, triangles):
    triangles = np.asarray(triangles, dtype=np.int64)
    return Soup(np.asarray(points, float), triangles, np.zeros(len(triangles), dtype=np.int64))


def area_of(chain):
    sides = chain.corners[:, 1:] - chain.corners[:, :1]
    return np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.lists(st.tuples(*[st.integers(0, 11)] * 3), min_size=1, max_size=40), st.integers(0, 99))
def test_the_cycle_is_closed_and_the_cap_has_the_boundary_of_the_soup(triangles, seed):
    points = np.random.default_rng(seed).random((12, 3))
    assume(len(np.unique(triangles)) > 1)
    soup = soup_of(points, triangles)
    cycle, cap = close(soup)
    assert boundary_of(cycle) == {}
    from_soup = type(cap)(points[soup.triangles], np.ones(len(triangles), dtype=np.int64))
    assert boundary_of(cap) == boundary_of(from_soup)


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.lists(st.tuples(*[st.integers(0, 20)] * 2), min_size=1, max_size=30), st.integers(0, 99))
def test_the_same_of_outlines(segments, seed):
    points = np.random.default_rng(seed).random((21, 2))
    assume(len(np.unique(segments)) > 1)
    segments = np.array(segments)
    outline = Outline(points, segments, np.zeros(len(segments), dtype=np.int64))
    cycle, cap = close(outline)
    assert boundary_of(cycle) == {}
    flat = np.insert(points, 1, 0.0, axis=1)
    from_outline = type(cap)(flat[segments], np.ones(len(segments), dtype=np.int64))
    assert boundary_of(cap) == boundary_of(from_outline)


def tube(n, gap):
    """Return a tube of n strips with a slit of width `gap` along its length."""
    angle = np.linspace(gap, 2 * np.pi, n + 1)
    rows = [np.stack([np.cos(angle), np.sin(angle), np.full(n + 1, z)], 1) for z in range(5)]
    points = np.concatenate(rows)
    quads = [(r * (n + 1) + k, r * (n + 1) + k + 1) for r in range(4) for k in range(n)]
    triangles = [t for a, b in quads for t in ((a, b, b + n + 1), (a, b + n + 1, a + n + 1))]
    return soup_of(points, triangles)


def test_a_crack_is_closed_by_slivers():
    """Without zipping, the loop around the slit and both ends would be one fan through the tube."""
    soup = tube(24, gap=0.01)
    _, cap = close(soup)
    ends = 2 * np.pi
    assert area_of(cap) == pytest.approx(ends, rel=0.1)


def test_sheets_are_their_own_caps_and_closed_soups_have_none():
    corners = np.random.default_rng(0).random((60, 3))
    sheets = soup_of(corners, np.arange(60).reshape(20, 3))
    cycle, cap = close(sheets)
    assert (len(cycle), len(cap)) == (0, 20)
    tetrahedron = [[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]]
    assert len(close(soup_of(corners, tetrahedron))[1]) == 0
    box = np.array(trimesh.creation.box().faces)
    twice = soup_of(trimesh.creation.box().vertices, np.concatenate([box[1:], box[1:]]))
    assert np.abs(close(twice)[1].multiplicity).tolist() == [2]


def test_ends_are_joined_to_their_neighbours():
    """The four sides of the square miss each other at the corners by a hundredth."""
    t = np.linspace(0.01, 0.99, 10)
    low, high = np.zeros(10), np.ones(10)
    sides = [(t, low), (high, t), (t[::-1], high), (low, t[::-1])]
    _, cap = close(Outline.from_chains([np.stack(side, axis=1) for side in sides]))
    lengths = np.linalg.norm(cap.corners[:, 0] - cap.corners[:, 1], axis=1)
    assert len(cap) == 8
    assert lengths.max() < 0.02


def test_points_match_when_they_are_equal_in_every_bit():
    rng = np.random.default_rng(0)
    points = rng.integers(0, 4, (200, 3)).astype(float)
    points[::7] *= -0.0
    distinct, number = match_points(points)
    assert np.array_equal(distinct[number], points)
    assert len(distinct) == len(np.unique(points + 0.0, axis=0))
    nearly = np.array([[1.0, 2.0], [1.0, np.nextafter(2.0, 3.0)]])
    assert len(match_points(nearly)[0]) == 2


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.lists(st.tuples(*[st.integers(0, 6)] * 3), min_size=0, max_size=30))
def test_a_boundary_has_no_boundary(triangles):
    edges, net = boundary_edges(np.array(triangles, dtype=np.int64).reshape(-1, 3), 7)
    assert (net != 0).all()
    repeated = np.repeat(np.where((net > 0)[:, None], edges, edges[:, ::-1]), np.abs(net), axis=0)
    assert len(boundary_points(repeated, 7)[0]) == 0
