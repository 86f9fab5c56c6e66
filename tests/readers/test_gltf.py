"""Content of glTF: strips, sparse accessors, mirrored nodes, and contradictory files."""

import base64
import json

import numpy as np
import pytest

from tusqh.errors import GeometryError
from tusqh.geometry.soup_facts import SoupFacts
from tusqh.readers.files import read_file

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype="<f4")
FACES = np.array([0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3], dtype="<u2")
STRIP = np.array([0, 1, 3, 2, 0, 1], dtype="<u2")


def document(corners=FACES, **changes):
    content = POINTS.tobytes() + corners.tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(content).decode()
    result = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
             "min": [0, 0, 0], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5123, "count": len(corners), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": len(content) - 48},
        ],
        "buffers": [{"byteLength": len(content), "uri": uri}],
    }  # fmt: skip
    return result | changes


def read(tmp_path, content):
    path = tmp_path / "part.gltf"
    path.write_text(json.dumps(content))
    return read_file(path)


def volume(reading):
    return SoupFacts(reading.geometry).signed_volume


def test_a_mirrored_and_moved_node_still_points_outwards(tmp_path):
    node = {"mesh": 0, "scale": [-2, 1, 1], "translation": [5, 0, 0]}
    reading = read(tmp_path, document(nodes=[node]))
    assert volume(reading) == pytest.approx(2 / 6)
    assert reading.geometry.bounding_box() == ((3, 0, 0), (5, 1, 1))


def test_strips_are_cut_with_alternating_directions(tmp_path):
    content = document(STRIP)
    content["meshes"][0]["primitives"][0]["mode"] = 5
    assert abs(volume(read(tmp_path, content))) == pytest.approx(1 / 6)


def test_sparse_accessors_replace_points(tmp_path):
    content = document()
    extra = np.array([3, 0], dtype="<u2").tobytes() + np.array([0, 0, 5], dtype="<f4").tobytes()
    uri = "data:;base64," + base64.b64encode(extra).decode()
    content["buffers"].append({"byteLength": 16, "uri": uri})
    content["bufferViews"] += [
        {"buffer": 1, "byteLength": 2},
        {"buffer": 1, "byteOffset": 4, "byteLength": 12},
    ]
    content["accessors"][0]["max"] = [1, 1, 5]
    content["accessors"][0]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": 2, "componentType": 5123},
        "values": {"bufferView": 3},
    }
    assert volume(read(tmp_path, content)) == pytest.approx(5 / 6)


def test_points_lines_and_meshes_outside_the_scene_are_named(tmp_path):
    content = document(nodes=[{"mesh": 0}, {"mesh": 0}])
    content["meshes"][0]["primitives"].append({"attributes": {"POSITION": 0}, "mode": 1})
    remarks = "\n".join(map(str, read(tmp_path, content).remarks))
    assert "left out: 1 sets of points or lines" in remarks
    assert "left out: 1 meshes outside the scene" in remarks


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ({"extensionsRequired": ["EXT_other"]}, "EXT_other is required and not supported"),
        ({"buffers": [{"byteLength": 9, "uri": "none.bin"}]}, "there is no such file"),
        ({"nodes": [{"mesh": 3}]}, "entry 3 of 1 meshes"),
        ({"nodes": [{"mesh": 0, "children": [0]}]}, "placed twice"),
        ({"asset": {"version": "1.0"}}, "the version is 1.0"),
    ],
)
def test_what_cannot_be_read_is_refused_by_name(tmp_path, changes, found):
    with pytest.raises(GeometryError, match=found):
        read(tmp_path, document(**changes))


def test_extremes_that_the_file_states_are_compared(tmp_path):
    content = document()
    content["accessors"][0]["max"] = [1, 1, 7]
    with pytest.raises(GeometryError, match="accessor 0 states extremes"):
        read(tmp_path, content)
