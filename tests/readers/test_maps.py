"""Every polygon of a map has its area, regardless of the directions of its rings."""

import json
import shutil

import pytest

from tests.drawings_areas import area_of, remarks_of
from tusqh.errors import GeometryError
from tusqh.readers.files import read_file

SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]
HOLE = [[1, 1], [2, 1], [2, 2], [1, 2], [1, 1]]


@pytest.fixture
def cases(repository):
    return repository / "tests/cases"


def write(path, geometry):
    path.write_text(json.dumps(geometry))
    return path


@pytest.mark.parametrize(
    ("case", "area"),
    [
        ("05_geojson_ring_direction/j03_mixed_orient.geojson", 25),
        ("05_geojson_ring_direction/j24_3_cw_1_ccw.geojson", 36),
        ("05_geojson_ring_direction/h02_mixed.shp", 25),
        ("25_geojson_cancelled_polygon/k2.geojson", 1),
        ("41_lines_beside_polygons/road_loop.geojson", 100),
        ("42_self_crossing_ring/bowtie.geojson", 42.5),
        ("43_small_far_parts/two_islands.geojson", 0.5),
    ],
)
def test_areas_of_maps_do_not_depend_on_directions(cases, case, area):
    assert abs(area_of(cases / case)) == pytest.approx(area)


@pytest.mark.parametrize(
    ("case", "line"),
    [
        ("05_geojson_ring_direction/j24_3_cw_1_ccw.geojson", "changed: 1 rings turned"),
        ("41_lines_beside_polygons/road_loop.geojson", "left out: 1 lines beside polygons"),
        ("42_self_crossing_ring/bowtie.geojson", "(feature 0, ring 0)"),
        ("38_covered_many_times/same_square_six_times.geojson", "noted: 5 rings that are copies"),
    ],
)
def test_remarks_name_what_was_done(cases, case, line):
    assert line in remarks_of(cases / case)


@pytest.mark.parametrize(
    ("case", "found"),
    [
        ("47_json_messages/list_of_features.json", "the file is a list of 40 features"),
        ("47_json_messages/multipolygon_flat.geojson", "0 where a position belongs"),
    ],
)
def test_messages_on_json_are_one_line_and_name_the_feature(cases, case, found):
    with pytest.raises(GeometryError) as caught:
        read_file(cases / case)
    assert found in caught.value.found
    assert len(caught.value.found) < 120
    assert "\n" not in caught.value.found
    assert "flat" not in case or "feature 0 (MultiPolygon)" in caught.value.where


def test_agreeing_rings_stay_as_they_are_whatever_their_direction(tmp_path):
    for ring, hole in ((SQUARE, HOLE[::-1]), (SQUARE[::-1], HOLE)):
        polygon = {"type": "Polygon", "coordinates": [ring, hole]}
        reading = read_file(write(tmp_path / "a.geojson", polygon))
        assert reading.geometry.points.tolist() == [*ring, *hole]
        assert reading.remarks == ()


def test_a_hole_beside_its_outer_ring_removes_nothing(tmp_path):
    beside = [[x + 9, y] for x, y in HOLE]
    path = write(tmp_path / "a.geojson", {"type": "Polygon", "coordinates": [SQUARE, beside]})
    assert area_of(path) == 16
    assert "left out: 1 holes beside the outer ring" in remarks_of(path)


def test_lines_and_points_beside_polygons_are_counted(tmp_path):
    items = [
        {"type": "Polygon", "coordinates": [SQUARE]},
        {"type": "MultiLineString", "coordinates": [[[0, 0], [9, 0]], [[0, 1], [9, 1]]]},
        {"type": "MultiPoint", "coordinates": [[1, 1], [2, 2], [3, 3]]},
    ]
    path = write(tmp_path / "a.geojson", {"type": "GeometryCollection", "geometries": items})
    assert area_of(path) == 16
    assert "left out: 2 lines" in remarks_of(path)
    assert "left out: 3 points" in remarks_of(path)


def test_lines_bound_an_area_where_a_file_has_nothing_else(tmp_path):
    lines = [[[0, 0], [4, 0]], [[0, 4], [0, 0]], [[4, 4], [4, 0]], [[4, 4], [0, 4]]]
    path = write(tmp_path / "a.geojson", {"type": "MultiLineString", "coordinates": lines})
    assert abs(area_of(path)) == 16


def test_a_slip_of_the_pen_is_noted_and_kept(tmp_path):
    ring = [[0, 0], [100, 0], [100, 100], [0.0, 100], [0, 50], [-0.1, 50.5], [0.1, 50.5], [0, 50]]
    path = write(tmp_path / "a.geojson", {"type": "Polygon", "coordinates": [[*ring, [0, 0]]]})
    assert len(read_file(path).geometry.points) == 9
    assert "lose less than a thousandth" in remarks_of(path)


def test_rings_of_shapefiles_are_holes_by_nesting(tmp_path, cases):
    shapefile = pytest.importorskip("shapefile")
    for hole in (HOLE, HOLE[::-1]):
        with shapefile.Writer(str(tmp_path / "a.shp"), shapeType=shapefile.POLYGON) as writer:
            writer.field("name", "C")
            writer.poly([SQUARE[::-1], hole])
            writer.record("one")
        assert area_of(tmp_path / "a.shp") == -15
    shutil.copy(cases / "05_geojson_ring_direction/h02_mixed.shp", tmp_path / "b.shp")
    assert "changed: 1 rings turned" in remarks_of(tmp_path / "b.shp")
