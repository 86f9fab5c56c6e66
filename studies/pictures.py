"""Pictures of a page: figures of the results, reduced to the width of a page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from provenance.stamp import read_mark, stamp
from tusqh.atomic import replacing

#: Largest width of a picture, in pixels; results/ keeps the full figure.
_PICTURE_WIDTH = 1400


def picture_name(figure: str) -> str:
    """Return the name of the picture of a figure on a page.

    Parameters
    ----------
    figure
        Path of the figure in `results`.

    Examples
    --------
    >>> picture_name("results/dragon/figures/panels.png")
    'dragon_panels.png'
    >>> picture_name("results/figures/pinches.png")
    'pinches.png'
    """
    folders = Path(figure).parts[:-1]
    owner = [part for part in folders if part not in ("results", "figures", "tables")]
    return "_".join([*owner, Path(figure).name])


def copy_pictures(figures: Sequence[str], folder: Path) -> list[Path]:
    """Write figures, reduced to the width of a page, as its pictures, and return the files.

    Each picture keeps the mark of its figure, see `provenance.stamp`.

    Parameters
    ----------
    figures
        PNG files.
    folder
        The folder of the pictures.

    Returns
    -------
    list of Path
        The pictures that were written.
    """
    from PIL import Image

    written = []
    for figure in figures:
        path = folder / picture_name(figure)
        with Image.open(figure) as image, replacing(path) as temporary:
            picture = image.convert("RGB")
            if picture.width > _PICTURE_WIDTH:
                height = round(picture.height * _PICTURE_WIDTH / picture.width)
                picture = picture.resize((_PICTURE_WIDTH, height), Image.Resampling.LANCZOS)
            # A palette of 256 colours takes a third of the bytes without a visible difference.
            picture.quantize(256, dither=Image.Dither.NONE).save(temporary, optimize=True)
            mark = read_mark(Path(figure))
            if mark:
                stamp(temporary, mark)
        written.append(path)
    return written
