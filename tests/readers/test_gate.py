"""Files that are not geometry of their format are refused before reading, with a remedy."""

import bz2
import gzip
import io
import json
import os
import shutil
import socket
import zipfile

import numpy as np
import pytest
import tifffile
from samples import LENGTHS, OPTIONS, write_samples

import tusqh.readers.gate as gate
from tusqh.errors import GeometryError
from tusqh.readers.content import recognise
from tusqh.readers.files import read_file
from tusqh.readers.formats import FORMATS, find_format, suffix_of, suffixes_of


@pytest.fixture(scope="module")
def samples(tmp_path_factory):
    return write_samples(tmp_path_factory.mktemp("samples"))


def refused(path):
    """Return the error of reading a file."""
    with pytest.raises(GeometryError) as caught:
        read_file(path)
    assert all((caught.value.found, caught.value.expected, caught.value.remedy))
    return caught.value


def test_there_is_a_sample_of_every_format(samples):
    assert {suffix_of(path) for path in samples} == set(suffixes_of())


def test_every_sample_is_read_and_its_content_agrees_with_its_name(samples):
    for path in samples:
        reading = read_file(path, image=OPTIONS.get(path.suffix), lengths=LENGTHS.get(path.suffix))
        assert reading.format == find_format(path.name).name
        content = recognise(path)
        assert content is None or suffix_of(path) in content.suffixes, path.name


def test_every_format_under_the_suffix_of_another_is_refused_by_name(samples, tmp_path):
    renamed = {}
    for path in samples:
        for other in FORMATS:
            wrong = tmp_path / f"part{other.suffixes[0]}"
            if other.name == find_format(path.name).name or other.name == "VTK":
                continue
            wrong.write_bytes(path.read_bytes())
            error = refused(wrong)
            renamed[path.name] = error.remedy
            assert "it is a" in error.found, (path.name, other.name, error.found)
            start = "unpack it" if path.suffix in (".gz", ".3mf") else "rename it to part."
            assert error.remedy.startswith(start), (path.name, other.name)
            if path.suffix not in (".gz", ".3mf"):
                assert error.remedy.endswith(recognise(wrong).suffixes[0])
    assert renamed["text.stl"] == "rename it to part.stl"
    assert renamed["drawing.svg"] == "rename it to part.svg"


@pytest.mark.parametrize("suffix", suffixes_of())
def test_empty_files_folders_pipes_and_sockets_are_refused(tmp_path, suffix):
    (tmp_path / f"empty{suffix}").touch()
    (tmp_path / f"folder{suffix}").mkdir()
    os.mkfifo(tmp_path / f"pipe{suffix}")
    (tmp_path / f"device{suffix}").symlink_to("/dev/zero")
    (tmp_path / f"loop{suffix}").symlink_to(tmp_path / f"loop{suffix}")
    with socket.socket(socket.AF_UNIX) as own:
        own.bind(str(tmp_path / f"socket{suffix}"))
        for name in ("a folder", "a pipe", "a device", "a socket"):
            assert refused(tmp_path / f"{name[2:]}{suffix}").found == f"it is {name}"
    assert refused(tmp_path / f"empty{suffix}").found == "the file is empty"
    assert "no such file" in refused(tmp_path / f"none{suffix}").found
    assert "no such file (" in refused(tmp_path / f"loop{suffix}").found
    assert "no such file (" in refused(tmp_path / f"{'long' * 90}{suffix}").found


def test_a_file_that_may_not_be_read_is_refused(tmp_path, monkeypatch):
    (tmp_path / "part.stl").write_text("solid")
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    assert refused(tmp_path / "part.stl").found == "you may not read it"


@pytest.mark.parametrize("suffix", suffixes_of())
def test_a_file_larger_than_the_memory_is_refused_unread(tmp_path, monkeypatch, suffix):
    path = tmp_path / f"large{suffix}"
    path.touch()
    os.truncate(path, 10_000_000_000)
    monkeypatch.setattr(gate, "available_memory", lambda: 8_000_000_000)
    monkeypatch.setattr(gate, "recognise", None)  # Nothing may be opened.
    error = refused(path)
    growth = find_format(path.name).growth
    assert f"reading its 10.0 GB needs about {10 * growth:.1f} GB of memory" in error.found
    assert error.expected == "at most the 8.0 GB that are available"


def test_images_are_estimated_by_their_size_in_memory(tmp_path, monkeypatch):
    voxels = np.zeros((100, 100, 100), dtype=np.uint8)
    voxels[40:60, 40:60, 40:60] = 1
    tifffile.imwrite(tmp_path / "a.tif", voxels, compression="zlib")
    header = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 100 100 100\nencoding: gzip\n\n"
    (tmp_path / "a.nrrd").write_bytes(header + gzip.compress(voxels.tobytes()))
    for name in ("a.tif", "a.nrrd"):
        read_file(tmp_path / name)
        with monkeypatch.context() as patch:
            patch.setattr(gate, "available_memory", lambda: 2_000_000)
            assert "needs about 3.0 MB of memory" in refused(tmp_path / name).found


@pytest.mark.parametrize(("encoding", "pack"), [("gzip", gzip.compress), ("bzip2", bz2.compress)])
def test_a_bomb_in_an_nrrd_file_is_refused(tmp_path, monkeypatch, encoding, pack):
    header = f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: {encoding}\n\n"
    (tmp_path / "a.nrrd").write_bytes(header.encode() + pack(bytes(50_000_000)))
    monkeypatch.setattr("tusqh.readers.nrrd.available_memory", lambda: 1000)
    assert "more than twice as long as the image" in refused(tmp_path / "a.nrrd").found


def test_archives_are_refused_unopened(tmp_path):
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("../outside.stl", bytes(1_000_000))
    for name, data in (
        ("shapes.shp", content.getvalue()),
        ("part.stl", content.getvalue()),
        ("foam.npy", gzip.compress(bytes(1000))),
    ):
        (tmp_path / name).write_bytes(data)
        error = refused(tmp_path / name)
        assert "it is a" in error.found
        assert error.remedy == "unpack it and give the file with the geometry"
    assert not (tmp_path.parent / "outside.stl").exists()


@pytest.mark.parametrize("name", ["../secret.bin", "/etc/passwd", "link.bin", "a/../../secret.bin"])
def test_data_outside_the_folder_of_a_file_is_refused(tmp_path, name):
    folder = tmp_path / "inside"
    folder.mkdir()
    (tmp_path / "secret.bin").write_bytes(bytes(512))
    (folder / "link.bin").symlink_to("../secret.bin")
    header = (
        f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\ndata file: {name}\n"
    )
    (folder / "a.nrrd").write_text(header)
    assert "outside its own folder" in refused(folder / "a.nrrd").found
    document = {"asset": {"version": "2.0"}, "buffers": [{"uri": name, "byteLength": 512}]}
    document |= {"bufferViews": [{"buffer": 0, "byteLength": 96}], "nodes": [{"mesh": 0}]}
    document |= {"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]}
    accessor = {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"}
    (folder / "a.gltf").write_text(json.dumps(document | {"accessors": [accessor]}))
    assert "outside its own folder" in refused(folder / "a.gltf").found


def test_data_in_a_pipe_does_not_block(tmp_path):
    os.mkfifo(tmp_path / "pipe.raw")
    header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n"
    (tmp_path / "a.nrrd").write_text(header + "data file: pipe.raw\n")
    assert "no such file" in refused(tmp_path / "a.nrrd").found


NAMES = [
    "two words",
    'it\'s "quoted"',
    "two\nlines",
    "\t\x1b[31mred",
    "κύβος 立方体",
    "-o",
    "#%41?",
]


@pytest.mark.parametrize(
    "name", [*NAMES[1:3], *(pytest.param(n, marks=pytest.mark.slow) for n in NAMES[:1] + NAMES[3:])]
)
def test_names_of_every_kind_are_read_and_shown_on_one_line(samples, tmp_path, name):
    for data in ("apart.raw", "ball.zraw"):
        shutil.copy(samples[0].parent / data, tmp_path)
    for path in samples:
        strange = tmp_path / f"{name}{suffix_of(path)}"
        strange.write_bytes(path.read_bytes())
        options = OPTIONS.get(path.suffix)
        lengths = LENGTHS.get(path.suffix)
        assert read_file(strange, image=options, lengths=lengths).geometry.name == strange.name
        strange.write_bytes(b"\0\1\2\3" * 9)
        shown = str(refused(strange))
        assert len(shown.splitlines()) == 3
        assert "\x1b" not in shown


def test_a_name_that_is_not_utf_8_can_be_printed(samples, tmp_path):
    strange = tmp_path / os.fsdecode(b"caf\xe9.stl")
    strange.write_bytes(b"solid")
    assert r"caf\udce9.stl" in str(refused(strange)).encode().decode()
