"""SPN files of Sculpt: labels in any order of the axes, and what is wrong with them."""

import subprocess
import sys

import automesh
import numpy as np
import pytest

import tusqh
from tusqh.errors import ConfigError, GeometryError
from tusqh.readers.files import read_file

LABELS = np.random.default_rng(3).integers(0, 4, (3, 4, 5)).astype(np.uint8)
ORDERS = ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx")


def write(path, order, labels=LABELS):
    """Write labels in nested loops, the first axis outermost, as Sculpt documents the orders."""
    lines = []
    for a in range(labels.shape["xyz".index(order[0])]):
        for b in range(labels.shape["xyz".index(order[1])]):
            for c in range(labels.shape["xyz".index(order[2])]):
                at = dict(zip(order, (a, b, c), strict=True))
                lines.append(str(labels[at["x"], at["y"], at["z"]]))
    path.write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize("order", ORDERS)
def test_every_order_of_the_axes(tmp_path, order):
    path = tmp_path / "a.spn"
    write(path, order)
    options = {"voxels": [3, 4, 5], "empty": 0.0, "full": 1.0}
    found = read_file(path, image=options | {"voxel_order": order})
    assert np.array_equal(found.geometry.voxels, LABELS)
    if order == "xyz":
        assert np.array_equal(read_file(path, image=options).geometry.voxels, LABELS)


def test_files_of_automesh_have_the_order_zyx(tmp_path):
    np.save(tmp_path / "a.npy", LABELS)
    automesh.Voxels.from_npy(str(tmp_path / "a.npy")).write_spn(str(tmp_path / "a.spn"))
    image = {"voxels": [3, 4, 5], "voxel_order": "zyx"}
    found = tusqh.mesh(tmp_path / "a.spn", materials={2: "bone"}, image=image)
    other = tusqh.mesh(LABELS, materials={2: "bone"})
    assert found.built.names == ("1", "bone", "3", "void")
    assert np.array_equal(found.mesh.cells, other.mesh.cells)
    assert np.array_equal(found.built.material, other.built.material)


def test_one_material_is_all_labels_but_0(tmp_path):
    write(tmp_path / "a.spn", "xyz")
    found = read_file(tmp_path / "a.spn", image={"voxels": [3, 4, 5]})
    assert np.array_equal(found.geometry.voxels, LABELS > 0)
    assert "labels into material: 1, 2, 3" in str(found.remarks[0])
    found = read_file(tmp_path / "a.spn", image={"voxels": [3, 4, 5], "labels": [2]})
    assert np.array_equal(found.geometry.voxels, LABELS == 2)


def test_spaces_and_line_ends_do_not_matter(tmp_path):
    (tmp_path / "a.spn").write_bytes(b"\xef\xbb\xbf 1 0\r\n0\t300 \r\n\r\n")
    found = read_file(tmp_path / "a.spn", image={"voxels": [2, 1, 2], "labels": [300]})
    assert found.geometry.voxels.ravel().tolist() == [False, False, False, True]


@pytest.mark.parametrize(
    ("text", "image", "message"),
    [
        ("1\n2\n", {}, "without the number of voxels"),
        ("1\n" * 8, {}, "--voxels 2,2,2"),
        ("1\n2\n", {"voxels": [2, 2, 1]}, "2 labels for 2 x 2 x 1 = 4 voxels"),
        ("1\n1.5\n", {"voxels": [2, 1, 1]}, "labels include '1.5'"),
        ("1\n-2\n", {"voxels": [2, 1, 1]}, "labels include '-2'"),
        ("1 nan", {"voxels": [2, 1, 1]}, "labels include 'nan'"),
        ("1\n99999999999999999999", {"voxels": [2, 1, 1]}, "the label 9,223,"),
        (" \n", {"voxels": [2, 1, 1]}, "no label"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, text, image, message):
    (tmp_path / "a.spn").write_text(text)
    with pytest.raises(GeometryError, match=message):
        read_file(tmp_path / "a.spn", image=image)


def test_options_of_spn_files_are_refused_elsewhere(tmp_path):
    np.save(tmp_path / "a.npy", LABELS)
    for source, option in (
        (tmp_path / "a.npy", {"voxels": [3, 4, 5]}),
        (LABELS, {"voxel_order": "zyx"}),
    ):
        with pytest.raises(GeometryError, match="states its own shape"):
            tusqh.mesh(source, materials="labels", image=option)
    for wrong in ([3, 20], [3, 4, 0], [3, 4, 5, 1]):
        with pytest.raises(ConfigError):
            tusqh.mesh(tmp_path / "a.spn", materials="labels", image={"voxels": wrong})


def test_the_command_line(tmp_path):
    write(tmp_path / "a.spn", "zyx")
    words = ["mesh", "a.spn", "--materials", "--voxels", "3,4,5", "--voxel-order", "zyx"]
    done = subprocess.run(
        [sys.executable, "-m", "tusqh", *words], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "a.vtu").exists()
