"""Surface files of every format, and broken ones."""

import numpy as np
import pytest
import pyvista
import trimesh

from tusqh.errors import GeometryError
from tusqh.geometry.canonical import load_geometry, write_geometry
from tusqh.geometry.defects import describe_defects
from tusqh.geometry.packaged import locate
from tusqh.geometry.soup import Soup
from tusqh.readers.files import read_file
from tusqh.readers.formats import dimension_of

TETRAHEDRON = trimesh.Trimesh(
    [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    process=False,
)


def corners(soup):
    """Return the triangles as sets of coordinates, in an order independent of the file."""
    places = soup.points[soup.triangles]
    places = np.stack([np.roll(p, -np.lexsort(p.T[::-1])[0], axis=0) for p in places])
    return places[np.lexsort(places.reshape(len(places), -1).T[::-1])]


def defects(soup):
    return describe_defects(soup).set_index("defect")["count"].to_dict()


@pytest.mark.parametrize(
    "suffix", ["stl", "ascii.stl", "obj", "ply", "off", "glb", "vtk", "vtu", "vtp"]
)
def test_every_format_gives_the_same_triangles(tmp_path, suffix):
    path = tmp_path / f"part.{suffix}"
    surface = pyvista.wrap(TETRAHEDRON)
    if suffix == "ascii.stl":
        path.write_text(TETRAHEDRON.export(file_type="stl_ascii"))
    elif suffix == "vtu":
        surface.cast_to_unstructured_grid().save(path)
    elif suffix.startswith("vt"):
        surface.save(path)
    else:
        TETRAHEDRON.export(path)
    soup = read_file(path).geometry
    expected = Soup(TETRAHEDRON.vertices, np.asarray(TETRAHEDRON.faces), np.zeros(4, dtype=int))
    assert np.allclose(corners(soup), corners(expected), atol=1e-7)
    found = defects(soup)
    assert (found["triangles"], found["boundary_edges"], found["shells"]) == (4, 0, 1)


def test_quads_and_polygons_are_cut_into_triangles(tmp_path):
    (tmp_path / "house.obj").write_text(
        "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 3 0\nv 0 2 0\nf 1 2 3 5\nf 5 3 4\n"
    )
    assert len(read_file(tmp_path / "house.obj").geometry.triangles) == 3
    (tmp_path / "pentagon.off").write_text(
        "OFF\n5 1 0\n0 0 0\n2 0 0\n2 2 0\n1 3 0\n0 2 0\n5 0 1 2 3 4\n"
    )
    assert len(read_file(tmp_path / "pentagon.off").geometry.triangles) == 3


def test_parts_are_kept_apart_and_nothing_is_merged(tmp_path):
    scene = trimesh.Scene([TETRAHEDRON, TETRAHEDRON.copy().apply_translation([3, 0, 0])])
    scene.export(tmp_path / "two.glb")
    soup = read_file(tmp_path / "two.glb").geometry
    assert np.bincount(soup.parts).tolist() == [4, 4]
    doubled = trimesh.Trimesh(
        TETRAHEDRON.vertices, np.concatenate([TETRAHEDRON.faces] * 2), process=False
    )
    doubled.export(tmp_path / "doubled.ply")
    soup = read_file(tmp_path / "doubled.ply").geometry
    assert len(soup.triangles) == 8
    assert defects(soup)["duplicate_triangles"] == 4


def test_defects_are_counted_by_hand():
    points = np.asarray(TETRAHEDRON.vertices)
    faces = np.asarray(TETRAHEDRON.faces)
    clean = defects(Soup(points, faces, np.zeros(4, dtype=int)))
    dirt = [k for k in clean if k not in ("triangles", "parts", "shells")]
    assert all(clean[k] == 0 for k in dirt)
    flipped = faces.copy()
    flipped[0] = flipped[0][::-1]
    assert defects(Soup(points, flipped, np.zeros(4, dtype=int)))["inconsistent_edges"] == 3
    assert defects(Soup(points, faces[:, ::-1], np.zeros(4, dtype=int)))["signed_volume"] == 1
    opened = defects(Soup(points, faces[1:], np.zeros(3, dtype=int)))
    assert (opened["boundary_edges"], opened["unbalanced_edges"]) == (3, 3)
    fin = np.concatenate([faces, [[0, 1, 4]]])
    more = np.concatenate([points, [[0.5, -1.0, 0.0]]])
    assert defects(Soup(more, fin, np.zeros(5, dtype=int)))["non_manifold_edges"] == 1
    flat = np.concatenate([faces, [[0, 1, 1]]])
    assert defects(Soup(points, flat, np.zeros(5, dtype=int)))["degenerate_triangles"] == 1
    # Two tetrahedra that meet in one corner.
    both = Soup(
        np.concatenate([points, -points]),
        np.concatenate([faces, faces[:, ::-1] + 4]),
        np.zeros(8, dtype=int),
    )
    found = defects(both)
    assert (found["shells"], found["non_manifold_vertices"]) == (2, 1)
    assert found["self_intersecting_triangles"] in (0, -1)


def test_the_canonical_file_is_equal_in_every_bit(tmp_path):
    soup = read_file(locate("package:pyvista/examples/airplane.ply")).geometry
    write_geometry(tmp_path / "geometry.vtp", soup)
    back = load_geometry(tmp_path / "geometry.vtp")
    assert np.array_equal(back.points, soup.points)
    assert np.array_equal(back.triangles, soup.triangles)
    assert np.array_equal(back.parts, soup.parts)
    assert back.name == "airplane.ply"
    first = (tmp_path / "geometry.vtp").read_bytes()
    write_geometry(tmp_path / "geometry.vtp", soup)
    assert (tmp_path / "geometry.vtp").read_bytes() == first


def test_suffixes_tell_the_dimension():
    assert [dimension_of(f"a.{s}") for s in ("stl", "PLY", "svg", "geojson")] == [3, 3, 2, 2]
    assert dimension_of("package:pyvista/examples/airplane.ply") == 3


def test_a_package_that_is_not_there():
    with pytest.raises(GeometryError, match="has no file"):
        locate("package:numpy/nothing.stl")
    with pytest.raises(GeometryError, match="pip install"):
        locate("package:no-such-package/a.stl")


def broken_stl(tmp_path):
    content = TETRAHEDRON.export(file_type="stl")
    return {
        "truncated.stl": content[:-30],
        "header_only.stl": content[:84],
        "short.stl": content[:50],
        "ascii_cut.stl": TETRAHEDRON.export(file_type="stl_ascii")[:200].encode(),
        "noise.ply": b"ply\nformat binary_little_endian 1.0\n\x00\x01",
        "cut.ply": TETRAHEDRON.export(file_type="ply")[:-20],
        "empty.off": b"OFF\n0 0 0\n",
        "out_of_range.off": b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n",
        "nan.obj": b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n",
        "points.obj": b"v 0 0 0\nv 1 0 0\n",
        "point.off": b"OFF\n3 1 0\n1 1 1\n1 1 1\n1 1 1\n3 0 1 2\n",
        "empty.stl": b"",
        "text.vtp": b"not a mesh",
    }


@pytest.mark.parametrize("name", list(broken_stl(None)))
def test_broken_files_are_explained(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(broken_stl(tmp_path)[name])
    with pytest.raises(GeometryError) as caught:
        read_file(path)
    assert name in str(caught.value)
    assert "remedy" in str(caught.value)


def test_a_missing_file_is_explained(tmp_path):
    with pytest.raises(GeometryError, match="there is no such file"):
        read_file(tmp_path / "part.stl")
