"""Units of length: what a file states, what the user states, and conversion, up to the exports."""

import json
import math

import ezdxf
import netCDF4
import nrrd
import numpy as np
import pandas as pd
import pytest
import trimesh

import tusqh
from tusqh.errors import GeometryError, TusqhError
from tusqh.geometry.canonical import load_geometry, write_geometry
from tusqh.geometry.units import METRES
from tusqh.meshes.export import read_vtu
from tusqh.readers.files import read_file
from tusqh.settings.lengths import Lengths


def box_of(path, **lengths):
    """Return the unit and the box of a file."""
    reading = read_file(path, lengths=Lengths(**lengths))
    assert reading.unit == reading.geometry.unit
    return reading.unit, np.array(reading.geometry.bounding_box())


def write_dxf(path, code):
    drawing = ezdxf.new("R2000")
    drawing.header["$INSUNITS"] = code
    drawing.modelspace().add_lwpolyline([(1, 2), (4, 2), (4, 8), (1, 8)], close=True)
    drawing.saveas(path)


def test_the_unit_is_that_of_the_file_then_that_of_the_settings(tmp_path):
    write_dxf(tmp_path / "a.dxf", 4)
    assert box_of(tmp_path / "a.dxf")[0] == "mm"
    assert box_of(tmp_path / "a.dxf", unit="millimeter")[0] == "mm"
    trimesh.creation.box((1, 2, 3)).export(tmp_path / "a.stl")
    reading = read_file(tmp_path / "a.stl")
    assert (reading.unit, reading.unit_source) == ("", "none")
    reading = read_file(tmp_path / "a.stl", lengths=Lengths(unit="inch"))
    assert (reading.unit, reading.unit_source) == ("in", "settings")


def test_a_unit_is_converted_and_a_scale_multiplied(tmp_path):
    write_dxf(tmp_path / "a.dxf", 1)
    unit, box = box_of(tmp_path / "a.dxf", convert_to="mm")
    assert unit == "mm"
    assert box == pytest.approx(25.4 * np.array([[1, 2], [4, 8]]))
    unit, box = box_of(tmp_path / "a.dxf", scale=10)
    assert unit == "in"
    assert box == pytest.approx(10.0 * np.array([[1, 2], [4, 8]]))
    said = [
        str(remark) for remark in read_file(tmp_path / "a.dxf", lengths=Lengths(scale=10)).remarks
    ]
    assert said == ["changed: 1 scale: lengths multiplied by 10"]


def test_every_pair_of_units_is_converted_there_and_back(tmp_path):
    box = trimesh.creation.box((1, 2, 3))
    box.export(tmp_path / "a.stl")
    for one in METRES:
        unit, found = box_of(tmp_path / "a.stl", unit=one, convert_to="m")
        assert unit == "m"
        assert found / METRES[one] == pytest.approx(box.bounds)


def test_a_unit_that_contradicts_the_file_is_refused(tmp_path):
    write_dxf(tmp_path / "a.dxf", 1)
    with pytest.raises(GeometryError) as caught:
        box_of(tmp_path / "a.dxf", unit="mm")
    assert caught.value.found == "the file states in, and `unit` is mm"
    assert "give `scale: 0.0393700787` instead" in caught.value.remedy
    trimesh.creation.box((1, 2, 3)).export(tmp_path / "a.glb")
    with pytest.raises(GeometryError) as caught:
        box_of(tmp_path / "a.glb", unit="mm")
    assert caught.value.found == "files of the format glTF are in m, and `unit` is mm"
    # What the remedy says gives the numbers of the file, in millimetres.
    unit, box = box_of(tmp_path / "a.glb", scale=0.001, convert_to="mm")
    assert unit == "mm"
    assert np.ptp(box, axis=0) == pytest.approx([1, 2, 3])


def test_a_conversion_needs_units_of_known_size(tmp_path):
    trimesh.creation.box((1, 2, 3)).export(tmp_path / "a.stl")
    with pytest.raises(GeometryError, match="does not state its unit of length"):
        box_of(tmp_path / "a.stl", convert_to="m")
    with pytest.raises(GeometryError, match="the size of the unit 'px' is not known"):
        box_of(tmp_path / "a.stl", unit="px", convert_to="m")
    with pytest.raises(GeometryError, match="the size of the unit 'bananas' is not known"):
        box_of(tmp_path / "a.stl", unit="mm", convert_to="bananas")


@pytest.mark.parametrize(
    ("attributes", "unit", "side"),
    [
        ('width="80mm" height="40mm" viewBox="0 0 80 40"', "mm", 20),
        ('width="80mm" height="40mm" viewBox="0 0 160 80"', "mm", 10),
        ('width="8cm" viewBox="0 0 160 80"', "cm", 1),
        ('width="2in" height="9in" viewBox="0 0 160 80"', "in", 0.25),
        ('width="144pt" height="72pt" viewBox="0 0 160 80"', "in", 0.25),
        ('width="80mm" height="40mm"', "mm", 20 * 25.4 / 96),
        ('width="80" height="40" viewBox="0 0 80 40"', "", 20),
        ('width="80px" height="100%" viewBox="0 0 80 40"', "", 20),
        ("", "", 20),
    ],
)
def test_an_svg_is_in_the_unit_of_its_width(tmp_path, attributes, unit, side):
    text = f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>'
    (tmp_path / "a.svg").write_text(text + '<rect x="4" y="8" width="20" height="20"/></svg>')
    found, box = box_of(tmp_path / "a.svg")
    assert found == unit
    assert np.ptp(box, axis=0) == pytest.approx([side, side])
    assert box[0] == pytest.approx([0.2 * side, -1.4 * side])


def test_the_voxels_of_an_image_are_converted(tmp_path):
    header = {"space units": ["mm"] * 3, "space directions": np.diag([2.0] * 3), "space": "RAS"}
    header["space origin"] = [10.0, 20.0, 30.0]
    voxels = np.ones((3, 4, 5), dtype=np.uint8)
    nrrd.write(str(tmp_path / "a.nrrd"), voxels, header)
    unit, box = box_of(tmp_path / "a.nrrd", convert_to="m")
    assert unit == "m"
    assert box == pytest.approx(1e-3 * np.array([[9, 19, 29], [15, 27, 39]]))


def test_the_unit_reaches_every_file_and_table(tmp_path):
    write_dxf(tmp_path / "a.dxf", 1)
    result = tusqh.mesh(tmp_path / "a.dxf", convert_to="mm", cells=8, placement="corner")
    assert result.mesh.unit == "mm"
    assert result.reading["unit"] == {"name": "mm", "source": "file"}
    assert result.mesh.measurement.volume == pytest.approx(18 * 25.4**2)
    result.save(tmp_path / "out")
    assert read_vtu(tmp_path / "out/mesh.vtu").unit == "mm"
    assert load_geometry(tmp_path / "out/geometry.vtp").unit == "mm"
    elements = pd.read_csv(tmp_path / "out/elements.csv").set_index("metric")
    assert elements["unit"]["area"] == "mm^2"
    assert "mm" in set(pd.read_csv(tmp_path / "out/defects.csv")["unit"])
    assert json.loads((tmp_path / "out/reading.json").read_text())["unit"]["name"] == "mm"
    for name in ("a.mesh", "a.inp", "a.exo"):
        result.write(tmp_path / name)
    assert "# Unit of length: mm\n" in (tmp_path / "a.mesh").read_text()
    assert "** Unit of length: mm\n" in (tmp_path / "a.inp").read_text()
    with netCDF4.Dataset(tmp_path / "a.exo") as file:
        assert file.unit_of_length == "mm"


def test_a_fitted_mesh_has_the_unit_too(tmp_path):
    write_dxf(tmp_path / "a.dxf", 5)
    assert tusqh.mesh(tmp_path / "a.dxf", cells=8, fit=True).mesh.unit == "cm"


def test_a_geometry_keeps_its_unit_in_the_canonical_file(tmp_path):
    for kind in ([[0.0, 0], [1, 0], [0, 1]], [[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]):
        source = (
            np.array(kind),
            np.array([[0, 1], [1, 2], [2, 0]] if len(kind[0]) == 2 else [[0, 1, 2]]),
        )
        geometry = tusqh.pipeline.ingest.ingest(source, lengths=Lengths(unit="ft"))
        write_geometry(tmp_path / "a.vtp", geometry)
        assert load_geometry(tmp_path / "a.vtp").unit == "ft"


def test_materials_of_different_units_are_refused_and_converted(tmp_path):
    trimesh.creation.box((2, 2, 2)).export(tmp_path / "outer.glb")
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "inner.stl")
    files = [tmp_path / "inner.stl", tmp_path / "outer.glb"]
    with pytest.raises(TusqhError, match="inner: not stated, outer: m"):
        tusqh.mesh(files, cells=8)
    result = tusqh.mesh(files, cells=8, unit="m")
    assert result.mesh.unit == "m"
    assert result.materials.set_index("material")["volume"]["all"] == pytest.approx(8)


def test_the_same_mesh_is_made_in_every_unit(tmp_path):
    """A solid in millimetres or inches, converted to metres, has the same mesh."""
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.3)
    expected = tusqh.mesh((ball.vertices, ball.faces), unit="m", cells=12).mesh
    for unit in ("mm", "in", "ft"):
        source = ball.vertices / METRES[unit], ball.faces
        found = tusqh.mesh(source, unit=unit, convert_to="m", cells=12).mesh
        assert np.array_equal(found.cells, expected.cells)
        assert found.points == pytest.approx(expected.points, abs=1e-12)
        assert math.isclose(found.measurement.volume, expected.measurement.volume)
