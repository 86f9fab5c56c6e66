"""Drawings: areas are those of the even-odd rule, or of the fills of SVG."""

import math
from itertools import pairwise

import ezdxf
import pytest

from tests.drawings_areas import area_of, box_of, remarks_of
from tusqh.errors import GeometryError
from tusqh.readers.files import read_file

SQUARE = [(0, 0), (10, 0), (10, 10), (0, 10)]


@pytest.fixture
def cases(repository):
    return repository / "tests/cases"


@pytest.fixture
def dxf(tmp_path):
    """A function that draws a DXF and returns its path."""

    def draw(entities):
        document = ezdxf.new()
        entities(document.modelspace())
        document.saveas(tmp_path / "a.dxf")
        return tmp_path / "a.dxf"

    return draw


@pytest.mark.parametrize(
    ("case", "area"),
    [
        ("06_dxf_loose_lines/x12_lines_random.dxf", 12),
        ("06_dxf_loose_lines/x13_lines_one_rev.dxf", 12),
        ("07_dxf_circle_in_outline/x14_hole_same_dir.dxf", 12 - math.pi),
        ("36_dxf_directions/two_polylines.dxf", 164),
    ],
)
def test_areas_of_dxf_do_not_depend_on_directions(cases, case, area):
    assert abs(area_of(cases / case)) == pytest.approx(area, rel=1e-3)
    assert remarks_of(cases / case)


def test_arcs_and_lines_are_chained_within_rounding(dxf):
    def slot(space):
        space.add_line((0, 1), (4, 1))
        space.add_line((0, -1), (4, -1 + 1e-9))
        space.add_arc((0, 0), 1, 90, 270)
        space.add_arc((4, 0), 1, 270, 450)

    assert abs(area_of(dxf(slot))) == pytest.approx(8 + math.pi, rel=1e-3)
    assert remarks_of(dxf(slot)) == "changed: 4 loose lines chained by their end points"


def test_an_outline_with_a_gap_stays_open_and_is_noted(dxf):
    corners = [(0, 0), (10, 0), (10, 10), (0, 10), (0, 0.5)]
    path = dxf(lambda space: [space.add_line(a, b) for a, b in pairwise(corners)])
    outline = read_file(path).geometry
    assert outline.n_segments == 4
    assert "noted: 1 chains that stay open" in remarks_of(path)


def test_what_is_drawn_twice_counts_once(dxf):
    def twice(space):
        space.add_lwpolyline(SQUARE, close=True)
        space.add_lwpolyline(SQUARE[2:] + SQUARE[:2], close=True)
        space.add_line((20, 0), (22, 0))
        space.add_line((22, 0), (20, 0))
        space.add_lwpolyline([(20, 0), (20, 2), (22, 2), (22, 0)])

    assert abs(area_of(dxf(twice))) == pytest.approx(104)
    assert "left out: 2 lines and outlines that are drawn again" in remarks_of(dxf(twice))


def test_a_line_across_an_outline_of_lines_leaves_its_area(dxf):
    def divided(space):
        for a, b in zip(SQUARE, SQUARE[1:] + SQUARE[:1], strict=True):
            space.add_line(a, b)
        space.add_line(SQUARE[0], SQUARE[2])

    assert abs(area_of(dxf(divided))) == pytest.approx(100)
    assert "left out: 1 lines that divide an outline" in remarks_of(dxf(divided))


def test_rings_nest_by_even_and_odd(dxf):
    def rings(space):
        for size in (1, 2, 3, 4):
            space.add_lwpolyline([(x * size / 10, y * size / 10) for x, y in SQUARE], close=True)
            space.add_circle((20, 20), size)

    inner = 16 - 9 + 4 - 1
    path = dxf(lambda space: rings(space))
    assert abs(area_of(path)) == pytest.approx((1 + math.pi) * inner, rel=1e-3)


def test_what_dxf_holds_besides_is_counted(dxf):
    def mixed(space):
        space.doc.layers.add("Hidden").off()
        space.add_lwpolyline(SQUARE, close=True)
        space.add_circle((5, 5), 1, dxfattribs={"layer": "HIDDEN"})
        space.add_text("a word")
        space.add_hatch()

    path = dxf(mixed)
    assert abs(area_of(path)) == 100
    assert "left out: 1 TEXT entities" in remarks_of(path)
    assert "left out: 1 HATCH entities" in remarks_of(path)
    assert "left out: 1 lines and curves that are hidden" in remarks_of(path)


def test_a_dxf_of_text_alone_says_so(dxf):
    with pytest.raises(GeometryError, match="no line or curve, but 1 TEXT entities"):
        read_file(dxf(lambda space: space.add_text("a word")))


def test_boxes_of_dxf_do_not_change(cases):
    assert box_of(cases / "36_dxf_directions/two_polylines.dxf") == [0, 0, 28, 10]
