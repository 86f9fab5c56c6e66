"""Images of voxels from every format have one order of axes; other files are refused."""

import nrrd
import numpy as np
import pytest
import tifffile

from tusqh.errors import GeometryError
from tusqh.geometry.canonical import load_geometry, write_geometry
from tusqh.geometry.image import Image
from tusqh.readers.files import read_file
from tusqh.readers.formats import dimension_of

#: Voxel (i, j, k) holds 100 i + 10 j + k, so its value identifies the axes.
VOXELS = (100 * np.arange(2)[:, None, None] + 10 * np.arange(3)[:, None] + np.arange(4)).astype(
    np.uint16
)


def write(path, voxels=VOXELS, **header):
    if path.suffix == ".npy":
        np.save(path, voxels)
    elif path.suffix == ".nrrd":
        nrrd.write(str(path), voxels, header, index_order="F")
    else:  # Pages are z, rows are y and columns are x, as microscopes and scanners write them.
        tifffile.imwrite(path, voxels.transpose(), photometric="minisblack")
    return path


@pytest.mark.parametrize("suffix", ["npy", "tif", "TIFF", "nrrd"])
def test_every_format_has_its_axes_in_place(tmp_path, suffix):
    image = read_file(write(tmp_path / f"a.{suffix}")).geometry
    assert np.array_equal(image.voxels, VOXELS)
    assert image.shape == (2, 3, 4)
    assert (image.empty, image.full, image.voxel_size) == (0, 123, 1)
    assert image.name == f"a.{suffix}"
    assert dimension_of(f"a.{suffix}") == 3


def test_the_size_of_a_voxel_comes_from_the_header_or_the_configuration(tmp_path):
    path = write(tmp_path / "a.nrrd", spacings=[0.5, 0.5, 0.5])
    assert read_file(path).geometry.voxel_size == 0.5
    assert read_file(path, image={"voxel_size": 2}).geometry.bounding_box()[1] == (4, 6, 8)
    path = write(
        tmp_path / "b.nrrd", **{"space directions": -0.25 * np.eye(3), "space dimension": 3}
    )
    assert read_file(path).geometry.voxel_size == 0.25
    path = write(tmp_path / "c.nrrd", spacings=[0.5, 0.5, 1.5])
    assert (
        read_file(path).geometry.shape[2]
        == 3 * read_file(path, image={"voxel_size": 1}).geometry.shape[2]
    )
    assert read_file(path, image={"voxel_size": 1}).geometry.voxel_size == 1


@pytest.mark.parametrize(
    ("voxels", "meaning", "fractions"),
    [
        (np.array([False, True]), {}, [0, 1]),
        (np.array([0, 1], dtype=np.uint8), {}, [0, 1]),
        (np.array([0, 51, 255], dtype=np.uint8), {}, [0, 0.2, 1]),
        (np.array([0.0, 0.25, 1.0], dtype=np.float32), {}, [0, 0.25, 1]),
        (np.array([10, 20, 30, 40], dtype=np.int16), {"empty": 20, "full": 30}, [0, 0, 1, 1]),
        (np.array([10, 20, 30], dtype=np.uint8), {"empty": 30, "full": 10}, [1, 0.5, 0]),
        (np.array([-1.0, 0.5]), {"full": 1.0}, [0, 0.5]),
    ],
)
def test_grey_values_become_fractions(voxels, meaning, fractions):
    image = Image.from_voxels(voxels.reshape(-1, 1, 1), **meaning)
    assert image.fractions().ravel() == pytest.approx(fractions)


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.int16, np.float32, np.float64])
def test_the_canonical_file_keeps_every_bit(tmp_path, dtype):
    image = Image(VOXELS.astype(dtype), 0.1, -1.5, 7.25, (1.0, -2.0, 0.1), "a[b]<c>é.tif")
    for path in (tmp_path / "a.vtp", tmp_path / "b.vtp"):
        write_geometry(path, image)
    back = load_geometry(tmp_path / "a.vtp")
    assert np.array_equal(back.voxels, image.voxels)
    assert back.voxels.dtype == image.voxels.dtype
    for key in ("voxel_size", "empty", "full", "origin", "name"):
        assert getattr(back, key) == getattr(image, key)
    assert (tmp_path / "a.vtp").read_bytes() == (tmp_path / "b.vtp").read_bytes()


@pytest.mark.parametrize(
    ("voxels", "message"),
    [
        (np.zeros(3), r"shape \(3,\)"),
        (np.zeros((3, 0, 3)), r"shape \(3, 0, 3\)"),
        (np.zeros((2, 2, 2, 3)), r"shape \(2, 2, 2, 3\)"),
        (np.full((2, 2, 2), np.nan), "not all finite"),
        (np.zeros((2, 2, 2), dtype=complex), "complex128"),
        (np.full((2, 2, 2), 7.0), "grey values go from 7 to 7"),
        (np.array([-3, 3]).reshape(2, 1, 1), "grey values go from -3 to 3"),
    ],
)
def test_arrays_that_are_no_images_are_explained(voxels, message):
    with pytest.raises(GeometryError, match=message):
        Image.from_voxels(voxels)


@pytest.mark.parametrize(
    ("meaning", "message"),
    [({"voxel_size": 0}, "voxel size is 0"), ({"empty": 5, "full": 5}, "two different grey")],
)
def test_meanings_that_make_no_sense_are_explained(meaning, message):
    with pytest.raises(GeometryError) as caught:
        Image.from_voxels(VOXELS, **meaning)
    assert message in str(caught.value)


@pytest.mark.parametrize("suffix", ["npy", "tif", "nrrd"])
@pytest.mark.parametrize(
    "content", [b"", b"<html>", b"\x93NUMPY\x01\0", b"II*\0\x08\0\0\0", b"NRRD0004\n"]
)
def test_broken_files_are_explained(tmp_path, suffix, content):
    path = tmp_path / f"a.{suffix}"
    path.write_bytes(content)
    with pytest.raises(GeometryError, match=r"cannot be read|cut off|empty"):
        read_file(path)
    with pytest.raises(GeometryError, match="no such file"):
        read_file(tmp_path / f"b.{suffix}")


def test_colours_and_objects_are_refused(tmp_path):
    tifffile.imwrite(tmp_path / "a.tif", np.zeros((4, 5, 6, 3), np.uint8), photometric="rgb")
    with pytest.raises(GeometryError, match="colours"):
        read_file(tmp_path / "a.tif")
    np.save(tmp_path / "a.npy", np.array([{}]), allow_pickle=True)
    with pytest.raises(GeometryError, match="cannot be read"):
        read_file(tmp_path / "a.npy")
    with pytest.raises(GeometryError, match="`image` is given"):
        read_file(tmp_path / "a.stl", image={"full": 1})
