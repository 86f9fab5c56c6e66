"""Where the voxels of a file lie in space, and how they become cubes along its axes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tusqh.errors import GeometryError
from tusqh.geometry.image import Image
from tusqh.geometry.remark import Remark
from tusqh.grid import FloatArray
from tusqh.readers.boxes_to_cubes import resample_boxes, resample_turned
from tusqh.readers.gate import require_memory

#: Voxels whose side lengths have at most this relative difference count as cubes.
_CUBIC = 1e-6
#: Components of a direction up to this, relative to its length, count as zero.
_PARALLEL = 1e-6


class Place(NamedTuple):
    """The location of the voxels of a file.

    Parameters
    ----------
    sides
        Side lengths of a voxel along x, y and z; 1 if the file states none.  Those of
        pictures are along x and y.
    origin
        Lowest corner of voxel (0, 0, 0), in the file's unit; a given voxel size scales it.
    unit
        Unit of length that the file states; empty if it states none.
    steps
        Step from a voxel to the next along each axis of the array, one a row, shape (3, 3), for
        axes that may be turned; the origin is then the corner at which voxel (0, 0, 0) begins.
        None for axes along x, y and z with these sides.
    """

    sides: Sequence[float] = (1.0, 1.0, 1.0)
    origin: Sequence[float] = (0.0, 0.0, 0.0)
    unit: str = ""
    steps: FloatArray | None = None


def place_of_centres(
    steps: FloatArray, first: FloatArray | None, shape: Sequence[int], *, unit: str = ""
) -> Place:
    """Return the place of voxels of which the centre of the first is known.

    Parameters
    ----------
    steps
        Step from a voxel to the next along each axis of the array, shape (3, 3).
    first
        Centre of voxel (0, 0, 0); None: the lowest corner of the image is at 0.
    shape
        Number of voxels along each axis.
    unit
        Unit of length; empty if it is not known.

    Examples
    --------
    >>> place_of_centres(np.diag([2.0, 2, 2]), np.zeros(3), (1, 1, 1)).origin
    [-1.0, -1.0, -1.0]
    """
    if first is not None:
        origin = np.asarray(first, dtype=np.float64) - steps.sum(axis=0) / 2
    else:
        along = steps * np.asarray(shape, dtype=np.float64)[:, None]
        origin = np.maximum(-along, 0.0).sum(axis=0)
    return Place(origin=origin.tolist(), unit=unit, steps=np.asarray(steps, dtype=np.float64))


def align(where: str, voxels: NDArray[Any], place: Place) -> tuple[NDArray[Any], Place]:
    """Return voxels in the order and the directions of x, y and z, where their axes are parallel.

    Parameters
    ----------
    where
        The file, for messages.
    voxels
        The array.
    place
        Where it lies.

    Returns
    -------
    voxels, place
        The array and its place; unchanged if axes are turned or an axis is missing.

    Raises
    ------
    GeometryError
        The axes do not span the space.
    """
    steps = place.steps
    if steps is None or voxels.ndim != 3:
        return voxels, place._replace(steps=None)
    lengths = np.linalg.norm(steps, axis=1)
    if not np.isfinite(steps).all() or abs(np.linalg.det(steps)) <= 1e-9 * lengths.prod():
        raise GeometryError(
            f"its axes have the directions {_shown(steps)}",
            where=where,
            expected="three directions that span the space",
            remedy="correct them in the header, or export the image again",
        )
    is_along = np.abs(steps) > _PARALLEL * lengths[:, None]
    if not ((is_along.sum(axis=0) == 1).all() and (is_along.sum(axis=1) == 1).all()):
        return voxels, place
    towards = np.argmax(is_along, axis=1)
    order = np.argsort(towards)
    along = steps[order, np.arange(3)]
    flipped = np.flip(voxels, axis=tuple(int(a) for a in order[along < 0]))
    arranged = flipped.transpose(order)
    low = np.asarray(place.origin) + np.where(along < 0, along * arranged.shape, 0.0)
    return arranged, Place(np.abs(along).tolist(), low.tolist(), place.unit)


def to_cubes(
    where: str, image: Image, place: Place, voxel_size: float | None
) -> tuple[Image, list[Remark]]:
    """Return an image in cubes along the axes of space, with remarks on what was changed.

    Parameters
    ----------
    where
        The file, for messages.
    image
        The image, as if it had unit cubes.
    place
        Where its voxels lie.
    voxel_size
        The given edge length of a voxel; None: as in the file.

    Returns
    -------
    image, remarks
        The image, and what was changed.

    Raises
    ------
    GeometryError
        Cubes need too much memory, or the voxels are labels of several materials.
    """
    sides, steps = np.asarray(place.sides[: image.dim], dtype=np.float64), place.steps
    if steps is not None:
        sides = np.linalg.norm(steps, axis=1)
    given = sides if voxel_size is None else np.full(image.dim, voxel_size)
    origin = np.asarray(place.origin[: image.dim], dtype=np.float64) / sides * given
    if not (np.isfinite(given).all() and (given > 0).all()):
        shown = " x ".join(f"{s:g}" for s in given)
        raise GeometryError(
            f"a voxel measures {shown}",
            where=where,
            expected="positive lengths",
            remedy="give `voxel_size`",
        )
    size = float(given.min())
    if steps is None and np.ptp(given) <= _CUBIC * given.max():
        return _placed(image, float(given[0]), origin), []
    shown = " x ".join(f"{s:g}" for s in given)
    _refuse_labels(where, image, shown)
    if steps is None:
        n_cubes = math.prod(
            math.ceil(n * s / size) for n, s in zip(image.shape, given, strict=True)
        )
        require_memory(Path(where), 24 * n_cubes, what=f"an image of {n_cubes:,} cubes")
        cubes = resample_boxes(image.fractions(), given, size)
        how = f"voxels of {shown} resampled to cubes of {size:g}"
    else:
        steps = steps / sides[:, None] * given[:, None]
        extent = np.abs(steps * np.asarray(image.shape)[:, None]).sum(axis=0) / size
        n_cubes = math.prod(math.ceil(e) for e in extent)
        require_memory(Path(where), 24 * n_cubes, what=f"an image of {n_cubes:,} cubes")
        origin = np.asarray(place.origin, dtype=np.float64)
        cubes, origin = resample_turned(image.fractions(), steps, origin, size)
        how = f"voxels of {shown} with axes along {_shown(steps)} resampled to cubes of {size:g}"
    new = Image(cubes, name=image.name)
    return _placed(new, size, origin), [Remark("changed", how, math.prod(image.shape))]


def _placed(image: Image, size: float, origin: FloatArray) -> Image:
    """Return an image with its size and place."""
    return Image(image.voxels, size, image.empty, image.full, tuple(origin.tolist()), image.name)


def _refuse_labels(where: str, image: Image, shown: str) -> None:
    """Raise an error for labels of several materials, whose means have no meaning."""
    is_whole = image.voxels.dtype.kind in "iu"
    if is_whole and (image.empty, image.full) == (0.0, 1.0) and image.voxels.max() > 1:
        raise GeometryError(
            f"a voxel measures {shown}, or its axes are turned, and voxels are labels",
            where=where,
            expected="labels in cubes along the axes of space",
            remedy="resample the labels with the nearest voxel, or mesh them one by one with "
            "`labels`",
        )


def _shown(steps: FloatArray) -> str:
    """Return directions as text."""
    return " ".join(f"({', '.join(f'{x:.3g}' for x in row)})" for row in steps)
