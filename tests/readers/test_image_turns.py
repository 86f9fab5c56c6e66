"""Pages that are turned, labels at the border, and images of VTK."""

import numpy as np
import pytest
import pyvista
from PIL import Image as Picture
from PIL import ImageOps, TiffImagePlugin

from tusqh.errors import GeometryError
from tusqh.readers.files import read_file

RNG = np.random.default_rng(1)


@pytest.mark.parametrize("orientation", range(1, 9))
def test_pages_are_turned_as_pictures_are(tmp_path, orientation):
    path = tmp_path / "a.tif"
    pages = RNG.integers(0, 255, size=(3, 4, 5), dtype=np.uint8)
    first = [Picture.fromarray(page) for page in pages]
    tags = TiffImagePlugin.ImageFileDirectory_v2()
    tags[274] = orientation
    first[0].save(path, save_all=True, append_images=first[1:], tiffinfo=tags)
    for picture in first:
        picture.getexif()[274] = orientation
    upright = np.array([np.asarray(ImageOps.exif_transpose(picture)) for picture in first])
    reading = read_file(path, image={"empty": 0, "full": 255})
    assert (reading.geometry.voxels == upright.transpose(2, 1, 0)).all()
    said = [remark for remark in reading.remarks if "Orientation" in remark.what]
    assert [remark.count for remark in said] == ([3] if orientation > 1 else [])


def test_labels_at_the_border_of_an_image_are_named(tmp_path):
    labels = np.full((12, 12, 12), 5, dtype=np.uint8)
    labels[2:10, 2:10, 2:10] = 1
    labels[4:8, 4:8, 4:8] = 0
    np.save(tmp_path / "a.npy", labels)
    said = [str(r) for r in read_file(tmp_path / "a.npy").remarks]
    n_border = 6 * 12 * 12
    assert any(f"noted: {n_border} voxels at the border" in text for text in said)
    labels[labels == 5] = 0
    labels[4:8, 4:8, 4:8] = 2
    np.save(tmp_path / "a.npy", labels)
    assert not any("border" in str(r) for r in read_file(tmp_path / "a.npy").remarks)


@pytest.mark.parametrize("kind", ["cell_data", "point_data"])
@pytest.mark.parametrize("is_binary", [True, False])
def test_an_image_of_vtk_has_its_voxels_where_they_are(tmp_path, kind, is_binary):
    voxels = RNG.integers(0, 2, size=(3, 4, 5), dtype=np.uint8)
    n_more = 1 if kind == "cell_data" else 0
    shape = np.array(voxels.shape) + n_more
    image = pyvista.ImageData(dimensions=shape, spacing=(2, 2, 2), origin=(1, 2, 3))
    getattr(image, kind)["grey"] = voxels.ravel(order="F")
    image.save(tmp_path / "a.vti", binary=is_binary)
    geometry = read_file(tmp_path / "a.vti").geometry
    # As a second method, take the centres of VTK's cells, or its points, with their values.
    middles = image.cell_centers().points if n_more else image.points
    places = np.floor((middles - geometry.origin) / geometry.voxel_size).astype(int)
    assert (geometry.voxels[tuple(places.T)] == getattr(image, kind)["grey"]).all()
    assert geometry.voxel_size == 2
    assert geometry.origin == ((1, 2, 3) if n_more else (0, 1, 2))


def test_several_arrays_are_refused(tmp_path):
    image = pyvista.ImageData(dimensions=(3, 3, 3))
    image["a"] = np.zeros(8)
    image["b"] = np.zeros(8)
    image.save(tmp_path / "two.vti")
    with pytest.raises(GeometryError, match="2 arrays of single numbers: 'a', 'b'"):
        read_file(tmp_path / "two.vti")
    del image.cell_data["b"]
    image.direction_matrix = [[0, 1, 0], [1, 0, 0], [0, 0, 1]]
    image.save(tmp_path / "turned.vti")
    assert read_file(tmp_path / "turned.vti").geometry.shape == (2, 2, 2)
