"""The canonical image file: a VTP with the box of the image and its voxels as field data."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.atomic import replacing
from tusqh.geometry.image import Image

#: Name of the field with the voxels, in C order.
VOXELS = "voxels"


def write_image(path: Path, image: Image) -> None:
    """Write an image; the file appears whole or not at all, and is the same every time."""
    import pyvista

    low, high = image.bounding_box()
    bounds = [x for pair in zip(low, high, strict=True) for x in pair]
    box = pyvista.Box(bounds).extract_all_edges()
    box.clear_data()
    # VTK has no truth values.
    is_truth = image.voxels.dtype.kind == "b"
    box.field_data[VOXELS] = (image.voxels.view(np.uint8) if is_truth else image.voxels).ravel()
    numbers = [image.voxel_size, image.empty, image.full, *image.origin]
    box.field_data["numbers"] = np.array(numbers)
    about = {"name": image.name, "shape": image.shape, "dtype": image.voxels.dtype.str}
    box.field_data["about"] = [json.dumps(about)]
    with replacing(path) as temporary:
        box.save(temporary, binary=True)


def load_image(box: Any) -> Image:
    """Return the image in a dataset that `write_image` wrote, equal in every bit."""
    about = json.loads(str(box.field_data["about"][0]))
    voxel_size, empty, full, x, y, z = (float(number) for number in box.field_data["numbers"])
    voxels = np.array(box.field_data[VOXELS]).astype(np.dtype(about["dtype"]))
    return Image(
        voxels=voxels.reshape(about["shape"]),
        voxel_size=voxel_size,
        empty=empty,
        full=full,
        origin=(x, y, z),
        name=about["name"],
    )
