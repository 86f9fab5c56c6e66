"""Make the image from the voxels in a file, with the options that define their meaning."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tusqh.errors import GeometryError
from tusqh.geometry.image import Image
from tusqh.geometry.remark import Remark
from tusqh.readers import labels
from tusqh.readers.axes import take_space
from tusqh.readers.frames import Place, align, to_cubes
from tusqh.readers.reading import Reading
from tusqh.settings.voxels import Voxels

#: Up to this number of distinct integers, reading them as grey values deserves a remark.
_FEW = 16


_UNIT_CUBES = Place()


def image_in_file(
    path: Path,
    voxels: NDArray[Any],
    *,
    meaning: Voxels,
    axes: Sequence[str] = (),
    arrange: Callable[[NDArray[Any]], NDArray[Any]] | None = None,
    place: Place = _UNIT_CUBES,
    is_named: bool = False,
    remarks: Sequence[Remark] = (),
) -> Reading:
    """Return the image in a file, along those axes of its array that are directions of space.

    Parameters
    ----------
    path
        The file.
    voxels
        The whole array.
    meaning
        The options, see `tusqh.settings.voxels.Voxels`.
    axes
        For each axis a plural noun, such as "channels", or "" for a direction of space; empty if
        all of them are directions of space.
    arrange
        Function that brings the axes in space into the order x, y, z, and flips them.
    place
        Size of the voxels along each direction of space, lowest corner and unit.
    is_named
        Whether the file itself names its axes, so that a thin one needs no remark.
    remarks
        Remarks of the reader.

    Raises
    ------
    GeometryError
        See `image_of` and `tusqh.readers.axes.take_space`.
    """
    others = axes or [""] * voxels.ndim
    voxels = take_space(str(path), voxels, others, channel=meaning.channel, dim=len(place.sides))
    voxels = arrange(voxels) if arrange else voxels
    thin = [] if is_named else _remark_on_thin_axis(voxels.shape)
    said = [*remarks, *thin]
    return image_of(str(path), voxels, name=path.name, meaning=meaning, place=place, remarks=said)


def image_of(
    where: str,
    voxels: NDArray[Any],
    *,
    name: str,
    meaning: Voxels,
    place: Place = _UNIT_CUBES,
    remarks: Sequence[Remark] = (),
) -> Reading:
    """Return voxels as an image.

    Parameters
    ----------
    where
        The file, for messages.
    voxels
        Grey values or labels, shape (nx, ny, nz), or (nx, ny) for a picture.
    name
        Name of the image.
    meaning
        The options, see `tusqh.settings.voxels.Voxels`; the channel is already chosen.
    place
        Size of the voxels, lowest corner and unit.
    remarks
        Remarks of the reader.

    Raises
    ------
    GeometryError
        The array is not an image, its axes do not span the space, or its labels need a choice.
    """
    voxels, place = align(where, voxels, place)
    empty, full, said = meaning.empty, meaning.full, list(remarks)
    if voxels.ndim in (2, 3) and voxels.size:
        voxels, empty, full, more = _interpret(where, voxels, meaning)
        said += more
    image = Image.from_voxels(voxels, empty=empty, full=full, name=name)
    image, of_cubes = to_cubes(where, image, place, meaning.voxel_size)
    return Reading(image, (*said, *of_cubes), unit=place.unit)


def require_stated_shape(options: Mapping[str, Any], *, where: str) -> None:
    """Raise an error for the shape or order of voxels whose source states them.

    Parameters
    ----------
    options
        The given options, see `tusqh.settings.voxels.Voxels`.
    where
        The source, for the message.

    Raises
    ------
    GeometryError
        A shape or an order is given.
    """
    given = [name for name in ("voxels", "voxel_order") if options.get(name) is not None]
    if given:
        raise GeometryError(
            f"`{given[0]}` is given for an image that states its own shape",
            where=where,
            expected="a file of type '.spn', a column of labels without a shape",
            remedy=f"remove `{given[0]}`",
        )


def _remark_on_thin_axis(shape: Sequence[int]) -> list[Remark]:
    """Return a remark if an axis looks like colours or channels."""
    thin = min(shape, default=0)
    if len(shape) != 3 or not 2 <= thin <= 4 or sorted(shape)[1] < 16:
        return []
    remedy = "if they are colours or channels, give one of them as an image of three axes"
    return [Remark("noted", f"layers along axis {'xyz'[list(shape).index(thin)]}", thin, remedy)]


_Interpretation = tuple[NDArray[Any], float | None, float | None, list[Remark]]


def _interpret(where: str, voxels: NDArray[Any], meaning: Voxels) -> _Interpretation:
    """Return voxels, `empty` and `full` after replacing labels by a mask of the material."""
    if meaning.labels is not None:
        return _take_labels(where, voxels, meaning.labels)
    plain = voxels, meaning.empty, meaning.full
    whole = labels.as_whole_numbers(voxels)
    if meaning.empty is not None or meaning.full is not None or whole is None:
        return *plain, []
    values, counts = labels.count_values(whole)
    if values[0] < 0:
        return *plain, []
    if len(values) == 2 and values[0] > 0:
        low, high = values.tolist()
        remedy = f"give `labels`, or `empty` and `full`, if {low} is not the background"
        said = Remark("noted", f"values: {low} is taken as empty, {high} as material", 2, remedy)
        return voxels, low, high, [said]
    if labels.look_like_labels(whole, values):
        if values[0] != 0:
            raise GeometryError(
                f"the {len(values):,} labels {labels.to_text(values)} have no background 0",
                where=where,
                expected="an image of labels in which 0 is empty, or grey values",
                remedy="give the `labels` of the material, or `empty` and `full` for grey values",
            )
        material = labels.to_text(values[1:])
        remedy = "give `labels` to choose some, or `empty` and `full` if they are grey values"
        said = Remark("changed", f"labels into material: {material}", len(values) - 1, remedy)
        return whole != 0, None, None, [said, *_remark_on_background(whole)]
    return *plain, _remark_on_greys(values, counts) if voxels.dtype.kind in "ui" else []


def _remark_on_background(whole: NDArray[Any]) -> list[Remark]:
    """Return a remark if most voxels at the border of an image have one label other than 0."""
    ends = [np.take(whole, end, axis=axis).ravel() for axis in range(whole.ndim) for end in (0, -1)]
    values, counts = np.unique(np.concatenate(ends), return_counts=True)
    most = int(np.argmax(counts))
    if values[most] == 0 or 2 * counts[most] <= counts.sum():
        return []
    what = f"voxels at the border of the image with the label {values[most]}, taken as material"
    remedy = "give `labels` without it if it is the background"
    return [Remark("noted", what, int(counts[most]), remedy)]


def _take_labels(where: str, voxels: NDArray[Any], wanted: Sequence[int]) -> _Interpretation:
    """Return the mask of the voxels with one of the wanted labels."""
    is_material = np.isin(voxels, wanted)
    missing = [label for label in wanted if not (voxels[is_material] == label).any()]
    if missing:
        found = np.unique(voxels)
        raise GeometryError(
            f"no voxel has the label {missing[0]}",
            where=where,
            expected=f"labels of the image: {labels.to_text(found.tolist())}",
            remedy="correct `labels`",
        )
    n_left = int(np.count_nonzero(voxels[~is_material]))
    said = [Remark("left out", "voxels of other labels than those given", n_left)] if n_left else []
    return is_material, None, None, said


def _remark_on_greys(values: NDArray[np.int64], counts: NDArray[np.int64]) -> list[Remark]:
    """Return a remark on suspicious integers that are read as fractions of the largest one."""
    if len(values) < 3:
        return []
    greatest = int(values[-1])
    what = f"grey values from {values[0]} to {greatest}, read as fractions of {greatest}"
    if len(values) <= _FEW:
        return [Remark("noted", what, len(values), "if they are labels, give `labels`")]
    peaks = labels.suggest_levels(values, counts)
    if peaks is None or max(peaks[0], greatest - peaks[1]) <= 0.02 * greatest:
        return []
    low, high = peaks
    remedy = (
        f"the histogram has its peaks at {low} and {high}: consider `empty` {low}, `full` {high}"
    )
    return [Remark("noted", what, len(values), remedy)]
