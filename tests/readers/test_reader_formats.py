"""The table of formats is complete, lazily imported, and the source of messages and docs."""

import re
import subprocess
import sys
import tomllib
from importlib import import_module

import pytest

from tusqh.errors import GeometryError
from tusqh.extras import MissingExtraError
from tusqh.readers.files import read_file
from tusqh.readers.formats import FORMATS, dimension_of, suffixes_of

#: Modules beside the readers in the same folder.
OTHERS = {
    "__init__",
    "axes",
    "beside",
    "content",
    "curves",
    "files",
    "formats",
    "gate",
    "labels",
    "logs",
    "memory",
    "ply_header",
    "gltf_file",
    "ply_rows",
    "polygon_faces",
    "reading",
    "surfaces",
    "tiff_pages",
    "tiff_sizes",
    "voxels",
    "vtk_file",
    "vtk_legacy",
}
OTHERS |= {"boxes_to_cubes", "simple_features", "frames", "lengths", "places", "project"}
OTHERS |= {"xml_names"}
OTHERS |= {"loose", "paint", "polygons_of_maps", "rings"}
OTHERS |= {"svg_frame", "svg_shapes", "svg_style", "svg_tree"}


def test_every_reader_is_in_the_table_and_every_suffix_once(repository):
    modules = {path.stem for path in (repository / "tusqh/readers").glob("*.py")}
    assert modules - OTHERS == {found.module for found in FORMATS}
    assert len(set(suffixes_of())) == len(suffixes_of())
    for found in FORMATS:
        assert callable(import_module(f"tusqh.readers.{found.module}").read)


def test_the_page_on_inputs_has_the_table(repository):
    text = (repository / "docs/inputs.md").read_text()
    for found in FORMATS:
        library = f"{found.library} (`{found.extra}`)" if found.library else ""
        suffixes = ", ".join(f"`{suffix}`" for suffix in found.suffixes)
        assert found.loses
        assert f"| {found.name} | {suffixes} | {library} | {found.loses} |" in text


def test_every_library_belongs_to_the_extra_that_the_table_names(repository):
    names = {"shapefile": "pyshp", "nrrd": "pynrrd", "PIL": "pillow"}
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    with_library = [found for found in FORMATS if found.library]
    assert len(with_library) > 3
    for found in with_library:
        wanted = names.get(found.library, found.library)
        required = project["optional-dependencies"][found.extra]
        assert any(line.startswith(f"{wanted}>=") for line in required), found.name


@pytest.mark.parametrize("found", [f for f in FORMATS if f.library], ids=lambda f: f.name)
def test_a_missing_library_is_an_error_that_names_the_extra(tmp_path, monkeypatch, found):
    path = tmp_path / f"part{found.suffixes[0]}"
    path.write_text("anything")
    monkeypatch.setitem(sys.modules, found.library, None)
    with pytest.raises(MissingExtraError) as caught:
        read_file(path)
    assert caught.value.remedy == f'pip install "tusqh[{found.extra}]"'
    assert caught.value.where == found.library


def test_no_reader_and_no_library_is_imported_before_a_file_is_read():
    program = """
import sys
import tusqh.geometry.canonical, tusqh.readers.files, tusqh.readers.memory
print(*sys.modules)
"""
    command = [sys.executable, "-c", program]
    loaded = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    assert "tusqh.readers.formats" in loaded
    for found in FORMATS:
        assert f"tusqh.readers.{found.module}" not in loaded
        assert found.library not in loaded
    assert "trimesh" not in loaded


def test_an_unsupported_suffix_lists_all_formats():
    with pytest.raises(GeometryError, match=r"'\.docx' are not supported") as caught:
        dimension_of("part.docx")
    assert all(suffix in caught.value.expected for suffix in suffixes_of())


def test_an_unknown_option_of_an_image_is_named(tmp_path):
    path = tmp_path / "a.npy"
    path.write_bytes(b"")
    with pytest.raises(GeometryError, match="unknown option 'voxelsize'"):
        read_file(path, image={"voxelsize": 1.0})


def test_the_documentation_names_every_format(repository):
    page = (repository / "docs/add-a-model.md").read_text()
    for suffix in suffixes_of():
        assert f"`{suffix}`" in page


def test_the_page_on_inputs_has_every_format_and_names_tests_that_exist(repository):
    page = (repository / "docs/inputs.md").read_text()
    rows = {row.split("|")[1].strip() for row in page.splitlines() if row.startswith("| ")}
    named = {"NumPy array": "NPY", "TIFF stack": "TIFF", "CSV of segments": "CSV"}
    named |= {"VTK": "VTK, VTU, VTP", "STEP or IGES": "STEP, IGES"}
    missing = {named.get(found.name, found.name) for found in FORMATS} - rows
    assert not missing
    tests = "".join(path.read_text() for path in (repository / "tests").rglob("test_*.py"))
    for name in re.findall(r"`(test_\w+)`", page):
        assert f"def {name}(" in tests, name
