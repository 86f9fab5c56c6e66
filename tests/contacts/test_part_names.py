"""The names of parts in files become the names of materials."""

import json

import numpy as np
import pytest
import trimesh
from shapes import box

import tusqh
from tusqh.geometry.canonical import load_geometry, write_geometry
from tusqh.geometry.soup import Soup
from tusqh.geometry.split_parts import split_parts
from tusqh.pipeline.materials.part_names import name_parts
from tusqh.readers.files import read_file

BOXES = [box((3.0 * k, 0, 0), (3.0 * k + 2, 2, 2)) for k in range(4)]


def text_of_stl(names):
    """Return the text of an STL file with a solid for each name."""
    lines = []
    for name, one in zip(names, BOXES, strict=False):
        lines.append(f"solid {name}")
        for triangle in one.points[one.triangles].tolist():
            lines += ["facet normal 0 0 0", "outer loop"]
            lines += [f"vertex {x} {y} {z}" for x, y, z in triangle]
            lines += ["endloop", "endfacet"]
        lines.append(f"endsolid {name}")
    return "\n".join(lines) + "\n"


def text_of_obj(heads):
    """Return the text of an OBJ file with some lines before the faces of each box."""
    lines = []
    for k, (head, one) in enumerate(zip(heads, BOXES, strict=False)):
        lines += [f"v {x} {y} {z}" for x, y, z in one.points.tolist()]
        lines += head
        lines += ["f " + " ".join(str(c + 1 + 8 * k) for c in t) for t in one.triangles.tolist()]
    return "\n".join(lines) + "\n"


def named(path):
    """Return the names of the parts of a file, the lowest x of each, and the remarks."""
    found, remarks = name_parts(split_parts(read_file(path).geometry))
    lowest = [part.bounding_box()[0][0] for part in found.values()]
    assert lowest == [3.0 * k for k in range(len(found))]
    return list(found), "".join(map(str, remarks))


def test_solids_of_stl(tmp_path):
    path = tmp_path / "a.stl"
    path.write_text(text_of_stl(["Outer Ring", "ball", "", "ball"]))
    names, remarks = named(path)
    assert names == ["Outer Ring", "ball", "part_3", "ball_2"]
    assert "part 4 'ball', now ball_2" in remarks
    path.write_text(text_of_stl(["solid void", "void"]))
    names, remarks = named(path)
    assert names == ["solid void", "void_2"]
    assert "part 2 'void', now void_2" in remarks
    # One solid of several pieces: the pieces have numbers.  One piece has the name of its solid.
    whole = trimesh.util.concatenate([trimesh.Trimesh(b.points, b.triangles) for b in BOXES[:2]])
    path.write_text("solid both\n" + whole.export(file_type="stl_ascii").partition("\n")[2])
    assert named(path) == (["part_1", "part_2"], "")
    path.write_text(text_of_stl(["ring"]))
    assert named(path) == (["ring"], "")
    # A binary file has no names.
    whole.export(path)
    assert named(path) == (["part_1", "part_2"], "")


def test_objects_and_groups_of_obj(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(text_of_obj([["o ring"], ["o part_4"], ["o ring"], ["o"]]))
    names, remarks = named(path)
    assert names[:3] == ["ring", "part_4", "ring_2"]
    assert "part 3 'ring', now ring_2" in remarks
    path.write_text(text_of_obj([["g outer ring"], ["g ball", "o part"], ["g"], ["s 1"]]))
    assert named(path)[0] == ["part_1", "part"]
    path.write_text(text_of_obj([["g outer ring"], ["g ball"], ["g shaft"], ["g ball"]]))
    found, remarks = name_parts(split_parts(read_file(path).geometry))
    assert [len(part.triangles) for part in found.values()] == [12, 24, 12]
    assert list(found) == ["outer ring", "ball", "shaft"]
    assert not remarks


def test_groups_of_obj_that_are_patches_of_one_surface_are_not_parts(tmp_path):
    path = tmp_path / "a.obj"
    text = text_of_obj([["g front"], ["g back"]]).splitlines()
    faces = [k for k, line in enumerate(text) if line.startswith("f")]
    text.insert(faces[5], "g side")
    path.write_text("\n".join(text) + "\n")
    assert named(path) == (["part_1", "part_2"], "")
    assert len(np.unique(read_file(path).geometry.parts)) == 1


def test_nodes_of_gltf_and_of_scenes(tmp_path):
    scene = trimesh.Scene()
    for k, name in enumerate(("ring", "ball")):
        mesh = trimesh.Trimesh(BOXES[k].points, BOXES[k].triangles)
        scene.add_geometry(mesh, node_name=name, geom_name=f"mesh {name}")
    scene.export(tmp_path / "a.glb")
    assert named(tmp_path / "a.glb") == (["ring", "ball"], "")
    assert tusqh.mesh(scene, cells=10, materials="parts").built.names == ("ring", "ball", "void")
    scene.export(tmp_path / "a.gltf")
    document = json.loads((tmp_path / "a.gltf").read_bytes())
    for node in document["nodes"]:
        if node.get("name") == "ring":
            del node["name"]
        if node.get("name") == "ball":
            node["name"] = "mesh ring"
    (tmp_path / "a.gltf").write_text(json.dumps(document))
    names, remarks = named(tmp_path / "a.gltf")
    assert names == ["mesh ring", "mesh ring_2"]
    assert "part 2 'mesh ring', now mesh ring_2" in remarks


def feature(x, **properties):
    """Return a feature of GeoJSON: two squares, one above the other."""
    squares = [[[[x, y], [x + 2, y], [x + 2, y + 2], [x, y + 2], [x, y]]] for y in (0.0, 5.0)]
    geometry = {"type": "MultiPolygon", "coordinates": squares}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def test_features_of_geojson(tmp_path):
    path = tmp_path / "a.geojson"
    features = [feature(0, NAME="Kent"), feature(3, name="Kent"), feature(6), feature(9, name=5)]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    names, remarks = named(path)
    assert names == ["Kent", "Kent_2", "part_3", "5"]
    assert "part 2 'Kent', now Kent_2" in remarks
    found = tusqh.mesh(path, cells=11, materials={"Kent_2": 0.5}, rest="water")
    rows = found.materials.set_index("material")
    assert rows["betti_0_measured"].to_dict() == {
        "Kent": 2, "Kent_2": 2, "part_3": 2, "5": 2, "water": 1, "all": 1,
    }  # fmt: skip
    assert rows["volume"].to_dict()["Kent"] == pytest.approx(8)


def test_the_canonical_file_keeps_parts_and_names(tmp_path):
    (tmp_path / "a.geojson").write_text(
        json.dumps({"type": "FeatureCollection", "features": [feature(0, name="Ærø"), feature(3)]})
    )
    (tmp_path / "a.stl").write_text(text_of_stl(["ring", "ball"]))
    for name in ("a.geojson", "a.stl"):
        before = read_file(tmp_path / name).geometry
        write_geometry(tmp_path / "a.vtp", before)
        after = load_geometry(tmp_path / "a.vtp")
        assert after.part_names == before.part_names != ()
        assert np.array_equal(after.parts, before.parts)


def test_wishes_name_the_parts(tmp_path):
    (tmp_path / "a.stl").write_text(text_of_stl(["ring", "ball"]))
    found = tusqh.mesh(tmp_path / "a.stl", cells=5, materials={"ball": (1, 0, 0)})
    assert found.built.names == ("ring", "ball", "void")
    with pytest.raises(tusqh.errors.ConfigError, match="one of ring, ball"):
        tusqh.mesh(tmp_path / "a.stl", cells=5, materials={"part_1": 0.5})


def test_a_part_without_a_name_has_another_name_than_the_others():
    soup = Soup.from_parts(
        [(b.points, b.triangles) for b in BOXES], part_names=["part_2", "", "part_2", ""]
    )
    assert list(name_parts(split_parts(soup))[0]) == ["part_2", "part_2_2", "part_2_3", "part_4"]
