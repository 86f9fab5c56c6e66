"""Pages that are turned, labels at the border, and images of VTK."""

import numpy as np
import pytest
from PIL import Image as Picture
from PIL import ImageOps, TiffImagePlugin

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
