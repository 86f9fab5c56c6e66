"""Surface files of other programs have the right volume and box, or are refused with a reason.

The files are in tests/cases; the README there describes them.
"""

import struct
from pathlib import Path

import numpy as np
import pytest
import pyvista

from tusqh.errors import GeometryError
from tusqh.geometry.soup_facts import SoupFacts
from tusqh.readers.files import read_file

CASES = Path(__file__).parents[1] / "cases"
#: Most cases are the same solid, an L of volume 7.
L_SOLID = 7.0, ((0, 0, 0), (4, 3, 2))


def measure(path):
    """Return the signed volume and the bounding box of a file, and its remarks as text."""
    reading = read_file(path)
    volume = SoupFacts(reading.geometry).signed_volume
    return volume, reading.geometry.bounding_box(), "\n".join(map(str, reading.remarks))


# fmt: off
READ = {
    "01_obj_relative_indices/o03_negative.obj": L_SOLID,
    "01_obj_relative_indices/o34_neg_two_cubes.obj": (9.0, ((0, 0, 0), (6, 2, 2))),
    "02_glb_normalized_positions/q05_quant_norm.glb": L_SOLID,
    "21_glb_parts_dropped/q07_fans.glb": L_SOLID,
    "21_glb_parts_dropped/q09_gpu_inst.glb": (21.0, ((0, 0, 0), (24, 3, 2))),
    "17_ply_binary_mixed_faces/p19_concave_le.ply": (7.0, ((0, 0, 0), (4, 4, 1))),
    "17_ply_binary_mixed_faces/p22_mixed_le.ply": L_SOLID,
    "18_stl_byte_counts/s12_trailnl.stl": L_SOLID,
    "19_stl_endings/s04_bom.stl": L_SOLID,
    "19_stl_endings/s18_end_solid.stl": L_SOLID,
    "19_stl_endings/s21_longname.stl": L_SOLID,
    "20_stl_quad_facets/s24_quadfacets.stl": L_SOLID,
    "23_vtu_cells_and_boundary/z_hex_alone.vtu": (1.0, ((-0.5, 0, 0), (0.866025, 1.366025, 1))),
    "23_vtu_cells_and_boundary/z_hex_and_quads.vtu": (
        1.0, ((-0.5, 0, 0), (0.866025, 1.366025, 1)),
    ),
    "26_obj_whitespace/o10_comment_inline.obj": L_SOLID,
    "26_obj_whitespace/o20_tabs.obj": L_SOLID,
    "28_off/f12_concave.off": (7.0, ((0, 0, 0), (4, 4, 1))),
    "28_off/f16_inline_comment.off": L_SOLID,
    "29_ply_tristrips/p13_tristrips.ply": L_SOLID,
    "30_stderr_noise/z_texture.ply": L_SOLID,
    "34_off_comments/comments.off": (6.0, ((0, 0, 0), (3, 2, 1))),
    "39_off_variants/four_coordinates.off": (0.75, ((0, 0, 0), (1.5, 1, 0.5))),
}
REFUSED = {
    "16_text_files_cut_off/p14_trunc_ascii.ply": "promises 30 rows of `face`, the file holds 22",
    "18_stl_byte_counts/s10_count0.stl": "promises 0 triangles, the file holds 60",
    "18_stl_byte_counts/s11_count_half.stl": "promises 30 triangles, the file holds 60",
    "19_stl_endings/s02_comma.stl": "decimal comma",
    "21_glb_parts_dropped/q10_draco_mix.glb": "its compressed triangles cannot be read",
    "24_vtk_cut_segfault/v28_cut10.vtk": "bytes, the file holds",
    "24_vtk_cut_segfault/v28_cut100.vtk": "bytes, the file holds",
    "24_vtk_cut_segfault/v28_cut300.vtk": "bytes, the file holds",
    "27_obj_zero_index/o25_zero_index.obj": "face 1 has the corner 0",
    "28_off/f15_binary.off": "binary OFF is not supported",
}
# fmt: on


@pytest.mark.parametrize("name", READ)
def test_a_file_has_its_exact_volume_and_box(name, capfd):
    volume, box, _ = measure(CASES / name)
    assert volume == pytest.approx(READ[name][0], rel=1e-4)
    assert np.allclose(box, READ[name][1], atol=1e-3)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", REFUSED)
def test_a_damaged_file_is_refused_with_what_was_found(name):
    with pytest.raises(GeometryError) as caught:
        read_file(CASES / name)
    assert REFUSED[name] in str(caught.value)


CORNERS = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def rows(*groups):
    return "\n".join(" ".join(map(str, row)) for group in groups for row in group) + "\n"


def off_text(keyword, extra=(), faces=QUADS):
    points = [(*p, *extra) for p in CORNERS]
    return f"{keyword}\n8 6 0\n" + rows(points, [(len(f), *f) for f in faces])


VARIANTS = {
    "off": off_text("OFF"),
    "no_keyword": off_text("OFF")[4:],
    "counts_on_the_first_line": off_text("OFF").replace("OFF\n", "OFF "),
    "one_line": off_text("OFF").replace("\n", " "),
    "noff": off_text("NOFF", (0, 0, 1)),
    "coff": off_text("COFF", (255, 0, 0, 255)),
    "coff_of_three": off_text("COFF", (255, 0, 0)),
    "stoff": off_text("STOFF", (0.5, 0.5)),
    "stcnoff": off_text("STCNOFF", (0, 0, 1, 1, 0, 0, 1, 0.5, 0.5)),
    "4off": off_text("4OFF", (1,)),
    "noff_of_dimension_3": off_text("nOFF 3"),
    "carriage_returns": off_text("OFF").replace("\n", "\r\n"),
    "colours_of_faces": off_text("OFF", faces=[]) + rows([(4, *f, 9, 9, 9) for f in QUADS]),
}


@pytest.mark.parametrize("variant", VARIANTS)
def test_every_variant_of_off_is_a_unit_cube(tmp_path, variant):
    path = tmp_path / "cube.off"
    path.write_bytes(VARIANTS[variant].encode())
    volume, box, _ = measure(path)
    assert volume == pytest.approx(1.0)
    assert box == ((0, 0, 0), (1, 1, 1))


def obj_text(face):
    faces = [("f", *(face(c + 1) for c in quad)) for quad in QUADS]
    return rows([("v", *p) for p in CORNERS], faces)


OBJ = {
    "plain": obj_text(str),
    "normals_and_textures": obj_text(lambda c: f"{c}/1/1"),
    "normals": obj_text(lambda c: f"{c}//1"),
    "relative": obj_text(lambda c: str(c - 9)),
    "colours": obj_text(str).replace("v 0 0 0", "v 0 0 0 0.5 0.5 0.5"),
    "continued_lines": obj_text(str).replace("f 1", "f \\\n 1"),
    "tabs_and_indents": obj_text(str).replace(" ", "\t").replace("f\t", "  f\t "),
    "carriage_returns": obj_text(str).replace("\n", "\r\n"),
    "old_macintosh": obj_text(str).replace("\n", "\r"),
    "byte_order_mark": "\ufeff" + obj_text(str),
    "comments": obj_text(str).replace("\n", "  # a comment\n"),
    "smoothing_and_groups": "mtllib none.mtl\ng a\ns off\nusemtl b\n" + obj_text(str),
}


@pytest.mark.parametrize("spelling", OBJ)
def test_every_spelling_of_obj_is_a_unit_cube(tmp_path, spelling):
    path = tmp_path / "cube.obj"
    path.write_bytes(OBJ[spelling].encode())
    assert measure(path)[0] == pytest.approx(1.0)


def test_objects_of_an_obj_are_parts_and_other_elements_are_named(tmp_path):
    path = tmp_path / "two.obj"
    second = obj_text(lambda c: str(c - 9)).replace("v ", "v 3")
    path.write_text("o a\n" + obj_text(str) + "o b\n" + second + "l 1 2\np 3\n")
    reading = read_file(path)
    assert np.bincount(reading.geometry.parts).tolist() == [12, 12]
    remarks = "\n".join(map(str, reading.remarks))
    assert "left out: 1 lines" in remarks
    assert "left out: 1 points" in remarks


DAMAGED = {
    "cut.off": (off_text("OFF")[:-14], "8 points and 6 faces, the file holds 8 and 5"),
    "short_face.off": (off_text("OFF")[:-3], "states 4 corners"),
    "five.off": (off_text("nOFF 5"), "dimension 5"),
    "many.off": ("OFF\n99999999999 5 0\n0 0 0\n", "promises 99999999999 points"),
    "words.off": ("OFF\nthree\n", "the counts are"),
    "cut.obj": (obj_text(str)[:40], "corner"),
    "cut_vertex.obj": ("v 0 0 0\nv 1 0\n", "vertex 2 has 2 coordinates"),
    "stated.obj": ("# Vertices: 8\n# Faces: 12\n" + obj_text(str), "states 12 faces"),
    "no_number.obj": ("v 0 0 0,5\n", "decimal comma"),
    "cut.stl": ("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendsolid a", "facets"),
    "cut_after.stl": ("solid a\nendsolid\nsolid b\nfacet normal 0 0 1\n", "before `endsolid`"),
    "empty.ply": ("", "the file is empty"),
    "encoding.ply": ("ply\nformat text 1.0\nend_header\n", "the encoding is 'text'"),
    "type.ply": ("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n", "real"),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_damage_is_named(tmp_path, name):
    path = tmp_path / name
    path.write_text(DAMAGED[name][0])
    with pytest.raises(GeometryError) as caught:
        read_file(path)
    assert DAMAGED[name][1] in str(caught.value) or name == "cut.obj"


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("n_cut", [0, 1, 30])
def test_binary_ply_of_both_byte_orders_is_whole_or_refused(tmp_path, order, n_cut):
    """Faces have a colour before their corners and a texture list after them."""
    name = "little" if order == "<" else "big"
    header = (
        f"ply\nformat binary_{name}_endian 1.0\nelement vertex 8\nproperty double x\n"
        "property double y\nproperty double z\nelement face 6\nproperty uchar red\n"
        "property list uchar int vertex_indices\nproperty list ushort float texcoord\n"
        "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    )
    body = b"".join(struct.pack(order + "3d", *p) for p in CORNERS)
    body += b"".join(struct.pack(order + "BB4iH2f", 7, 4, *q, 2, 0.0, 1.0) for q in QUADS)
    body += struct.pack(order + "2i", 0, 1)
    path = tmp_path / "cube.ply"
    path.write_bytes(header.encode() + body[: len(body) - n_cut])
    if n_cut:
        with pytest.raises(GeometryError, match="the header promises"):
            read_file(path)
        return
    volume, _, remarks = measure(path)
    assert volume == pytest.approx(1.0)
    assert "left out: 1 rows of `edge`" in remarks


def vtk_files(folder):
    """Write the cube in every form that pyvista writes, and return the files."""
    surface = pyvista.Cube().triangulate().compute_normals(split_vertices=False)
    grid = pyvista.ImageData(dimensions=(2, 2, 2)).cast_to_unstructured_grid()
    grid.point_data["heat"] = np.arange(8.0)
    grid.cell_data["label"] = [3]
    for suffix in ("vtk", "vtp", "vtu"):
        for is_binary in (True, False):
            path = folder / f"{'binary' if is_binary else 'text'}.{suffix}"
            (grid if suffix == "vtu" else surface).save(path, binary=is_binary)
            yield path
    for is_binary in (True, False):
        path = folder / f"grid_{is_binary}.vtk"
        grid.save(path, binary=is_binary)
        yield path


def test_files_of_vtk_are_read_whole_and_refused_at_every_cut(tmp_path):
    paths = list(vtk_files(tmp_path))
    assert len(paths) == 8
    for path in paths:
        assert measure(path)[0] == pytest.approx(1.0)
        content = path.read_bytes()
        for part in (0.3, 0.6, 0.8):
            cut = tmp_path / f"cut{path.suffix}"
            cut.write_bytes(content[: int(part * len(content))])
            with pytest.raises(GeometryError):
                read_file(cut)


def test_boundary_elements_of_a_volume_mesh_are_named():
    remarks = measure(CASES / "23_vtu_cells_and_boundary/z_hex_and_quads.vtu")[2]
    assert "left out: 6 boundary elements of volume cells" in remarks
