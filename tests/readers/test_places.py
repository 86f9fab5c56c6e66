"""Longitudes and latitudes: recognised, refused, projected, cut at the date line."""

import json
import math

import numpy as np
import pyproj
import pytest
import shapefile
import shapely

import tusqh
from tusqh.errors import ConfigError, GeometryError
from tusqh.readers.files import read_file
from tusqh.readers.places import look_like_degrees
from tusqh.settings.lengths import Lengths

#: About one square kilometre near Annapolis, in degrees.
BAY = [[-76.5001, 38.9], [-76.4886, 38.9], [-76.4886, 38.909], [-76.5001, 38.909], [-76.5001, 38.9]]
EARTH = pyproj.Geod(ellps="WGS84")


def write(path, *polygons, crs=None):
    """Write polygons, each a list of rings, as GeoJSON."""
    document = {"type": "MultiPolygon", "coordinates": list(polygons)}
    if crs:
        document["crs"] = {"type": "name", "properties": {"name": crs}}
    path.write_text(json.dumps(document))
    return path


def area_of(path, **lengths):
    """Return the area of a map, and its reading."""
    reading = read_file(path, lengths=Lengths(**lengths))
    outline = reading.geometry
    a, b = outline.points[outline.segments].transpose(1, 0, 2)
    return float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2), reading


def true_area(ring):
    lon, lat = np.array(ring).T
    return abs(EARTH.polygon_area_perimeter(lon, lat)[0])


def test_degrees_are_refused_with_the_remedy(tmp_path):
    with pytest.raises(GeometryError) as caught:
        read_file(write(tmp_path / "a.geojson", [BAY]))
    assert "longitudes and latitudes: they look like degrees" in caught.value.found
    assert "give `crs: utm` (--crs utm), here zone 18N, EPSG:32618" in caught.value.remedy
    square = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]
    path = write(tmp_path / "b.geojson", [square], crs="urn:ogc:def:crs:OGC:1.3:CRS84")
    with pytest.raises(GeometryError, match="the file states longitude and latitude"):
        read_file(path)
    assert area_of(path, crs="none")[0] == pytest.approx(16)
    assert area_of(write(tmp_path / "c.geojson", [square]))[0] == pytest.approx(16)


@pytest.mark.parametrize("crs", ["utm", "EPSG:32618", "EPSG:26918", "EPSG:2248"])
def test_degrees_are_projected(tmp_path, crs):
    area, reading = area_of(write(tmp_path / "a.geojson", [BAY]), crs=crs)
    unit = {"EPSG:2248": "us-ft"}.get(crs, "m")
    assert reading.unit == unit
    metres = {"m": 1.0, "us-ft": 1200 / 3937}[unit]
    assert area * metres**2 == pytest.approx(true_area(BAY), rel=1e-3)
    assert str(reading.remarks[0]).startswith("changed: 1 coordinates projected from longitude")


def test_a_projected_map_has_a_mesh_in_metres(tmp_path):
    path = write(tmp_path / "a.geojson", [BAY])
    result = tusqh.mesh(path, crs="utm", cells=8, threshold=0.5)
    assert result.mesh.unit == "m"
    assert result.mesh.measurement.volume == pytest.approx(true_area(BAY), rel=0.06)


def test_a_prj_file_states_the_system(tmp_path):
    with shapefile.Writer(str(tmp_path / "a"), shapeType=shapefile.POLYGON) as writer:
        writer.field("n", "N")
        writer.poly([BAY[::-1]])
        writer.record(1)
    prj = tmp_path / "a.prj"
    prj.write_text(pyproj.CRS.from_epsg(4269).to_wkt("WKT1_ESRI"))
    with pytest.raises(GeometryError, match="the file states GCS_North_American_1983"):
        read_file(tmp_path / "a.shp")
    area, reading = area_of(tmp_path / "a.shp", crs="utm")
    assert reading.unit == "m"
    assert abs(area) == pytest.approx(true_area(BAY), rel=1e-3)
    prj.write_text(pyproj.CRS.from_epsg(2248).to_wkt("WKT1_ESRI"))
    with pytest.raises(GeometryError) as caught:
        read_file(tmp_path / "a.shp")
    assert "and its coordinates go from (-76.5001, 38.9)" in caught.value.found
    assert caught.value.expected == "coordinates lengths in us-ft"


def test_a_projected_system_gives_the_unit_and_is_changed(tmp_path):
    change = pyproj.Transformer.from_crs("EPSG:4326", "EPSG:2248", always_xy=True)
    feet = np.column_stack(change.transform(*np.array(BAY).T)).tolist()
    path = write(tmp_path / "a.geojson", [feet], crs="urn:ogc:def:crs:EPSG::2248")
    area, reading = area_of(path)
    assert reading.unit == "us-ft"
    assert area * (1200 / 3937) ** 2 == pytest.approx(true_area(BAY), rel=1e-3)
    area, reading = area_of(path, crs="utm")
    assert reading.unit == "m"
    assert area == pytest.approx(true_area(BAY), rel=1e-3)


def test_systems_that_do_not_fit_are_refused(tmp_path):
    path = write(tmp_path / "a.geojson", [BAY])
    for crs, message in (
        ("EPSG:32633", "for longitudes from 12 to 18 .* the geometry is around longitude -76"),
        ("EPSG:4326", "whose coordinates are not lengths"),
        ("EPSG:999999", "`crs` is 'EPSG:999999'"),
    ):
        with pytest.raises(GeometryError, match=message):
            read_file(path, lengths=Lengths(crs=crs))
    large = (1000 * np.array(BAY)).tolist()
    stated = write(tmp_path / "b.geojson", [large], crs="EPSG:4326")
    with pytest.raises(GeometryError, match="the file states the coordinate system EPSG:4326, and"):
        read_file(stated)
    with pytest.raises(GeometryError, match="the file states no coordinate system"):
        read_file(write(tmp_path / "c.geojson", [large]), lengths=Lengths(crs="utm"))
    (tmp_path / "a.csv").write_text("x0,y0,x1,y1\n0,0,1,0\n1,0,0,1\n0,1,0,0\n")
    with pytest.raises(GeometryError, match="`crs` is given for a file of the format CSV"):
        read_file(tmp_path / "a.csv", lengths=Lengths(crs="utm"))
    arctic = [[10.5, 85], [20.5, 85], [20.5, 86], [10.5, 86], [10.5, 85]]
    with pytest.raises(GeometryError, match=r"around latitude 85\.\d, where there is no zone"):
        read_file(write(tmp_path / "d.geojson", [arctic]), lengths=Lengths(crs="utm"))


def ring_around(lon, lat, size):
    """Return a ring of many points, with longitudes from -180 to 180."""
    angle = np.linspace(0, 2 * math.pi, 181)
    ring = np.column_stack([lon + size * np.cos(angle), lat + size * np.sin(angle)])
    ring[:, 0] = (ring[:, 0] + 180) % 360 - 180
    ring[-1] = ring[0]
    return ring


@pytest.mark.parametrize("crs", ["utm", "EPSG:3832", "EPSG:6933"])
@pytest.mark.parametrize("is_cut", [False, True])
def test_rings_across_the_date_line_have_their_area(tmp_path, crs, is_cut):
    outer, hole = ring_around(179.7, -17.3, 1.0), ring_around(179.9, -17.3, 0.3)
    expected = true_area(outer) - true_area(hole)
    polygons = [[outer.tolist(), hole.tolist()]]
    if is_cut:  # As RFC 7946 asks for.
        east = [np.column_stack([ring[:, 0] % 360, ring[:, 1]]) for ring in (outer, hole)]
        whole = shapely.Polygon(east[0], [east[1]])
        polygons = []
        for low, shift in ((170, 0), (180, -360)):
            part = shapely.intersection(whole, shapely.box(low, -30, low + 10, 0))
            rings = [part.exterior, *part.interiors]
            polygons.append(
                [
                    shapely.transform(r, lambda c, s=shift: c + np.array([s, 0])).coords[:]
                    for r in rings
                ]
            )
    area, reading = area_of(write(tmp_path / "a.geojson", *polygons), crs=crs)
    if crs == "EPSG:3832":  # Mercator, whose areas grow away from the equator.
        expected /= math.cos(math.radians(17.3)) ** 2
    assert abs(area) == pytest.approx(expected, rel=0.01)
    width = np.ptp(np.array(reading.geometry.bounding_box())[:, 0])
    is_torn = crs == "EPSG:6933"
    assert (width > 1e7) == is_torn
    said = "\n".join(map(str, reading.remarks))
    assert ("cut at the date line" in said) == (is_torn and not is_cut)


def test_a_ring_around_a_pole_needs_a_polar_projection(tmp_path):
    lon = np.linspace(-180, 180, 73)
    ring = np.column_stack([lon, np.full(73, 75.0)]).tolist()
    path = write(tmp_path / "a.geojson", [ring])
    area, _ = area_of(path, crs="EPSG:3413")
    assert abs(area) == pytest.approx(math.pi * 1.64e6**2, rel=0.05)


def test_drawings_are_not_taken_for_degrees():
    rng = np.random.default_rng(5)
    angle = np.linspace(0, 6.28, 50)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    for size in (0.1, 1, 5):
        assert not look_like_degrees(size * circle)
        assert not look_like_degrees(size * (circle + 1))
    assert not look_like_degrees(rng.random((20, 2)) * 400)
    assert look_like_degrees(circle + np.array([-76, 38]))
    europe = rng.uniform([-10, 35], [40, 70], (100, 2))
    assert look_like_degrees(europe)


def test_settings_have_the_option(tmp_path):
    path = write(tmp_path / "a.geojson", [BAY])
    with pytest.raises(ConfigError):
        tusqh.mesh(path, crs=32618)


def test_coordinates_of_a_projection_keep_their_precision(tmp_path):
    """Millions of metres from the origin, a detail of a millimetre is still there."""
    square = np.array([[0, 0], [0.004, 0], [0.004, 0.003], [0, 0.003], [0, 0]])
    path = write(tmp_path / "a.geojson", [(square + np.array([388000, 4240000])).tolist()])
    result = tusqh.mesh(path, unit="m", cells=4, placement="corner")
    assert np.ptp(result.mesh.points, axis=0) == pytest.approx([0.004, 0.003], rel=1e-6)
    for name in ("a.vtu", "a.mesh", "a.msh", "a.exo"):
        result.write(tmp_path / name)
    result.write(tmp_path / "a.inp")
    text = (tmp_path / "a.inp").read_text()
    assert "relative to a point, so that they keep their digits: 388000, 4240000, 0\n" in text
    rows = text.partition("*NODE\n")[2].partition("*ELEMENT")[0].splitlines()
    numbers = np.array([row.split(",") for row in rows], dtype=float)[:, 1:3]
    assert np.array_equal(numbers + np.array([388000, 4240000]), result.mesh.points)
    again = tusqh.meshes.export.read_vtu(tmp_path / "a.vtu")
    assert np.array_equal(again.points, result.mesh.points)
