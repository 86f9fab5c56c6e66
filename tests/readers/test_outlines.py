import json
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely

from tusqh.errors import GeometryError
from tusqh.readers.curves import CHORD_TOLERANCE
from tusqh.readers.files import read_file

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]


def write(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def geojson(path: Path, geometry: object) -> Path:
    return write(path, json.dumps(geometry))


def svg(path: Path, body: str) -> Path:
    return write(path, f'<svg xmlns="http://www.w3.org/2000/svg">{body}</svg>')


def chains_of(path: Path) -> list[list[list[float]]]:
    """Return the polylines of a file, assembled from its segments."""
    outline = read_file(path).geometry
    result = []
    for chain in np.unique(outline.chains):
        segments = outline.segments[outline.chains == chain]
        assert (segments[1:, 0] == segments[:-1, 1]).all()
        result.append(outline.points[[*segments[:, 0], segments[-1, 1]]].tolist())
    return result


def test_geojson_keeps_every_ring_as_it_is(tmp_path):
    hole, open_ring = [[0.25, 0.25], [0.5, 0.5], [0.5, 0.25], [0.25, 0.25]], SQUARE[:-1]
    collection = {
        "type": "FeatureCollection",
        "features": [
            {"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [SQUARE, hole]}},
            {"type": "Feature", "geometry": None},
            {
                "type": "Feature",
                "geometry": {
                    "type": "GeometryCollection",
                    "geometries": [
                        {"type": "MultiPolygon", "coordinates": [[open_ring], [SQUARE]]},
                        {"type": "Point", "coordinates": [9, 9]},
                    ],
                },
            },
        ],
    }
    path = geojson(tmp_path / "a.geojson", collection)
    assert chains_of(path) == [SQUARE, hole, open_ring, SQUARE]
    assert read_file(path).geometry.name == "a.geojson"


@pytest.mark.parametrize("outer", [SQUARE, SQUARE[::-1]], ids=["ccw", "cw"])
def test_holes_of_geojson_polygons_turn_against_their_outer_ring(tmp_path, outer):
    ring = np.array([[0.25, 0.25], [0.5, 0.25], [0.5, 0.5], [0.25, 0.25]])
    far = np.array([1e7, -1e7])
    for hole, shift in ((ring, 0 * far), (ring[::-1], 0 * far), (ring + far, far)):
        around = (outer + shift).tolist()
        polygon = {"type": "Polygon", "coordinates": [around, hole.tolist()]}
        for item in (polygon, {"type": "MultiPolygon", "coordinates": [polygon["coordinates"]]}):
            first, second = chains_of(geojson(tmp_path / "a.geojson", item))
            assert first == around, "the outer ring as it is"
            assert sorted(map(tuple, second)) == sorted(map(tuple, hole.tolist()))
            areas = [shapely.LinearRing(chain).is_ccw for chain in (first, second)]
            assert areas[0] != areas[1]


def test_svg_shapes_and_transforms_point_up(tmp_path):
    path = svg(
        tmp_path / "a.svg",
        '<g transform="translate(10 0)"><g transform="scale(2)">'
        '<path d="M0 0 L1 0 L1 1"/></g></g>'
        '<rect x="21" y="2" width="3" height="4"/>'
        '<polygon points="30,0 31,0 30,1"/><polyline points="40,0 41,0 40,1"/>'
        '<line x1="5" y1="0" x2="6" y2="1"/>'
        '<path d="M0 0h1v1h-1z M5 5h1"/>',
    )
    assert chains_of(path) == [
        [[10, 0], [12, 0], [12, -2]],
        [[21, -2], [24, -2], [24, -6], [21, -6], [21, -2]],
        [[30, 0], [31, 0], [30, -1], [30, 0]],
        [[40, 0], [41, 0], [40, -1]],
        [[0, 0], [1, 0], [1, -1], [0, -1], [0, 0]],
    ]
    assert "left out: 1 elements that fill no area" in map(str, read_file(path).remarks)


def test_svg_definitions_are_drawn_where_they_are_used(tmp_path):
    body = '<defs><path id="tick" d="M0 0V1"/></defs><use href="#tick" x="3" y="1"/>'
    assert chains_of(svg(tmp_path / "a.svg", body)) == [[[3, -1], [3, -2]]]


@pytest.mark.parametrize(
    ("body", "radii"),
    [
        ('<circle cx="1" cy="2" r="3"/>', (3, 3)),
        ('<ellipse cx="1" cy="2" rx="3" ry="1"/>', (3, 1)),
        ('<circle r="1" transform="translate(1 2) scale(3 2)"/>', (3, 2)),
    ],
)
def test_svg_curves_stay_within_the_tolerance(tmp_path, body, radii):
    (chain,) = chains_of(svg(tmp_path / "a.svg", body))
    points = np.array(chain)
    middles = (points[1:] + points[:-1]) / 2
    assert chain[0] == chain[-1]
    assert np.linalg.norm((points - [1, -2]) / radii, axis=1) == pytest.approx(1)
    off = 1 - np.linalg.norm((middles - [1, -2]) / radii, axis=1)
    assert 0 < off.max() * min(radii) <= CHORD_TOLERANCE * 2 * max(radii)


def test_svg_bezier_keeps_its_ends(tmp_path):
    (chain,) = chains_of(svg(tmp_path / "a.svg", '<path d="M0 0 C0 0.1 0.3 1 0.7 0.1"/>'))
    assert (chain[0], chain[-1]) == ([0, 0], [0.7, -0.1])
    assert len(chain) > 10


def dxf(path: Path, draw) -> Path:
    document = ezdxf.new()
    draw(document, document.modelspace())
    document.saveas(path)
    return path


def test_dxf_straight_entities_are_exact(tmp_path):
    corners = [(0.1, 0), (1, 0), (1, 1)]

    def draw(document, space):
        space.add_line((0.1, 0.2, 9), (3, 4, 9))
        space.add_lwpolyline(corners)
        space.add_lwpolyline(corners, close=True)
        space.add_polyline2d(corners, close=True)
        space.add_polyline3d([(5, 5), (6, 5), (6, 6)])
        space.add_text("not a line")

    open_chain = [list(map(float, c)) for c in corners]
    assert chains_of(dxf(tmp_path / "a.dxf", draw)) == [
        [[0.1, 0.2], [3, 4]],
        open_chain,
        [*open_chain, open_chain[0]],
        [[5, 5], [6, 5], [6, 6]],
    ]


def test_dxf_curves_stay_within_the_tolerance(tmp_path):
    def draw(document, space):
        space.add_circle((1, 2), radius=3)
        space.add_arc((1, 2), radius=3, start_angle=0, end_angle=90)
        space.add_ellipse((1, 2), major_axis=(3, 0), ratio=1.0)
        space.add_lwpolyline([(4, 2, 0, 0, 1), (-2, 2, 0, 0, 1)], close=True)

    chains = [np.array(chain) for chain in chains_of(dxf(tmp_path / "a.dxf", draw))]
    for points in chains:
        radius = np.linalg.norm(points - [1, 2], axis=1)
        middle = np.linalg.norm((points[1:] + points[:-1]) / 2 - [1, 2], axis=1)
        assert radius == pytest.approx(3, rel=1e-6)
        assert 3 - middle.min() <= CHORD_TOLERANCE * 6 * 1.5
    is_closed = [(points[0] == points[-1]).all() for points in chains]
    assert is_closed == [True, False, True, True]


def test_dxf_splines_close_by_their_flag(tmp_path):
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]

    def draw(document, space):
        space.add_spline().set_open_uniform(corners)
        space.add_spline().set_closed(corners)
        space.add_spline(fit_points=corners).closed = True

    opened, periodic, fitted = (np.array(c) for c in chains_of(dxf(tmp_path / "a.dxf", draw)))
    assert opened[[0, -1]] == pytest.approx(np.array([[0, 0], [0, 1]]))
    assert (periodic[0] == periodic[-1]).all()
    assert (fitted[0] == fitted[-1]).all()
    # The periodic cubic stays inside its corners: it is smooth, symmetric and starts there.
    assert periodic[0] == pytest.approx([5 / 6, 1 / 6])
    assert periodic.min() == pytest.approx(1 - periodic.max())
    assert 0 < periodic.min() < 0.2
    assert min(len(opened), len(periodic)) > 10


def test_dxf_blocks_are_exploded(tmp_path):
    def draw(document, space):
        inner = document.blocks.new("inner")
        inner.add_line((0, 0), (1, 0))
        outer = document.blocks.new("outer")
        outer.add_blockref("inner", (0, 1))
        space.add_blockref("outer", (10, 0), dxfattribs={"xscale": 2, "yscale": 2})

    assert chains_of(dxf(tmp_path / "a.dxf", draw)) == [[[10, 2], [12, 2]]]


def test_csv_rows_are_loose_segments(tmp_path):
    path = write(tmp_path / "a.csv", "x0, y0, x1, y1\n0,0,1,0\n\n1,0,0.1,1e1\n")
    assert chains_of(path) == [[[0, 0], [1, 0]], [[1, 0], [0.1, 10]]]
    assert read_file(path).geometry.chains.tolist() == [0, 1]


def test_missing_file(tmp_path):
    with pytest.raises(GeometryError, match="no such file"):
        read_file(tmp_path / "gone.svg")


def test_unsupported_suffix_names_the_supported_ones(tmp_path):
    with pytest.raises(GeometryError, match="not supported") as caught:
        read_file(write(tmp_path / "a.docx", "hello"))
    for suffix in (".geojson", ".json", ".svg", ".shp", ".dxf", ".csv", ".stl", ".nrrd"):
        assert suffix in caught.value.expected


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.geojson", '{"type": "Poly', "Unterminated string"),
        ("a.geojson", '{"type": "Circle"}', "'Circle' is not a GeoJSON type"),
        ("a.geojson", "[1, 2]", "the file is a list of 2 entries"),
        ("a.geojson", '{"type": "Feature", "geometry": 3}', "is 3"),
        ("a.geojson", '{"type": "FeatureCollection", "features": {}}', "an object as `features`"),
        ("a.geojson", '{"type": "Polygon"}', "coordinates"),
        ("a.geojson", '{"type": "LineString", "coordinates": [["0", 1], [2, 3]]}', "is text"),
        (
            "a.geojson",
            '{"type": "LineString", "coordinates": [[0, 1], [2]]}',
            "fewer than two numbers",
        ),
        ("a.svg", "<svg><path></svg>", "mismatched tag"),
        ("a.svg", "<drawing/>", "not <svg>"),
        ("a.svg", '<svg><path d="M 0 0 L"/></svg>', "expects 2"),
        ("a.svg", '<svg><g transform="turn(3)"/></svg>', "transform"),
        ("a.dxf", "not a drawing", "not a DXF file"),
    ],
)
def test_corrupt_file_carries_the_message_of_the_parser(tmp_path, name, text, message):
    with pytest.raises(GeometryError, match="cannot be read") as caught:
        read_file(write(tmp_path / name, text))
    assert message in caught.value.found
    assert name in caught.value.where


def test_binary_rubbish_is_not_a_crash(tmp_path):
    rubbish = np.random.default_rng(0).bytes(500)
    for suffix in ("geojson", "svg", "dxf"):
        path = tmp_path / f"a.{suffix}"
        path.write_bytes(rubbish)
        with pytest.raises(GeometryError, match="cannot be read"):
            read_file(path)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.json", '{"type": "FeatureCollection", "features": []}'),
        ("a.json", '{"type": "LineString", "coordinates": [[0, 0]]}'),
        ("a.svg", "<svg/>"),
        ("a.csv", "x0,y0,x1,y1\n"),
    ],
)
def test_empty_geometry(tmp_path, name, text):
    with pytest.raises(GeometryError, match="empty"):
        read_file(write(tmp_path / name, text))


def test_empty_drawing(tmp_path):
    with pytest.raises(GeometryError, match="empty"):
        read_file(dxf(tmp_path / "a.dxf", lambda document, space: None))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.json", '{"type": "LineString", "coordinates": [[0, NaN], [1, 1]]}'),
        ("a.json", '{"type": "LineString", "coordinates": [[0, -Infinity], [1, 1]]}'),
        ("a.json", '{"type": "LineString", "coordinates": [[0, 1e999], [1, 1]]}'),
        ("a.json", '{"type": "LineString", "coordinates": [[0, null], [1, 1]]}'),
        ("a.csv", "x0,y0,x1,y1\n0,0,nan,1\n"),
        ("a.csv", "x0,y0,x1,y1\n0,0,inf,1\n"),
    ],
)
def test_coordinates_that_are_not_finite(tmp_path, name, text):
    with pytest.raises(GeometryError, match="NaN or infinite"):
        read_file(write(tmp_path / name, text))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.json", '{"type": "LineString", "coordinates": [[2, 1], [2, 1], [2, 1]]}'),
        ("a.svg", '<svg><path d="M1 1L1 1"/></svg>'),
        ("a.csv", "x0,y0,x1,y1\n3,3,3,3\n"),
    ],
)
def test_zero_extent(tmp_path, name, text):
    with pytest.raises(GeometryError, match="zero extent"):
        read_file(write(tmp_path / name, text))


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("x0,y0,x1\n0,0,1\n", 1, "the columns are x0,y0,x1"),
        ("a,b,c,d\n0,0,1,1\n", 1, "the columns are a,b,c,d"),
        ("\n", 1, "the columns are (none)"),
        ("x0,y0,x1,y1\n0,0,1,1\n0,zero,1,1\n", 3, "'0,zero,1,1' is not four numbers"),
        ("x0,y0,x1,y1\n0,0,1\n", 2, "'0,0,1' is not four numbers"),
        ("x0,y0,x1,y1\n0,0,1,1,1\n", 2, "'0,0,1,1,1' is not four numbers"),
    ],
)
def test_bad_csv_names_the_line(tmp_path, text, line, message):
    with pytest.raises(GeometryError) as caught:
        read_file(write(tmp_path / "a.csv", text))
    assert message in caught.value.found
    assert caught.value.where.endswith(f"a.csv, line {line}")
