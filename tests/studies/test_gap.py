"""Fractions of cells cut by a gap, and widths at which patches open, by two methods each."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage
from shapely.geometry import Polygon, box

from studies.directions import normals_of
from studies.gap import sample_distances
from studies.gap_kernels import RULES, critical_width, fraction_in_gap
from studies.gap_meshes import compare_with_meshes, gap_fractions
from studies.gap_patch import measure_widths
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid
from tusqh.meshes.betti import betti_by_euler
from tusqh.sampling.fractions import sample_fractions
from tusqh.settings.policy import Policy
from tusqh.settings.sampling import Sampling

EXACT = np.empty(0)


def strip(normal, middle, width, reach=50.0):
    """Return the polygon of a gap whose middle line is at a signed distance from the origin."""
    along = np.array([-normal[1], normal[0]])
    return Polygon(
        [
            normal * (middle + side * width / 2) + along * end * reach
            for side, end in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        ]
    )


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.floats(0, 45), st.floats(-1.2, 1.2), st.floats(0.01, 1.5))
def test_the_area_in_a_gap_is_that_of_clipping(degrees, u, width):
    normal = normals_of(np.array([[degrees]]))[0]
    cell = box(-0.5, -0.5, 0.5, 0.5)
    expected = cell.intersection(strip(normal, -u, width)).area
    assert fraction_in_gap(u, width, normal) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize("ratios", [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.7, 0.2), (0.5, 0.5)])
def test_the_volume_in_a_gap_is_that_of_many_samples(ratios):
    normal = normals_of(np.array([ratios]))[0]
    distances = sample_distances(normal, 64)
    for u, width in itertools.product((0.0, 0.2, 0.6), (0.3, 0.9)):
        sampled = np.mean(np.abs(u + distances) < width / 2)
        assert fraction_in_gap(u, width, normal) == pytest.approx(sampled, abs=0.02)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.floats(0, 1), st.floats(0, 1), st.floats(-0.9, 0.9))
def test_at_its_critical_width_a_cell_is_just_half_full(a, b, u):
    normal = normals_of(np.array([[max(a, b), min(a, b)]]))[0]
    width = critical_width(u, normal, EXACT)
    assert fraction_in_gap(u, width - 1e-6, normal) <= 0.5 + 1e-9
    assert fraction_in_gap(u, width + 1e-6, normal) >= 0.5 - 1e-9


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.floats(0, 45), st.floats(-0.9, 0.9), st.sampled_from([2, 4, 8]))
def test_sampled_critical_widths_agree_with_counting(degrees, u, samples):
    normal = normals_of(np.array([[degrees]]))[0]
    distances = sample_distances(normal, samples)
    width = critical_width(u, normal, distances)
    for trial, is_kept in ((width - 1e-6, True), (width + 1e-6, False)):
        inside_gap = np.count_nonzero(np.abs(u + distances) < trial / 2)
        assert (2 * inside_gap <= len(distances)) == is_kept


def joined(fractions, **policy):
    """Whether the mesh of the real pipeline is one component."""
    cells = CellSets(fractions, Policy(**policy)).at(0.5)
    mesh = build_mesh(cells, fractions.grid).mesh
    assert betti_by_euler(mesh) == cells.predicted
    return cells.predicted.betti_0 == 1


@pytest.mark.parametrize("samples", [0, 2, 4, 8])
def test_the_real_mesh_without_bridges_joins_exactly_when_the_filtration_does(samples):
    table = compare_with_meshes(40, samples, np.random.default_rng(samples))
    assert table["filtration_joins"].nunique() == 2
    assert table["bare_agrees"].all()
    if samples == 0:
        assert (table["overruled"] == 0).all()
        assert table.loc[~table["agrees"], "in_window"].all()


@pytest.mark.parametrize("rule", range(4))
@pytest.mark.parametrize("degrees", [0.0, 12.0, 31.0, 45.0])
def test_the_bottleneck_is_that_of_a_plain_flood(rule, degrees):
    """Compare the opening width with labelling a large doubled grid, width by width."""
    normal = normals_of(np.array([[degrees]]))[0]
    offset, n = 0.37, 5
    _, opening = measure_widths(normal[None], np.array([offset]), EXACT[None], length=n)
    for width in (opening[0, 0, rule] - 1e-4, opening[0, 0, rule] + 1e-4):
        shape = (4 * n + 9, n)
        cells = gap_fractions(normal, offset, width, shape, 0).values
        kept = cells >= 0.5 - 1e-7
        whole = np.zeros_like(kept)
        whole[1::2, 1::2] = kept[1::2, 1::2]
        around = [np.roll(whole, s, axis=(0, 1)) for s in itertools.product((-1, 1), repeat=2)]
        beside_x = np.roll(whole, 1, 0) & np.roll(whole, -1, 0)
        beside_y = np.roll(whole, 1, 1) & np.roll(whole, -1, 1)
        name = RULES[rule]
        if name == "touching":
            whole = ndimage.binary_dilation(whole, np.ones((3, 3), bool))
        elif name in ("faces", "filtration"):
            whole[::2, 1::2] = beside_x[::2, 1::2]
            whole[1::2, ::2] = beside_y[1::2, ::2]
            if name == "filtration":
                some, all_of = np.logical_or.reduce(around), np.logical_and.reduce(around)
                whole[::2, ::2] = ((kept & some) | all_of)[::2, ::2]
        else:
            whole = kept
        assert flood_crosses(whole) == (width < opening[0, 0, rule])


def flood_crosses(kept):
    """Whether kept places join the first and the last cells, stepping to faces and cofaces."""
    seen = np.zeros_like(kept)
    front = [(1, j) for j in range(kept.shape[1]) if kept[1, j]]
    while front:
        i, j = front.pop()
        if seen[i, j]:
            continue
        seen[i, j] = True
        for a, b in itertools.product((-1, 0, 1), repeat=2):
            if (a, b) != (0, 0) and 0 <= i + a < kept.shape[0] and 0 <= j + b < kept.shape[1]:
                parities = {k % 2 for k, step in ((i, a), (j, b)) if step}
                if len(parities) == 1 and kept[i + a, j + b]:
                    front.append((i + a, j + b))
    return bool(seen[-2].any())


def test_the_real_sampler_measures_the_same_fractions():
    """Compare fractions of two half-planes by winding numbers with counts of a gap's samples."""
    degrees, width, samples = 23.0, 0.83, 8
    normal = normals_of(np.array([[degrees]]))[0]
    grid = BackgroundGrid(shape=(8, 6), cell_size=1.0, origin=(0.0, 0.0))
    middle = float(normal @ [4.1, 3.2])
    sides = []
    for side in (-1, 1):
        far = strip(normal, middle + side * (20 + width / 2), 40.0)
        sides.append(np.array(far.exterior.coords))
    measured = sample_fractions(
        Outline.from_chains(sides), grid, sampling=Sampling(samples=samples)
    )
    distances = sample_distances(normal, samples)
    for i, j in itertools.product(range(2, 15), range(2, 11)):
        u = float(normal @ [i / 2, j / 2]) - middle
        expected = 1 - np.mean(np.abs(u + distances) < width / 2)
        assert measured.values[i, j] == pytest.approx(expected, abs=2**-20)


@pytest.mark.parametrize(("width", "is_joined"), [(0.8, True), (0.9, False)])
def test_an_oblique_plane_gap_is_joined_at_vertices(width, is_joined):
    """Along the diagonal the filtration joins across a gap that no shared face crosses.

    The pinched edges vote differently from the vertices, and each follows its own vote.
    """
    normal = normals_of(np.array([[1.0, 1.0]]))[0]
    _, opening = measure_widths(normal[None], np.array([0.25]), EXACT[None], length=5)
    assert (width <= opening[0, 0, RULES.index("filtration")]) == (width < 0.85)
    assert width > opening[0, 0, RULES.index("faces")]
    fractions = gap_fractions(normal, 0.25, width, (17, 5, 5), 0)
    assert joined(fractions) == is_joined
