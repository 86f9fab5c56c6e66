"""Blocks at a corner and the islands of a wedge, exactly and by the real sampler."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage
from shapely.geometry import Polygon, box

from studies.aliasing import wedge
from studies.methods.exact_fractions import (
    area_in_boxes,
    exact_cell_fractions,
    exact_fractions,
)
from studies.two_triangles import blocks_of, corner_fraction, grid_of, refine
from studies.wedge_islands import GRIDS_PER_HALVING, follow_islands
from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid
from tusqh.sampling.fractions import sample_fractions
from tusqh.settings.sampling import Sampling

numbers = st.floats(-2, 2)


@settings(max_examples=80, deadline=None, derandomize=True)
@given(st.lists(st.tuples(numbers, numbers), min_size=3, max_size=3), numbers, numbers)
def test_areas_in_boxes_are_those_of_clipping(corners, x, y):
    hull = Polygon(corners).convex_hull
    if hull.geom_type != "Polygon" or hull.area < 1e-3:
        return
    ring = list(hull.exterior.coords)[:-1]
    if not hull.exterior.is_ccw:
        ring.reverse()
    expected = hull.intersection(box(x, y, x + 0.7, y + 0.7)).area
    assert area_in_boxes(ring, x, y, 0.7) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize("thirds", [1, 2])
def test_the_corner_alternates_exactly_between_ten_and_seven_eighteenths(thirds):
    expected = [Fraction(10, 18), Fraction(7, 18)]
    for level in range(40):
        assert corner_fraction(thirds, level) == expected[(level + thirds) % 2]


@pytest.mark.parametrize("case", ["2/3", "1/3", "both"])
@pytest.mark.parametrize("level", [0, 1, 3])
def test_fractions_agree_with_the_real_sampler(case, level):
    """Winding numbers of many samples differ from the exact areas by at most their resolution."""
    grid = grid_of(case, level)
    rings = [np.array([*block, block[0]], dtype=float) for block in blocks_of(case)]
    sampled = sample_fractions(Outline.from_chains(rings), grid, sampling=Sampling(samples=48))
    exact = exact_fractions([[(float(a), float(b)) for a, b in b4] for b4 in blocks_of(case)], grid)
    assert np.abs(sampled.values - exact.values).max() < 1.5 / 48
    cells = exact_cell_fractions(
        [[(float(a), float(b)) for a, b in b4] for b4 in blocks_of(case)], grid
    )
    assert np.array_equal(cells, exact.cells)


def test_the_blocks_join_and_part_in_turn_and_both_corners_hide_it():
    table = refine(4)
    components = {c: t["components"].tolist() for c, t in table.groupby("case")}
    assert components == {
        "2/3": [1, 2, 1, 2, 1],
        "1/3": [2, 1, 2, 1, 2],
        "both": [1, 1, 1, 1, 1],
    }
    assert (table["holes"] == 0).all()
    assert (table["sub_cell_components"] == table["components"]).all()
    both = table[table["case"] == "both"]["joined"].tolist()
    assert both == ["2/3", "1/3", "2/3", "1/3", "2/3"]


def test_the_joined_corner_is_where_the_flood_passes():
    """With both corners, removing the cell of the joined corner separates the blocks."""
    for level in (1, 2):
        grid = grid_of("both", level)
        polygons = [[(float(a), float(b)) for a, b in block] for block in blocks_of("both")]
        kept = exact_cell_fractions(polygons, grid) >= 0.5
        thirds, y = ((1, -1 - grid.cell_size), (2, 0.0))[level % 2 == 0]
        place = tuple(
            int(np.floor((v - o) / grid.cell_size + 1e-9))
            for v, o in zip((thirds / 3, y), grid.origin, strict=True)
        )
        assert kept[place]
        kept[place] = False
        assert ndimage.label(kept)[1] == 2


def test_islands_move_to_the_apex_and_never_go():
    components, grids = follow_islands(2)
    assert (grids["islands"] > 0).all()
    assert (grids["islands_of_mesh"] == 0).all()
    assert grids["islands"].tolist() == [
        (~of_grid["is_main"]).sum() for _, of_grid in components.groupby("grid")
    ]
    ends = components[~components["is_main"]].groupby("grid")["stop"].max()
    assert ends.iloc[-1] < ends.iloc[0] / 2
    assert len(grids) == 2 * GRIDS_PER_HALVING + 1


def test_a_wedge_from_a_grid_vertex_looks_the_same_at_every_refinement():
    """The whole pattern near the apex repeats at half the size, so it cannot converge."""
    patterns = []
    for level in range(3):
        size = 2.0**-level
        grid = BackgroundGrid(shape=(20, 12), cell_size=size, origin=(0.0, 0.0))
        patterns.append(exact_cell_fractions([wedge((0.0, 0.0), 5.0, 25.0, 60.0)], grid) >= 0.5)
    assert patterns[0].any()
    assert np.array_equal(patterns[0], patterns[1])
    assert np.array_equal(patterns[1], patterns[2])
