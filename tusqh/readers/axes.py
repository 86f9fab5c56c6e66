"""Select the spatial part of an image with channels, colours or times."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from tusqh.errors import GeometryError


def take_space(
    where: str,
    voxels: NDArray[Any],
    others: Sequence[str],
    *,
    channel: int | None = None,
    dim: int = 3,
) -> NDArray[Any]:
    """Return the part of an image that lies in space.

    Parameters
    ----------
    where
        The file, for messages.
    voxels
        The image, with any number of axes.
    others
        For each axis a plural noun, such as "channels", or "" for a direction of space.
    channel
        The entry to take along the axis that is not a direction of space.
    dim
        Number of directions of space: 2 for pictures.

    Raises
    ------
    GeometryError
        There are fewer directions of space, there are several channels but none is chosen, or the
        chosen one does not exist.
    """
    single = tuple(i for i, name in enumerate(others) if name and voxels.shape[i] == 1)
    voxels = voxels.squeeze(single) if single else voxels
    others = [name for i, name in enumerate(others) if i not in single]
    named = [(i, name) for i, name in enumerate(others) if name]
    space = f"{('two', 'three')[dim - 2]} directions of space"
    sizes = " and ".join(f"{voxels.shape[i]} {name}" for i, name in named)
    if len(named) > 1:
        raise GeometryError(
            f"the image has {sizes}",
            where=where,
            expected=f"{space}, and at most one axis more",
            remedy="export one of each from the program that wrote it",
        )
    if not named:
        if channel not in (None, 0):
            raise GeometryError(
                f"`channel` is {channel}, and the image has only one channel",
                where=where,
                expected="no `channel`, or 0",
                remedy="remove `channel`",
            )
        return _in_space(where, voxels, dim)
    axis, _ = named[0]
    if len(others) != dim + 1:
        raise GeometryError(
            f"the image has {sizes} and {len(others) - 1} directions of space",
            where=where,
            expected=f"grey values along {space}",
            remedy="export them as slices if they are one, or give a stack of several slices",
        )
    if channel is None or channel >= voxels.shape[axis]:
        chosen = "" if channel is None else f", and `channel` is {channel}"
        raise GeometryError(
            f"the image has {sizes}{chosen}",
            where=where,
            expected=f"grey values along {space}",
            remedy=f"choose one with `channel`, from 0 to {voxels.shape[axis] - 1}, "
            "or export them as slices if they are a direction of space",
        )
    taken: NDArray[Any] = voxels.take(channel, axis=axis)
    return taken


def _in_space(where: str, voxels: NDArray[Any], dim: int) -> NDArray[Any]:
    """Return an image of directions of space, after checking that it has enough of them."""
    if voxels.ndim == 2 and dim == 3:
        raise GeometryError(
            f"the image has the shape {voxels.shape}: it is a single slice",
            where=where,
            expected="grey values along three directions of space",
            remedy="save the slice as PNG (.png), which is meshed in the plane",
        )
    return voxels
