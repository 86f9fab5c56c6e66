"""Read a picture, PNG or JPEG, as a model in the plane whose material is its grey values."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as Pillow
from PIL import ImageOps

from tusqh.errors import GeometryError
from tusqh.geometry.remark import Remark
from tusqh.readers.frames import Place
from tusqh.readers.gate import require_memory
from tusqh.readers.reading import Reading
from tusqh.readers.voxels import image_in_file
from tusqh.settings.voxels import Voxels

#: Number of the tag Orientation.
_ORIENTATION = 0x0112
#: Colour types of PNG with several values for a pixel.
_SEVERAL = (2, 4, 6)


def read(path: Path, *, meaning: Voxels) -> Reading:
    """Read the grey values of a picture; x points to the right and y upwards, as it is shown.

    Colours whose values are all equal are grey; of others, and of transparency, one is chosen by
    the channel.  A palette is not applied: its numbers are read.

    Parameters
    ----------
    path
        The file.
    meaning
        The meaning of the pixels.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    GeometryError
        The file is damaged or a film, or it has colours and no channel is chosen.
    """
    with _without_limit(), Pillow.open(path) as picture:
        width, height = picture.size
        shown = f"a picture of {width:,} x {height:,} pixels"
        require_memory(path, 16 * width * height, what=shown)
        _refuse_films(path, picture)
        remarks = _remarks_on(path, picture)
        orientation = picture.getexif().get(_ORIENTATION, 1)
        if orientation not in (0, 1):
            what = f"pixels turned as the tag Orientation {orientation} says"
            remarks.append(Remark("changed", what, width * height))
        upright = ImageOps.exif_transpose(picture)
        pixels, axes = _grey(np.asarray(upright), meaning.channel)
    if pixels.ndim == 2 and not _has_meaning(meaning):
        remarks += _remark_on_bright_border(pixels)
    return image_in_file(
        path,
        np.ascontiguousarray(pixels[::-1].swapaxes(0, 1)),
        meaning=meaning,
        axes=axes,
        place=Place(sides=(1.0, 1.0), origin=(0.0, 0.0)),
        remarks=remarks,
    )


@contextmanager
def _without_limit() -> Iterator[None]:
    """Lift Pillow's limit on the number of pixels; the available memory is the limit here."""
    before = Pillow.MAX_IMAGE_PIXELS
    Pillow.MAX_IMAGE_PIXELS = None
    try:
        yield
    finally:
        Pillow.MAX_IMAGE_PIXELS = before


def _refuse_films(path: Path, picture: Any) -> None:
    """Raise an error for a file of several pictures."""
    n_frames = int(getattr(picture, "n_frames", 1))
    if n_frames > 1:
        raise GeometryError(
            f"the file holds {n_frames} pictures",
            where=str(path),
            expected="one picture",
            remedy="save one of them as PNG, or all of them as a TIFF stack in 3D",
        )


def _remarks_on(path: Path, picture: Any) -> list[Remark]:
    """Return remarks on what the format loses, and on a resolution."""
    remarks = []
    if picture.format == "JPEG":
        remedy = "save the picture as PNG in the program that made it"
        remarks.append(
            Remark(
                "noted", "lossy compression: grey values near the borders are changed", 1, remedy
            )
        )
    if picture.format == "PNG":
        with path.open("rb") as file:
            bits, kind = struct.unpack("BB", file.read(26)[24:])
        if bits == 16 and kind in _SEVERAL:
            remedy = "save it in grey to keep all 16"
            remarks.append(Remark("changed", "colours of 16 bits read with 8 bits", 1, remedy))
    if picture.mode in ("P", "PA"):
        remarks.append(Remark("left out", "palette of colours; its numbers are read", 1))
    if "dpi" in picture.info:
        remedy = "give the size of a pixel with `voxel_size` and `unit`"
        remarks.append(Remark("left out", "resolution for printing", 1, remedy))
    return remarks


def _grey(pixels: NDArray[Any], channel: int | None) -> tuple[NDArray[Any], list[str]]:
    """Return grey values [row, column], or colours as a third axis, and a noun for each axis."""
    if pixels.ndim == 2:
        return pixels, []
    n_colours = pixels.shape[2]
    is_opaque = n_colours in (2, 4) and bool((pixels[..., -1] == pixels[..., -1].max()).all())
    colours = pixels[..., :-1] if is_opaque else pixels
    is_grey = bool((colours == colours[..., :1]).all())
    if channel is None and is_grey and (is_opaque or n_colours in (1, 3)):
        return pixels[..., 0], []
    return pixels, ["", "", "colours, the transparency included"]


def _has_meaning(meaning: Voxels) -> bool:
    """Return whether the user says which grey values are material."""
    return any(value is not None for value in (meaning.empty, meaning.full, meaning.labels))


def _remark_on_bright_border(pixels: NDArray[Any]) -> list[Remark]:
    """Return a remark if most of the border of a picture would be material."""
    border = np.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]])
    greatest = pixels.max()
    n_bright = int((border > greatest / 2).sum())
    if 2 * n_bright <= len(border):
        return []
    remedy = f"if the dark pixels are the material, give `empty: {greatest}` and `full: 0`"
    what = "bright pixels at the border of the picture, taken as material"
    return [Remark("noted", what, n_bright, remedy)]
