"""The files beside a geometry file that are read with it are known without reading it."""

import json

import nrrd
import numpy as np
import pytest
import shapefile
from samples import write_dicom, write_metaimage, write_surfaces

from tusqh.readers.beside import files_beside


def names_beside(path):
    return [other.name for other in files_beside(path)]


def test_a_shapefile_has_its_system(tmp_path):
    path = tmp_path / "a.shp"
    with shapefile.Writer(str(tmp_path / "a"), shapeType=shapefile.POLYGON) as writer:
        writer.field("n", "N")
        writer.poly([[[0, 0], [0, 1], [1, 1], [0, 0]]])
        writer.record(1)
    assert names_beside(path) == []
    (tmp_path / "a.prj").write_text("")
    assert names_beside(path) == ["a.prj"]


def test_a_slice_has_the_other_slices(tmp_path):
    for k in range(3):
        write_dicom(tmp_path / f"{k}.dcm", np.zeros((2, 2)), first=(0, 0, k))
    (tmp_path / "notes.txt").write_text("")
    assert names_beside(tmp_path / "1.dcm") == ["0.dcm", "2.dcm"]


def test_headers_name_their_data(tmp_path):
    image = np.zeros((2, 3, 4), dtype=np.uint8)
    nrrd.write(str(tmp_path / "a.nhdr"), image, {"encoding": "raw"})
    assert names_beside(tmp_path / "a.nhdr") == ["a.raw"]
    write_metaimage(tmp_path / "b.mhd", image, np.eye(3), np.zeros(3))
    assert names_beside(tmp_path / "b.mhd") == ["b.zraw"]
    nrrd.write(str(tmp_path / "c.nrrd"), image)
    write_metaimage(tmp_path / "c.mha", image, np.eye(3), np.zeros(3))
    assert names_beside(tmp_path / "c.nrrd") == names_beside(tmp_path / "c.mha") == []


def test_gltf_names_its_buffers_and_nothing_leaves_the_folder(tmp_path):
    folder = tmp_path / "inner"
    folder.mkdir()
    write_surfaces(folder)
    assert names_beside(folder / "box.gltf") == []
    (folder / "a b.bin").write_bytes(b"0")
    (tmp_path / "outer.bin").write_bytes(b"0")
    uris = [{"uri": "a%20b.bin"}, {"uri": "../outer.bin"}, {"uri": "missing.bin"}, {}]
    (folder / "a.gltf").write_text(json.dumps({"buffers": uris}))
    assert names_beside(folder / "a.gltf") == ["a b.bin"]


@pytest.mark.parametrize("name", ["a.stl", "a.gltf", "a.nhdr", "a.shp", "a.dcm"])
def test_damaged_and_missing_files_have_none(tmp_path, name):
    assert files_beside(tmp_path / name) == []
    (tmp_path / name).write_bytes(b"\0\xff[1")
    assert files_beside(tmp_path / name) == []
