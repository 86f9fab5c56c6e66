"""The areas of drawings are those of the even-odd rule, or of the fills of SVG."""

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
    """Return a function that draws a DXF and returns its path."""

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


def svg(path, body, head=""):
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{body}</svg>')
    return path


MM = 96 / 25.4


@pytest.mark.parametrize(
    ("case", "area", "box"),
    [
        ("04_mirrored_halves_crash/g29_matrix_reflect.svg", 12, [-2, -3, 12, 0]),
        ("08_svg_fill_rule/g21_evenodd.svg", 84, [0, -10, 10, 0]),
        ("09_svg_nested_viewport/g15_nested_svg.svg", 101, [0, -15, 20, 0]),
        ("09_svg_nested_viewport/g16_use_symbol.svg", 400, [5, -25, 25, -5]),
        ("10_svg_clip_path/g18_clip.svg", 50, [0, -10, 5, 0]),
        ("11_svg_messages/g30_missing_use.svg", 6, [0, -3, 2, 0]),
        ("11_svg_messages/g12_rect_mm.svg", 200 * MM**2, [0, -20 * MM, 10 * MM, 0]),
        ("35_svg_directions/rect_and_path.svg", 164, [0, -10, 28, 0]),
        ("40_svg_noise/rx_zero.svg", 100, [0, -10, 10, 0]),
    ],
)
def test_svg_is_the_union_of_what_its_elements_fill(cases, recwarn, case, area, box):
    assert abs(area_of(cases / case)) == pytest.approx(area)
    assert box_of(cases / case) == pytest.approx(box)
    assert not recwarn.list


TWICE = "M0 0H10V10H0Z M3 3H7V7H3Z"
PENTAGRAM = "M50 0 79 90 2 35 98 35 21 90Z"


@pytest.mark.parametrize(
    ("body", "area"),
    [
        (f'<path d="{TWICE}"/>', 100),
        (f'<g fill-rule="evenodd"><path d="{TWICE}"/></g>', 84),
        (f'<g style="fill-rule: evenodd"><path d="{TWICE}" fill-rule="inherit"/></g>', 84),
        (f'<style>.a{{fill-rule:evenodd}}</style><path class="b a" d="{TWICE}"/>', 84),
        ('<path d="M0 0H10V10H0Z M3 3V7H7V3Z"/>', 84),
        ('<rect width="10" height="10"/><rect x="3" y="3" width="4" height="4"/>', 100),
        ('<rect width="10" height="10"/><path d="M5 5V15H15V5Z"/>', 175),
        ('<rect width="10" height="10"/><rect width="10" height="10"/>', 100),
        ('<path d="M0 0 10 10H0L10 0Z"/>', 50),
        ('<rect width="10" height="10" display="none"/><rect width="1" height="1"/>', 1),
        ('<rect width="9" height="9" fill="none"/><rect width="1" height="1"/>', 1),
        ('<g fill="none"><rect width="9" height="9"/><circle cx="4" cy="4" r="0"/></g>', 81),
        ('<rect width="2" height="3" style="transform: scale(2)"/>', 24),
        ('<rect width="50%" height="25%"/>', 100 * 50),
        ('<use href="#a"/><defs><rect id="a" width="4" height="4"/></defs>', 16),
        ('<g id="a"><use href="#a"/><rect width="4" height="4"/></g>', 16),
        ('<svg width="5" height="5"><rect width="9" height="9"/></svg>', 25),
        ('<path d="M0 0A0 3 0 0 1 4 0V4H0Z"/>', 16),
    ],
)
def test_areas_of_svg(tmp_path, recwarn, body, area):
    path = svg(tmp_path / "a.svg", body, 'viewBox="0 0 200 200"')
    assert abs(area_of(path)) == pytest.approx(area)
    assert not recwarn.list


def test_a_pentagram_is_full_by_nonzero_and_hollow_by_evenodd(tmp_path):
    full = abs(area_of(svg(tmp_path / "a.svg", f'<path d="{PENTAGRAM}"/>')))
    hollow = abs(area_of(svg(tmp_path / "b.svg", f'<path fill-rule="evenodd" d="{PENTAGRAM}"/>')))
    assert 1.4 < full / hollow < 1.5


def test_transforms_turn_about_their_origin(tmp_path):
    body = '<rect width="4" height="2" transform="rotate(90)" transform-origin="4 2"/>'
    assert box_of(svg(tmp_path / "a.svg", body)) == pytest.approx([4, -2, 6, 2])
    css = '<rect width="4" height="2" style="transform:rotate(.25turn);transform-origin:4px 2px"/>'
    assert box_of(svg(tmp_path / "b.svg", css)) == pytest.approx([4, -2, 6, 2])


@pytest.mark.parametrize(
    ("body", "line"),
    [
        ("<text>word</text>", "left out: 1 texts"),
        ('<image href="a.png"/>', "left out: 1 images"),
        ('<use href="#gone"/>', "left out: 1 references (<use>)"),
        ('<rect width="1" height="1" visibility="hidden"/>', "left out: 1 hidden elements"),
        ('<rect x="20" width="1mm" height="1"/>', "changed: 1 elements with units"),
        ('<rect x="20" width="1" height="1" fill="url(#g)"/>', "changed: 1 elements filled with a"),
        ('<rect x="20" width="1" height="1" fill="#fff"/>', "noted: 1 elements filled with white"),
        ('<rect x="20" width="1" height="1" mask="url(#m)"/>', "noted: 1 masks"),
        ("<style>g > rect {fill: red}</style>", "left out: 1 CSS selectors"),
    ],
)
def test_what_svg_holds_besides_is_counted(tmp_path, body, line):
    path = svg(tmp_path / "a.svg", f'<rect width="9" height="9"/>{body}')
    assert line in remarks_of(path)


def test_clip_paths_in_the_box_of_their_element(tmp_path):
    clip = '<clipPath id="c" clipPathUnits="objectBoundingBox"><rect width=".5" height="1"/>'
    body = f'{clip}</clipPath><rect x="10" width="8" height="4" clip-path="url(#c)"/>'
    path = svg(tmp_path / "a.svg", body)
    assert box_of(path) == pytest.approx([10, -4, 14, 0])
    assert "changed: 1 elements cut by clip paths" in remarks_of(path)
