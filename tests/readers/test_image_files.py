"""Images with positions and sizes in space, other axes and labels, and images that are cut off."""

import subprocess
import sys

import nrrd
import numpy as np
import pytest
import pyvista
import tifffile

import tusqh
from tusqh.errors import ConfigError, GeometryError
from tusqh.readers.files import read_file
from tusqh.readers.memory import read_object

#: The solid of the cases, which has 56 voxels and differs from its mirror images.
N_SOLID = 56


@pytest.fixture
def cases(repository):
    return repository / "tests/cases"


def solid_of(reading):
    """Return the number of material voxels, and the lowest and highest corner around them."""
    image = reading.geometry
    found = np.argwhere(image.fractions() >= 0.5)
    low = np.array(image.origin) + found.min(axis=0) * image.voxel_size
    high = np.array(image.origin) + (found.max(axis=0) + 1) * image.voxel_size
    return len(found), low.tolist(), high.tolist()


def remarks_of(reading):
    return "\n".join(map(str, reading.remarks))


def chiral(shape=(5, 4, 3)):
    """Return an image without any symmetry."""
    return np.arange(np.prod(shape), dtype=np.uint16).reshape(shape) % 251 + 1000


# Directions and origins


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("n05_flip", [-2.375, 0.375, 0.375], [-0.375, 1.875, 1.375]),
        ("n04_dirs", [10.375, 20.375, 30.375], [12.375, 21.875, 31.375]),
    ],
)
def test_an_nrrd_image_is_where_its_header_says(cases, name, low, high):
    reading = read_file(cases / f"12_nrrd_directions/{name}.nrrd")
    assert solid_of(reading) == (N_SOLID, low, high)
    assert reading.geometry.voxel_size == 0.25


@pytest.mark.parametrize("axes", [(0, 1, 2), (1, 2, 0), (2, 1, 0), (0, 2, 1)])
@pytest.mark.parametrize("signs", [(1, 1, 1), (-1, 1, 1), (-1, 1, -1), (-1, -1, -1)])
def test_every_voxel_is_where_directions_with_signs_and_permutations_put_it(tmp_path, axes, signs):
    voxels, directions, origin = chiral(), np.zeros((3, 3)), np.array([7.0, -2.0, 0.5])
    for i in range(3):
        directions[i, axes[i]] = signs[i] * 0.5
    header = {"space dimension": 3, "space directions": directions, "space origin": origin}
    nrrd.write(str(tmp_path / "a.nrrd"), voxels, header, index_order="F")
    image = read_file(tmp_path / "a.nrrd").geometry
    for index in np.ndindex(voxels.shape):
        centre = origin + index @ directions
        place = tuple(np.floor((centre - image.origin) / image.voxel_size).astype(int))
        assert image.voxels[place] == voxels[index]


@pytest.mark.parametrize(
    "directions", [np.array([[1.0, 0, 0], [1.0, 0, 0], [0, 0, 1]]), np.zeros((3, 3))]
)
def test_directions_that_do_not_span_the_space_are_refused(tmp_path, directions):
    header = {"space dimension": 3, "space directions": directions}
    nrrd.write(str(tmp_path / "a.nrrd"), chiral(), header, index_order="F")
    with pytest.raises(GeometryError, match="its axes have the directions"):
        read_file(tmp_path / "a.nrrd")


def test_a_given_voxel_size_scales_the_origin_in_the_file(cases):
    path = cases / "12_nrrd_directions/n04_dirs.nrrd"
    image = read_file(path, image={"voxel_size": 250.0}).geometry
    assert image.origin == (9875.0, 19875.0, 29875.0)


def test_the_ends_of_axes_give_the_voxel_size_where_there_are_no_spacings(tmp_path):
    header = {"axis mins": [0, 0, 0], "axis maxs": [2.5, 2.0, 1.5]}
    nrrd.write(str(tmp_path / "a.nrrd"), chiral(), header, index_order="F")
    assert read_file(tmp_path / "a.nrrd").geometry.voxel_size == 0.5


def test_a_mesh_of_an_image_is_at_its_place(cases):
    path = cases / "12_nrrd_directions/n05_flip.nrrd"
    mesh = tusqh.mesh(path, cells=12, threshold=0.5).mesh
    assert mesh.points.min(axis=0) == pytest.approx([-2.375, 0.375, 0.375])
    assert mesh.points.max(axis=0) == pytest.approx([-0.375, 1.875, 1.375])


# Sizes of voxels in TIFF files


@pytest.mark.parametrize("name", ["t04_imagej.tif", "t06_ome.ome.tif"])
def test_imagej_and_ome_give_the_voxel_size(cases, name):
    reading = read_file(cases / "13_tiff_voxel_size" / name)
    assert solid_of(reading) == (N_SOLID, [0.5, 0.5, 0.5], [2.5, 2.0, 1.5])
    assert reading.unit in ("um", "mm")


def test_anisotropic_voxels_of_a_tiff_are_resampled(cases):
    path = cases / "13_tiff_voxel_size/t05_imagej_aniso.tif"
    reading = read_file(path)
    assert reading.geometry.voxel_size == 0.25
    assert "voxels of 0.25 x 0.25 x 1 resampled to cubes of 0.25" in remarks_of(reading)
    volume = reading.geometry.fractions().sum() * 0.25**3
    assert volume == pytest.approx(N_SOLID * 0.25**2)
    assert read_file(path, image={"voxel_size": 2}).geometry.voxel_size == 2


@pytest.mark.parametrize(
    ("options", "size", "word"),
    [
        ({"resolution": (0.5, 0.5), "metadata": {"spacing": 2, "unit": "um"}}, 2, "um"),
        ({"resolution": (72, 72), "resolutionunit": 2}, 1, "72 pixels per inch"),
        ({"resolution": (10, 10), "resolutionunit": 3}, 1, "10 pixels per cm"),
        ({"resolution": (1, 1)}, 1, ""),
        ({}, 1, ""),
        ({"ome": True, "metadata": {"axes": "ZYX"}}, 1, ""),
        (
            {
                "ome": True,
                "metadata": {
                    "axes": "ZYX",
                    **dict.fromkeys(["PhysicalSizeX", "PhysicalSizeY"], 0.5),
                    "PhysicalSizeZ": 500,
                    "PhysicalSizeZUnit": "nm",
                },
            },
            0.5,
            "um",
        ),
    ],
)
def test_the_size_of_a_voxel_is_read_or_said_to_be_left_out(tmp_path, options, size, word):
    tifffile.imwrite(tmp_path / "a.tif", chiral(), photometric="minisblack", **options)
    reading = read_file(tmp_path / "a.tif")
    assert reading.geometry.voxel_size == pytest.approx(size)
    assert word in remarks_of(reading) or word == reading.unit
    assert np.array_equal(reading.geometry.voxels, chiral().transpose())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"resolution": (2, 1)}, "a pixel measures 0.5 x 1"),
        (
            {"imagej": True, "resolution": (4, 4), "metadata": {"axes": "ZYX", "unit": "um"}},
            r"0.25 x 0.25 x \(not given\)",
        ),
        (
            {"ome": True, "metadata": {"axes": "ZYX", "PhysicalSizeX": 1, "PhysicalSizeY": 1}},
            r"1 x 1 x \(not given\)",
        ),
    ],
)
def test_a_size_along_some_axes_only_is_refused(tmp_path, options, message):
    tifffile.imwrite(tmp_path / "a.tif", chiral(), photometric="minisblack", **options)
    with pytest.raises(GeometryError, match=message):
        read_file(tmp_path / "a.tif")


# Pages


def test_pages_that_were_written_one_by_one_are_a_stack(cases):
    reading = read_file(cases / "14_tiff_pages_in_a_loop/t24_loop_default.tif")
    assert solid_of(reading)[0] == N_SOLID


def test_pages_of_different_shapes_are_refused_with_their_shapes(tmp_path):
    with tifffile.TiffWriter(tmp_path / "a.tif") as writer:
        for n in (10, 12):
            writer.write(np.ones((n, 8), np.uint8), photometric="minisblack")
    with pytest.raises(GeometryError, match="2 images of shapes 10 x 8, 12 x 8"):
        read_file(tmp_path / "a.tif")


def test_several_stacks_in_one_file_are_refused(tmp_path):
    with tifffile.TiffWriter(tmp_path / "a.tif") as writer:
        for _ in range(2):
            writer.write(np.ones((3, 10, 8), np.uint8), photometric="minisblack")
    with pytest.raises(GeometryError, match="2 images of shape 3 x 10 x 8"):
        read_file(tmp_path / "a.tif")


def test_lzw_is_read(cases):
    assert solid_of(read_file(cases / "46_compressed_tiff/lzw.tif"))[0] == 192


def test_a_compressed_file_without_its_library_names_the_extra(cases):
    program = f"""
import sys
from pathlib import Path
sys.modules["imagecodecs"] = None
from tusqh.readers.files import read_file
read_file(Path({str(cases / "46_compressed_tiff/lzw.tif")!r}))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert "MissingExtraError: imagecodecs" in done.stderr
    assert 'pip install "tusqh[formats]"' in done.stderr


@pytest.mark.parametrize("compression", ["zlib", "lzw", "packbits", "zstd", "lzma"])
def test_compressed_pages_are_equal_to_plain_ones(tmp_path, compression):
    tifffile.imwrite(
        tmp_path / "a.tif", chiral(), compression=compression, photometric="minisblack"
    )
    assert np.array_equal(read_file(tmp_path / "a.tif").geometry.voxels, chiral().transpose())


# Files that are cut off


def test_a_stack_that_lost_half_of_its_pages_is_refused(cases, capfd):
    with pytest.raises(GeometryError, match="page 11 would start at byte 5,288"):
        read_file(cases / "15_tiff_cut_in_half/t30_pilcut.tif")
    assert not capfd.readouterr().err


def write_every_kind(folder):
    """Write a stack in every way that programs do."""
    voxels = np.random.default_rng(1).integers(0, 255, (6, 9, 10), dtype=np.uint8)
    plain = {"photometric": "minisblack"}
    tifffile.imwrite(folder / "plain.tif", voxels, **plain)
    tifffile.imwrite(folder / "big.tif", voxels, bigtiff=True, **plain)
    tifffile.imwrite(folder / "motorola.tif", voxels, byteorder=">", **plain)
    tifffile.imwrite(folder / "imagej.tif", voxels, imagej=True, metadata={"axes": "ZYX"}, **plain)
    tifffile.imwrite(folder / "ome.tif", voxels, ome=True, metadata={"axes": "ZYX"}, **plain)
    tifffile.imwrite(folder / "lzw.tif", voxels, compression="lzw", **plain)
    with tifffile.TiffWriter(folder / "loop.tif") as writer:
        for page in voxels:
            writer.write(page, metadata=None, **plain)
    np.save(folder / "a.npy", voxels)
    for encoding in ("raw", "gzip", "ascii"):
        header = {"encoding": encoding}
        nrrd.write(str(folder / f"{encoding}.nrrd"), voxels, header, index_order="C")
    return sorted(folder.iterdir()), voxels


def test_a_file_that_is_cut_anywhere_is_refused_or_complete(tmp_path):
    """A cut in padding, or in text after the image, can leave the image complete."""
    paths, voxels = write_every_kind(tmp_path)
    assert len(paths) == 11
    for path in paths:
        whole = path.read_bytes()
        expected = read_file(path).geometry.voxels
        assert np.sort(expected, axis=None).tolist() == np.sort(voxels, axis=None).tolist()
        for n_bytes in np.linspace(0, len(whole) - 2, 41).astype(int):
            path.write_bytes(whole[:n_bytes])
            try:
                reading = read_file(path)
            except GeometryError:
                continue
            if "without an end of line" not in remarks_of(reading):
                assert np.array_equal(reading.geometry.voxels, expected), (path.name, n_bytes)


@pytest.mark.parametrize("name", ["a.npy", "raw.nrrd", "gzip.nrrd"])
def test_bytes_after_the_image_are_refused(tmp_path, name):
    write_every_kind(tmp_path)
    path = tmp_path / name
    voxels = np.zeros((6, 9, 10), np.uint8)
    if name == "gzip.nrrd":
        nrrd.write(str(path), voxels, {"encoding": "gzip"})
        path.write_bytes(path.read_bytes().replace(b"sizes: 6 9 10", b"sizes: 6 9 9"))
    else:
        path.write_bytes(path.read_bytes() + bytes(10))
    with pytest.raises(GeometryError, match=r"bytes follow|does not equal"):
        read_file(path)


def test_a_stack_with_fewer_pages_than_its_description_says_is_refused(tmp_path):
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, chiral((4, 6, 6)).astype(np.uint8), imagej=True)
    path.write_bytes(path.read_bytes().replace(b"images=4\nslices=4", b"images=9\nslices=9"))
    with pytest.raises(GeometryError):
        read_file(path)


# Axes that are not directions of space


@pytest.mark.parametrize(
    ("name", "noun"),
    [("channels.tif", r"3 channels \(axis C\)"), ("colour.nrrd", "3 entries along the axis 'RGB-")],
)
def test_channels_of_one_slice_are_not_slices(cases, name, noun):
    with pytest.raises(GeometryError, match=noun) as caught:
        read_file(cases / "44_image_axes" / name)
    assert "slices" in caught.value.remedy


@pytest.mark.parametrize("axes", ["CZYX", "ZCYX", "TZYX"])
def test_an_axis_beside_those_of_space_is_refused_or_chosen_from(tmp_path, axes):
    voxels = chiral((2, 2, 5, 6))
    tifffile.imwrite(
        tmp_path / "a.tif", voxels, ome=True, metadata={"axes": axes}, photometric="minisblack"
    )
    with pytest.raises(GeometryError, match=rf"2 \w+ \(axis {axes.strip('XYZ')}\)") as caught:
        read_file(tmp_path / "a.tif")
    assert "`channel`, from 0 to 1" in caught.value.remedy
    taken = read_file(tmp_path / "a.tif", image={"channel": 1}).geometry.voxels
    expected = voxels.take(1, axis=axes.index(axes.strip("XYZ")))
    assert np.array_equal(taken, expected.transpose())
    with pytest.raises(GeometryError, match="`channel` is 2"):
        read_file(tmp_path / "a.tif", image={"channel": 2})


def test_channels_and_times_together_are_refused(tmp_path):
    metadata = {"axes": "TCZYX"}
    tifffile.imwrite(tmp_path / "a.tif", chiral((2, 3, 2, 5, 6)), ome=True, metadata=metadata)
    with pytest.raises(GeometryError, match=r"2 times \(axis T\) and 3 channels \(axis C\)"):
        read_file(tmp_path / "a.tif", image={"channel": 1})


def test_a_channel_can_be_chosen_from_an_nrrd_image(tmp_path):
    voxels = chiral((2, 5, 6, 7))
    directions = np.vstack([np.full(3, np.nan), 0.5 * np.eye(3)])
    header = {"kinds": ["list", "space", "space", "space"], "space dimension": 3}
    header["space directions"] = directions
    nrrd.write(str(tmp_path / "a.nrrd"), voxels, header, index_order="F")
    with pytest.raises(GeometryError, match="2 entries along the axis 'list'"):
        read_file(tmp_path / "a.nrrd")
    image = read_file(tmp_path / "a.nrrd", image={"channel": 1}).geometry
    assert np.array_equal(image.voxels, voxels[1])
    assert image.voxel_size == 0.5


def test_a_channel_of_an_image_without_channels_is_refused(tmp_path):
    np.save(tmp_path / "a.npy", chiral())
    with pytest.raises(GeometryError, match="only one channel"):
        read_file(tmp_path / "a.npy", image={"channel": 1})


def test_an_axis_that_looks_like_colours_is_remarked(tmp_path):
    np.save(tmp_path / "a.npy", np.ones((40, 30, 3)))
    assert "noted: 3 layers along axis z" in remarks_of(read_file(tmp_path / "a.npy"))


def test_white_is_zero_and_palettes_are_remarked(tmp_path):
    voxels = (chiral() % 200).astype(np.uint8)
    tifffile.imwrite(tmp_path / "a.tif", voxels, photometric="miniswhite")
    assert "0 is white" in remarks_of(read_file(tmp_path / "a.tif"))
    colours = np.zeros((3, 256), np.uint16)
    tifffile.imwrite(tmp_path / "b.tif", voxels, photometric="palette", colormap=colours)
    assert "palette of colours" in remarks_of(read_file(tmp_path / "b.tif"))


@pytest.mark.parametrize("name", ["v14_structured_points.vtk", "v15_structured_cells.vtk"])
def test_an_image_in_a_vtk_file_is_not_a_solid_box(cases, name):
    with pytest.raises(GeometryError, match="holds an image") as caught:
        read_file(cases / "22_vtk_image" / name)
    assert "NRRD" in caught.value.remedy
    with pytest.raises(GeometryError, match="holds an image"):
        read_object(pyvista.ImageData(dimensions=(3, 3, 3)))


# Labels


def blocks(*labels, dtype=np.uint8):
    """Return blocks of 4 x 4 x 4 voxels in a row, one for each label."""
    line = np.repeat(np.array(labels, dtype=dtype), 4)
    return np.broadcast_to(line[:, None, None], (len(line), 4, 4)).copy()


def test_all_labels_but_0_are_material(cases):
    reading = read_file(cases / "45_labels_by_default/four_labels.npy")
    assert solid_of(reading)[0] == 512
    assert "changed: 4 labels into material: 1, 2, 3, 4" in remarks_of(reading)
    result = tusqh.mesh(cases / "45_labels_by_default/four_labels.npy", cells=12, threshold=0.5)
    assert result.report.measured == (4, 0, 0)


def test_the_lower_of_two_values_is_the_background(cases):
    reading = read_file(cases / "32_images_of_labels/i14_labels.npy")
    assert solid_of(reading)[0] == N_SOLID
    assert "1 is taken as empty, 2 as material" in remarks_of(reading)


@pytest.mark.parametrize(
    ("labels", "dtype"),
    [
        (labels, dtype)
        for labels in ((0, 1, 2), (0, 3, 0, 7, 200), (0, 1, 70000, 2))
        for dtype in (np.uint8, np.int32, np.float32, np.int64)
        if not (70000 in labels and dtype == np.uint8)
    ],
)
def test_images_of_labels_are_recognised_in_every_type(labels, dtype):
    image = read_object(blocks(*labels, dtype=dtype))
    assert image.fractions().sum() == 64 * sum(label > 0 for label in labels)


def test_hundreds_of_labels_are_recognised(tmp_path):
    numbers = np.random.default_rng(3).permutation(np.arange(8 * 8 * 8)).reshape(8, 8, 8)
    voxels = np.kron(numbers, np.ones((3, 3, 3), dtype=np.int64))
    np.save(tmp_path / "a.npy", voxels)
    reading = read_file(tmp_path / "a.npy")
    assert solid_of(reading)[0] == 511 * 27
    assert "changed: 511 labels into material: 1, 2, 3, 4, 5, 6, 7, 8, ..." in remarks_of(reading)


def test_labels_without_a_background_are_refused_and_can_be_chosen(tmp_path):
    np.save(tmp_path / "a.npy", blocks(1, 2, 3))
    with pytest.raises(GeometryError, match="labels 1, 2, 3 have no background 0") as caught:
        read_file(tmp_path / "a.npy")
    assert "`labels`" in caught.value.remedy
    reading = read_file(tmp_path / "a.npy", image={"labels": (2, 3)})
    assert solid_of(reading)[0] == 128
    assert "left out: 64 voxels of other labels" in remarks_of(reading)
    with pytest.raises(GeometryError, match="no voxel has the label 9") as caught:
        read_file(tmp_path / "a.npy", image={"labels": (9,)})
    assert caught.value.expected == "labels of the image: 1, 2, 3"


def test_labels_and_grey_values_contradict_each_other():
    with pytest.raises(ConfigError, match="`labels` with `empty` or `full`"):
        tusqh.mesh(blocks(0, 1), image={"labels": [1], "full": 1}, cells=4)


def ball(n=24):
    """Return exact-looking fractions of a ball, between 0 and 1."""
    x = np.arange(n) - (n - 1) / 2
    radius = np.sqrt(x[:, None, None] ** 2 + x[:, None] ** 2 + x**2)
    return np.clip(n / 3 - radius + 0.5, 0, 1)


@pytest.mark.parametrize("greatest", [2, 8, 255, 65535])
def test_fractions_in_whole_numbers_stay_grey(greatest):
    voxels = np.rint(ball() * greatest).astype(np.uint16)
    assert np.array_equal(read_object(voxels).fractions(), voxels / greatest)


def test_empty_or_full_make_labels_grey(tmp_path):
    np.save(tmp_path / "a.npy", blocks(0, 1, 2))
    reading = read_file(tmp_path / "a.npy", image={"full": 2})
    assert not reading.remarks
    assert reading.geometry.fractions()[:, 0, 0].tolist() == [0] * 4 + [0.5] * 4 + [1] * 4


def test_a_scan_has_levels_suggested_by_its_histogram(tmp_path):
    rng = np.random.default_rng(5)
    voxels = np.clip(40 + 140 * ball() + rng.normal(0, 10, (24, 24, 24)), 0, 255).astype(np.uint8)
    voxels[0, 0, 0] = 255
    np.save(tmp_path / "a.npy", voxels)
    (remark,) = read_file(tmp_path / "a.npy").remarks
    low, high, *_ = [int(w.strip(",:")) for w in remark.remedy.split() if w[0].isdigit()]
    assert abs(low - 40) < 5
    assert abs(high - 180) < 5
    assert not read_file(tmp_path / "a.npy", image={"empty": low, "full": high}).remarks
